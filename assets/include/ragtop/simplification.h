#pragma once

#include <span>
#include <vector>

#include "ragtop/shape.h"

namespace ragtop {

/// A surface with fewer triangles.
struct SimplerSurface {
    std::vector<Vec3> vertices;  ///< some of those given
    std::vector<Triangle> triangles;
    float error =
        0;  ///< m, measured: farthest that a vertex, edge middle or triangle middle of either is from the other
};

/// Few triangles, none of which is farther than `maxError` (m) from the given surface, nor that from them. What was
/// closed stays closed; borders stay where they are within the error. Vertices at one place count as one. By
/// meshoptimizer [Garland, Heckbert, Surface Simplification Using Quadric Error Metrics, 1997]. Throws
/// std::invalid_argument as TriangleMesh does, and for an error that is not in [0, 1e5] m.
SimplerSurface simplify(std::span<const Vec3> vertices, std::span<const Triangle> triangles, float maxError);

}  // namespace ragtop
