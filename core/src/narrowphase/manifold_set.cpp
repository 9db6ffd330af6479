#include "narrowphase/manifold_set.h"

#include <memory>

#include "narrowphase/clip.h"

namespace ragtop {
namespace {

constexpr float kSameFace = 0.9998f;  // cosine of about one degree
constexpr float kSameCorner = 0.02f;  // of the size

bool isCut(const ManifoldPoint& point) { return (point.feature & kNamedAfterTriangle) != 0; }

}  // namespace

ManifoldSet::Cluster& ManifoldSet::clusterFor(const Vec3& normal) {
    int nearest = -1;
    float most = -2;
    for (int i = 0; i < count_; ++i) {
        const float facing = dot(clusters_[i].normal, normal);
        if (facing > most) {
            most = facing;
            nearest = i;
        }
    }
    if (most >= kSameFace || count_ == kMaxManifolds) return clusters_[nearest];
    Cluster& fresh = *std::construct_at(&clusters_[count_++]);
    fresh.normal = normal;
    return fresh;
}

/// Corners stay longest: each may be a corner of the whole contact, of which only part is known yet. Equal depths are
/// not forgiven here, so that no loss adds up.
void ManifoldSet::makeRoom(Cluster& cluster) {
    constexpr int kCorners = 8;  // that stay at most
    ManifoldPoint* const points = cluster.points;
    int corners = 0;
    for (int i = 0; i < cluster.count; ++i) {
        if (isCut(points[i])) continue;
        const ManifoldPoint corner = points[i];
        points[i] = points[corners];
        points[corners++] = corner;
    }
    const int cuts = cluster.count - corners;
    const int keptCorners = corners > kCorners ? reducePoints(points, corners, cluster.normal, 0) : corners;
    const int keptCuts = cuts > 0 ? reducePoints(points + corners, cuts, cluster.normal, 0) : 0;
    for (int i = 0; i < keptCuts; ++i) points[keptCorners + i] = points[corners + i];
    cluster.count = keptCorners + keptCuts;
}

void ManifoldSet::addPoint(Cluster& cluster, const ManifoldPoint& point) const {
    const float near2 = kSameCorner * kSameCorner * size_ * size_, noise = kDepthTolerance * size_;
    for (int i = 0; i < cluster.count; ++i) {
        ManifoldPoint& known = cluster.points[i];
        if (lengthSquared(known.position - point.position) > near2) continue;
        const float bonus = isCut(point) == isCut(known) ? 0 : isCut(known) ? noise : -noise;
        if (point.separation < known.separation + bonus) known = point;
        return;
    }
    if (cluster.count == kMaxPoints) {
        makeRoom(cluster);
    }
    cluster.points[cluster.count++] = point;
}

void ManifoldSet::add(const Vec3& normal, std::span<const ManifoldPoint> points, std::uint32_t triangle) {
    if (points.empty()) return;
    Cluster& cluster = clusterFor(normal);
    float deepest = points[0].separation;
    for (const ManifoldPoint& point : points) deepest = point.separation < deepest ? point.separation : deepest;
    if (cluster.count == 0 || deepest < cluster.deepest) {
        cluster.normal = normal;
        cluster.deepest = deepest;
        cluster.triangle = triangle;
    }
    for (const ManifoldPoint& point : points) addPoint(cluster, point);
}

Vec3 ManifoldSet::slid(Vec3 way, const Vec3& gone, float near) const {
    constexpr int kPasses = 3;  // as many planes as hold a point
    for (int pass = 0; pass < kPasses; ++pass)
        for (int i = 0; i < count_; ++i) {
            const Cluster& plane = clusters_[i];
            const float into = dot(way, plane.normal);
            if (into < 0 && plane.deepest + dot(gone, plane.normal) <= near) way -= into * plane.normal;
        }
    return way;
}

int ManifoldSet::write(const Vec3& offset, std::span<Manifold> out) {
    return writeClusters(clusters_, count_, kDepthTolerance * size_, offset, out);
}

}  // namespace ragtop
