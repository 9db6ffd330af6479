#pragma once

#include <span>
#include <vector>

#include "ragtop/shape.h"

namespace ragtop {

struct WeldedSurface {
    std::vector<Vec3> vertices;       ///< of the triangles, no two at one place, sorted
    std::vector<Triangle> triangles;  ///< with three different vertices, no two back to back along a line
};
WeldedSurface welded(std::span<const Vec3> vertices, std::span<const Triangle> triangles);

/// Collapses edges down to `target` triangles, or as far as its quadrics stay below the error (m). These estimate; they
/// promise nothing.
WeldedSurface collapsed(const WeldedSurface& surface, std::size_t target, float error);

}  // namespace ragtop
