#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "ragtop/shape.h"

namespace ragtop {

/// Triangles to look at. Without normals every triangle is flat.
struct SurfaceMesh {
    std::vector<Vec3> vertices;
    std::vector<Vec3> normals;
    std::vector<std::uint32_t> indices;
};

/// The surface of a shape other than a Compound. Boxes and spheres come in unit size, for `surfaceScale` to scale, so that
/// all of them share one mesh.
SurfaceMesh surfaceOf(const Shape& shape);
Vec3 surfaceScale(const Shape& shape);

/// The faces of the convex hull of points, counter-clockwise from outside.
std::vector<std::uint32_t> hullTriangles(std::span<const Vec3> points);

}  // namespace ragtop
