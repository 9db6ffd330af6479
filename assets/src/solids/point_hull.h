#pragma once

#include <limits>
#include <vector>

#include "ragtop/hull_triangles.h"
#include "solids/vectors.h"

namespace ragtop {

/// The convex hull of points, by the few of them that are its corners. Points that span no volume have no faces.
struct PointHull {
    std::vector<DVec3> points;            ///< the corners; of what spans no volume all points
    std::vector<HullTriangle> triangles;  ///< counter-clockwise from outside
    std::vector<DPlane> planes;           ///< of the triangles
    double volume = 0;
};

PointHull hullOf(std::vector<DVec3> points);
/// Of the convex hull, in less time.
struct HullSize {
    double volume = 0;
    std::size_t corners = 0;
};
HullSize hullSize(const std::vector<DVec3>& points);

/// By how far a point is outside of the hull's planes; below zero inside. At `enough` or above any such.
double heightOver(const PointHull& hull, const DVec3& p, double enough = std::numeric_limits<double>::infinity());

}  // namespace ragtop
