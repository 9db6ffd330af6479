#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "ragtop/shape.h"
#include "solids/vectors.h"

namespace ragtop {

/// Distances from a surface of triangles, and rays on it, in double precision.
class SurfaceTree {
public:
    SurfaceTree(std::vector<DVec3> vertices, std::span<const Triangle> triangles);

    /// From a point to the nearest of the surface, or `limit` when that is farther.
    double distance(const DVec3& p, double limit = std::numeric_limits<double>::infinity()) const;
    /// Along a unit direction from a point to the surface, or `limit` when that is farther; what is nearer than `skip`
    /// is passed over.
    double freePath(const DVec3& from, const DVec3& direction, double skip, double limit) const;

    /// How many solids a point is in: surfaces that a ray leaves less those that it enters.
    int winding(const DVec3& from, const DVec3& direction, double skip) const;

private:
    struct Node {
        DVec3 lower, upper;
        std::uint32_t first = 0;  ///< leaf: first triangle; inner: the right child (the left one follows)
        std::uint32_t count = 0;  ///< leaf: number of triangles; inner: 0
    };
    /// Calls visit for the triangles of leaves whose bounds a ray meets nearer than `reach`, which visit may shorten.
    template <class Visit>
    void along(const DVec3& from, const DVec3& direction, const double& reach, Visit&& visit) const;
    void build(std::span<std::uint32_t> order, std::span<const DVec3> centers, std::uint32_t first);

    std::vector<std::array<DVec3, 3>> triangles_;  ///< in tree order
    std::vector<Node> nodes_;
};

}  // namespace ragtop
