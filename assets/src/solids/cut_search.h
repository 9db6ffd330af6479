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

/// Planes through two concave edges that are parallel, with the solid between them: what one of them cuts off, as the
/// tooth of a gear, ends both. Those of edges that are near each other come first.
std::vector<DPlane> pairPlanes(const CutSolid& solid, std::vector<ConcaveEdge> concave);

/// Planes along which a solid might be cut: those of faces beside concave edges, those halfway between such faces,
/// those of pairs of them, and some across the axes of the world and of its own.
std::vector<DPlane> planesToTry(const CutSolid& solid, const std::vector<ConcaveEdge>& concave);

/// What is cut first: by which least air is left in all, or what leaves none in what it cuts off, where there is such a
/// pair of concave edges.
enum class CutOrder { leastAir, whatStandsOut };

/// The plane that comes next in this order, for hulls of so many corners at most; none where no plane leaves two parts
/// with volume.
std::optional<DPlane> bestCut(const CutSolid& solid, CutOrder order, std::size_t corners, const TaskRunner& tasks);

}  // namespace ragtop
