#pragma once

#include <vector>

#include "ragtop/math.h"
#include "ragtop/shape.h"

/// How deep two shapes overlap, computed in double precision by other means than the simulation's own: distances of
/// segments for balls and capsules, a polytope that grows within their difference for all others.
namespace ragtop::demos {

/// A convex shape in the world: the hull of points, thickened by a radius.
struct ConvexSolid {
    std::vector<DVec3> points;
    double radius = 0;
};

/// An empty solid for surfaces.
ConvexSolid solidOf(const Shape& shape, const Pose& pose);

/// m; zero when apart.
double overlapDepth(const ConvexSolid& a, const ConvexSolid& b);
/// How far the solid reaches behind a triangle, counter-clockwise seen from outside, that it lies on; m. Solids that
/// are farther behind than they are large do not touch it.
double overlapDepth(const ConvexSolid& solid, const DVec3& p, const DVec3& q, const DVec3& r);

struct Box3 {
    DVec3 lower, upper;
};
Box3 boundsOf(const ConvexSolid& solid);

}  // namespace ragtop::demos
