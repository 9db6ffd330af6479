#include "narrowphase/contact_gatherer.h"

#include <algorithm>
#include <memory>

#include "narrowphase/clip.h"

namespace ragtop {
namespace {

constexpr float kSameDirection = 0.9998f;  // cosine of about one degree
/// Cosine of the angle up to which a contact joins another direction when there is no room for its own.
constexpr float kSimilarDirection = 0.8f;
constexpr float kSamePoint = 0.02f;  // of the size
constexpr float kDeep = 0.1f;        // of the size: overlap whose way out is chosen
/// Share of all depths with which the way from middle to middle counts for the way out; contacts that agree outweigh
/// it.
constexpr float kApart = 0.6f;

}  // namespace

void ContactGatherer::add(const ContactCandidate& candidate) {
    deepest_ = candidate.point.separation < deepest_ ? candidate.point.separation : deepest_;
    if (count_ < kMost) {
        std::construct_at(&candidates_[count_++], candidate);
        return;
    }
    int farthest = 0;
    for (int i = 1; i < count_; ++i) {
        if (candidates_[i].point.separation > candidates_[farthest].point.separation) farthest = i;
    }
    if (candidate.point.separation < candidates_[farthest].point.separation) candidates_[farthest] = candidate;
}

ContactGatherer::Cluster* ContactGatherer::clusterFor(const Vec3& normal) {
    int nearest = -1;
    float most = -2;
    for (int i = 0; i < clusterCount_; ++i) {
        const float facing = dot(clusters_[i].normal, normal);
        if (facing > most) {
            most = facing;
            nearest = i;
        }
    }
    if (most >= kSameDirection) return &clusters_[nearest];
    if (clusterCount_ == kMaxManifolds) return most >= kSimilarDirection ? &clusters_[nearest] : nullptr;
    Cluster& fresh = *std::construct_at(&clusters_[clusterCount_++]);
    fresh.normal = normal;
    return &fresh;
}

void ContactGatherer::join(Cluster& cluster, const ManifoldPoint& point) const {
    const float near2 = kSamePoint * kSamePoint * size_ * size_;
    for (int i = 0; i < cluster.count; ++i) {
        const ManifoldPoint& known = cluster.points[i];
        if (known.feature == point.feature || lengthSquared(known.position - point.position) < near2) return;
    }
    if (cluster.count == kMaxPoints) cluster.count = reducePoints(cluster.points, cluster.count, cluster.normal, 0);
    cluster.points[cluster.count++] = point;
}

/// Where parts lie deep in each other, some lead out one way and some the other, and would hold each other: those
/// against the mean of all deep ones, by depth, and of the way apart are left out.
void ContactGatherer::agreeOnWayOut() {
    if (deepest_ > -kDeep * size_) return;
    Vec3 mean;
    float sum = 0;
    for (int i = 0; i < count_; ++i) {
        const ContactCandidate& candidate = candidates_[i];
        if (!(candidate.point.separation < -kDeep * size_)) continue;
        mean -= candidate.point.separation * candidate.normal;
        sum -= candidate.point.separation;
    }
    mean += (kApart * sum) * apart_;
    int kept = 0;
    for (int i = 0; i < count_; ++i)
        if (dot(candidates_[i].normal, mean) >= 0) candidates_[kept++] = candidates_[i];
    count_ = kept;
}

/// Each direction is that of its deepest contact.
void ContactGatherer::group() {
    std::sort(candidates_, candidates_ + count_, [](const ContactCandidate& a, const ContactCandidate& b) {
        if (a.point.separation != b.point.separation) return a.point.separation < b.point.separation;
        if (a.point.feature != b.point.feature) return a.point.feature < b.point.feature;
        return a.triangle < b.triangle;
    });
    agreeOnWayOut();
    for (int i = 0; i < count_; ++i) {
        Cluster* const cluster = clusterFor(candidates_[i].normal);
        if (!cluster) continue;
        if (cluster->count == 0) cluster->triangle = candidates_[i].triangle;
        join(*cluster, candidates_[i].point);
    }
}

int ContactGatherer::write(const Vec3& offset, std::span<Manifold> out) {
    group();
    return writeClusters(clusters_, clusterCount_, kDepthTolerance * size_, offset, out);
}

}  // namespace ragtop
