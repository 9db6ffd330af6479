#pragma once

#include <vector>

#include "ragtop/hull_triangles.h"
#include "shapes/hull.h"

/// The steps of building a ConvexHull. Coordinates are double, about the middle of the points and scaled by a power of
/// two to at most 1, so that hulls of scaled points are scaled hulls to the bit.
namespace ragtop {

inline constexpr std::size_t kMaxHullVertices = 128;  ///< whose numbers have a byte

/// Faces (counter-clockwise loops) out of triangles, those that lie in a plane to within `tolerance` merged. Vertices
/// along the way of an edge are left out. Empty when the merged faces would not be a polyhedron.
std::vector<std::vector<int>> mergeFaces(const std::vector<DVec3>& points, const std::vector<HullTriangle>& triangles,
                                         double tolerance);

}  // namespace ragtop
