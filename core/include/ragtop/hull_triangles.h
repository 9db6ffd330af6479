#pragma once

#include <array>
#include <vector>

#include "ragtop/math.h"

namespace ragtop {

using HullTriangle = std::array<int, 3>;

/// The surface of the convex hull of points in double precision, for tools that need more of it than a ConvexHull: its
/// triangles, counter-clockwise from outside, each from its lowest index on, sorted. Coordinates should be about 1 at
/// most. Throws std::invalid_argument with Qhull's words when it fails, as for points in a plane.
std::vector<HullTriangle> convexTriangles(const std::vector<DVec3>& points);

}  // namespace ragtop
