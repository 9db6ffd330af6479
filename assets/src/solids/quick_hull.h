#pragma once

#include <vector>

#include "ragtop/hull_triangles.h"
#include "solids/vectors.h"

namespace ragtop {

/// Triangles of the convex hull of points about 1 apart, counter-clockwise from outside; none where rounding leaves
/// doubt, as of many points in one plane, or where the points span no volume. A search of cuts makes thousands of
/// hulls, and this takes a fifth of Qhull's time [Barber, Dobkin, Huhdanpaa, The Quickhull Algorithm for Convex Hulls,
/// 1996].
std::vector<HullTriangle> quickHull(const std::vector<DVec3>& points);

}  // namespace ragtop
