#pragma once

#include <span>

#include "narrowphase/manifold.h"

namespace ragtop {

/// Marks features that are named after a triangle: cuts, which give way to corners of the shape.
inline constexpr std::uint32_t kNamedAfterTriangle = 1u << 31;

/// Gathers the contacts of one shape with any number of triangles into at most kMaxManifolds manifolds by direction,
/// in order of first appearance. When directions run out a contact joins the nearest one; when points run out the
/// deepest and outermost stay.
class ManifoldSet {
public:
    /// `size` of the convex shape: points nearer to each other than a small part of it are one.
    explicit ManifoldSet(float size) : size_(size) {}
    ManifoldSet(const ManifoldSet&) = delete;
    ManifoldSet& operator=(const ManifoldSet&) = delete;

    void add(const Vec3& normal, std::span<const ManifoldPoint> points, std::uint32_t triangle);
    /// What is left of a way after `gone` where the planes that are within `near` there turn it along themselves.
    Vec3 slid(Vec3 way, const Vec3& gone, float near) const;
    /// Writes the manifolds, moved by `offset`, and returns how many.
    int write(const Vec3& offset, std::span<Manifold> out);

private:
    static constexpr int kMaxPoints = 24;  ///< scratch, of a direction
    struct Cluster {
        Vec3 normal;
        float deepest = 0;
        std::uint32_t triangle = 0;
        int count = 0;
        union {  // not filled with zeros first
            ManifoldPoint points[kMaxPoints];
        };

        Cluster() {}
    };

    Cluster& clusterFor(const Vec3& normal);
    static void makeRoom(Cluster& cluster);
    void addPoint(Cluster& cluster, const ManifoldPoint& point) const;

    float size_;
    int count_ = 0;
    union {  // not filled with zeros first: most shapes touch in one direction
        Cluster clusters_[kMaxManifolds];
    };
};

}  // namespace ragtop
