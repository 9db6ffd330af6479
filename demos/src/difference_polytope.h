#pragma once

#include <vector>

#include "convex_depth.h"

namespace ragtop::demos {

/// The set of differences p − q of points of two convex solids that have volume together, as a polytope within it that
/// grows where it is nearest to the origin [Van den Bergen 2001].
/// The origin is outside where the solids are apart, and its distance from the surface is their depth where not.
class DifferencePolytope {
public:
    DifferencePolytope(const ConvexSolid& a, const ConvexSolid& b);
    /// m, by how much A must move to leave B, to 1e-9; not above zero where a direction separates them.
    double leastOverlap();

private:
    struct Face {
        int a, b, c;    ///< counter-clockwise from outside
        DVec3 normal;   ///< unit
        double offset;  ///< of the origin from the face, m; positive within
    };

    DVec3 farthest(const DVec3& n) const;
    void begin();
    void addFace(int a, int b, int c);
    /// Takes a point outside in: faces that see it make way for those between it and their rim.
    void expand(const DVec3& p);

    const ConvexSolid &a_, &b_;
    std::vector<DVec3> points_;
    std::vector<Face> faces_;
    std::vector<Face> seen_;  ///< of the last expansion
};

}  // namespace ragtop::demos
