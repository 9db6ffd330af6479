#pragma once

#include <optional>
#include <vector>

#include "ragtop/tasks.h"
#include "solids/cut_solid.h"
#include "solids/point_hull.h"

namespace ragtop {

/// An edge at which a solid is concave.
struct ConcaveEdge {
    std::uint32_t a = 0, b = 0;
    DVec3 left, right;  ///< normals of the faces beside it
    double weight =
        0;  ///< its length times the chord of its bend: about the same for a round valley, however finely it is cut
};
std::vector<ConcaveEdge> concaveEdges(const CutSolid& solid);

/// Planes along which a solid might be cut: those of faces beside concave edges, those halfway between such faces, and
/// some across the axes of the world and of its own.
std::vector<DPlane> planesToTry(const CutSolid& solid, const std::vector<ConcaveEdge>& concave);

/// The plane that leaves least air in the hulls of the halves, of so many corners at most; none where no plane leaves
/// two parts with volume.
std::optional<DPlane> bestCut(const CutSolid& solid, std::size_t corners, const TaskRunner& tasks);

}  // namespace ragtop
