#pragma once

#include <cmath>
#include <cstdint>
#include <span>

#include "narrowphase/manifold.h"
#include "narrowphase/reduce_points.h"
#include "shapes/hull.h"

/// Clipping the face of one polyhedron to the face of another, and choosing the points that make a manifold.
namespace ragtop {

/// Of the size of the smaller shape: differences below it are noise to a choice between two features, so the one
/// chosen before (or the face, or the vertex) stays.
inline constexpr float kChoiceTolerance = 0.01f;
/// The same among the depths of the points of one manifold, which are known better.
inline constexpr float kDepthTolerance = 0.001f;
/// Of the size of the smaller shape: how far a corner may overhang the other face before it is cut. Boxes stacked flush
/// keep their corners, and so their features.
inline constexpr float kOverhang = 0.002f;

/// Does a face serve better than the edge pair that was chosen, given the separations along both? An edge pair holds
/// with one point, the less the deeper it is, and the sooner another edge takes its place: so of overlaps it must save
/// a share [Gregorius, GDC 2013]. The face serves if its points show an overlap as deep as that of the edges.
inline bool favoursFace(float face, float edge) {
    constexpr float kShare = 0.1f;  // by trial
    return face < 0 && edge <= (1 - kShare) * face;
}
inline bool showsDepth(const Manifold& face, float depth) {
    bool shows = false;
    for (int i = 0; i < face.pointCount; ++i) shows |= face.points[i].separation <= depth;
    return shows;
}

/// Makes points of clipped faces those of a manifold that has the one point of an edge pair, given their gaps along its
/// normal, if that point is one of them: the nearest, but for a corner that hangs over the face by a little.
inline void takeAlongEdges(std::span<const ManifoldPoint> points, float size, Manifold& out) {
    if (points.size() < 2 || points.size() > kMaxManifoldPoints) return;
    const float separation = out.points[0].separation;
    std::size_t nearest = 0;
    for (std::size_t i = 1; i < points.size(); ++i)
        if (points[i].separation < points[nearest].separation) nearest = i;
    if (std::fabs(points[nearest].separation - separation) > kChoiceTolerance * size) return;
    out.pointCount = 0;
    for (const ManifoldPoint& point : points) {
        out.points[out.pointCount] = point;
        out.points[out.pointCount++].separation = point.separation < separation ? separation : point.separation;
    }
    out.points[nearest].separation = separation;
}

/// A corner of a polygon being clipped. Edges are named 0..127 on the incident polygon and 128 + side of the reference
/// face; a corner is the meeting of two.
struct ClipPoint {
    Vec3 position;
    float separation = 0;
    std::uint8_t in = 0, out = 0;
};

/// A feature from what meets in it. Faces of hulls are fewer than 255, which is kept for other kinds of contact.
constexpr std::uint32_t faceFeature(const ClipPoint& point, int referenceFace, int incidentFace, bool flipped) {
    return static_cast<std::uint32_t>(point.in) | static_cast<std::uint32_t>(point.out) << 8 |
           (static_cast<std::uint32_t>(referenceFace) & 255u) << 16 |
           (static_cast<std::uint32_t>(incidentFace) & 127u) << 24 | (flipped ? 1u << 31 : 0u);
}
/// −1 where the feature names no faces. Only the lowest seven bits are known.
constexpr int incidentFaceOf(std::uint32_t feature) {
    return (feature >> 16 & 255u) == 255u ? -1 : static_cast<int>(feature >> 24 & 127u);
}
/// Indices below 512.
constexpr std::uint32_t edgeFeature(int edgeA, int edgeB) {
    const auto a = static_cast<std::uint32_t>(edgeA), b = static_cast<std::uint32_t>(edgeB);
    return (a & 255u) | (b & 255u) << 8 | 255u << 16 | (a >> 8 & 1u) << 24 | (b >> 8 & 1u) << 25;
}
/// A single point without a better name.
inline constexpr std::uint32_t kPointFeature = 255u << 16 | 1u << 26;

/// Of the faces around the corner of `incident` that lies farthest against `normal`, the one that looks most against
/// it.
int facingFace(const HullView& incident, const Vec3& normal);

/// Clips the face of `incident` that opposes face `face` of `reference` to the sides of that face, keeps what is at
/// most `margin` in front of it, and writes it half way between the surfaces; more points than `out` holds are reduced
/// to four. Both views in one frame; `size` is that of the smaller shape.
int clipToFace(const HullView& reference, int face, const HullView& incident, float margin, float size, bool flipped,
               std::span<ManifoldPoint> out);

/// Closest points of the lines p + s d and q + t e, clamped to the parameters [0, 1] of both.
struct ClosestOnSegments {
    Vec3 pointA, pointB;
    float s = 0, t = 0;
};
ClosestOnSegments closestOnSegments(const Vec3& p, const Vec3& d, const Vec3& q, const Vec3& e);

}  // namespace ragtop
