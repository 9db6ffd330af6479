#pragma once

#include <span>

#include "narrowphase/manifold.h"

namespace ragtop {

/// One place where two surfaces touch, or may touch within the step.
struct ContactCandidate {
    Vec3 normal;  ///< unit, from A to B
    ManifoldPoint point;
    std::uint32_t triangle = 0;  ///< of A
};

/// Gathers what features of two surfaces have found about each other, into at most kMaxManifolds manifolds by
/// direction, the deepest first. Of more than there is room for the farthest apart go.
class ContactGatherer {
public:
    /// `size` of the smaller of the two: points nearer to each other than a small part of it are one. `apart`:
    /// direction from the middle of A to that of B.
    ContactGatherer(float size, const Vec3& apart) : size_(size), apart_(apart) {}
    ContactGatherer(const ContactGatherer&) = delete;
    ContactGatherer& operator=(const ContactGatherer&) = delete;

    void add(const ContactCandidate& candidate);
    /// m, of the deepest; zero when nothing overlaps.
    float deepest() const { return deepest_; }
    bool empty() const { return count_ == 0; }
    /// Writes the manifolds, moved by `offset`, and returns how many.
    int write(const Vec3& offset, std::span<Manifold> out);

private:
    static constexpr int kMost = 192, kMaxPoints = 24;  ///< scratch: of all triangles, of a direction
    struct Cluster {
        Vec3 normal;
        std::uint32_t triangle = 0;
        int count = 0;
        ManifoldPoint points[kMaxPoints];
    };

    void agreeOnWayOut();
    Cluster* clusterFor(const Vec3& normal);
    void join(Cluster& cluster, const ManifoldPoint& point) const;
    void group();

    float size_, deepest_ = 0;
    Vec3 apart_;
    int count_ = 0, clusterCount_ = 0;
    union {  // not filled with zeros first
        ContactCandidate candidates_[kMost];
    };
    union {
        Cluster clusters_[kMaxManifolds];
    };
};

}  // namespace ragtop
