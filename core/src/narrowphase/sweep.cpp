#include "narrowphase/distance.h"

/// Conservative advancement [Mirtich, 1996]: a step never longer than distance over the fastest possible approach.
namespace ragtop {
namespace {

constexpr int kMaxSweepSteps = 48;  ///< a bound, as that of GJK
constexpr int kMaxImpactSteps = 96;  ///< a bound of conservative advancement
/// Of the size of B: how near counts as touching.
constexpr float kTouch = 1e-5f;
constexpr float kImpactTouch = 1e-4f;  ///< the same of what turns as well

/// Radius of the ball about the origin of a convex shape that holds it.
float reach(const ConvexView& shape) {
    if (shape.kind != ConvexKind::hull) return length(shape.halfExtents) + shape.radius;
    float most = 0;
    for (const Vec3& vertex : shape.hull->vertices) {
        const float square = lengthSquared(vertex);
        most = square > most ? square : most;
    }
    return std::sqrt(most) + shape.radius;
}

/// The direction of a distance is known to a few roundings, so a long step may end a little too deep; then half of it
/// is tried.
float halfBack(float safe, float t) { return safe + 0.5f * (t - safe); }

/// d(t) is convex while B only translates, so Newton's steps from the left never pass its root.
template <class ShapeA>
SweepHit sweepAny(const ShapeA& a, const ConvexView& b, const Frame& bInA, const Vec3& translation, float closer) {
    const float touch = kTouch * reach(b);
    SweepHit out;
    out.fraction = closer;
    float t = 0, safe = 0;
    for (int step = 0; step < kMaxSweepSteps; ++step) {
        const Distance d = distance(a, b, {bInA.position + t * translation, bInA.rotation});
        if (step > 0 && (d.coresOverlap || d.distance < -touch)) {
            t = halfBack(safe, t);
            continue;
        }
        safe = t;
        out.point = d.pointA;
        out.normal = d.normal;
        if (d.distance <= touch) {
            out.hit = true;
            out.fraction = t;
            return out;
        }
        const float approach = -dot(d.normal, translation);
        if (approach <= 0) return out;
        const float next = t + d.distance / approach;
        if (!(next <= closer)) return out;
        if (next <= t) break;
        t = next;
    }
    out.hit = true;
    out.fraction = safe;
    return out;
}

/// With the rotation vector ω of the whole motion and the reach r of B about its origin, no point of B approaches along
/// −n faster than −n · translation + |ω × n| r per unit of t.
template <class ShapeA>
SweepHit timeOfImpactAny(const ShapeA& a, const ConvexView& b, const Frame& start, const Frame& end, float target) {
    const Vec3 translation = end.position - start.position;
    const Quat turn = end.rotation * conjugate(start.rotation);
    const Vec3 omega = rotationVector(turn);
    const float angle = length(omega);
    const float radius = reach(b);
    const float touch = target + kImpactTouch * radius;
    SweepHit out;
    float t = 0, safe = 0;
    for (int step = 0; step < kMaxImpactSteps; ++step) {
        const Quat rotation = angle > 0 ? rotationAbout(omega, t * angle) * start.rotation : start.rotation;
        const Distance d = distance(a, b, {start.position + t * translation, normalized(rotation)});
        if (step > 0 && (d.coresOverlap || d.distance < target - kImpactTouch * radius)) {
            t = halfBack(safe, t);
            continue;
        }
        safe = t;
        out.point = d.pointA;
        out.normal = d.normal;
        if (d.distance <= touch) {
            out.hit = true;
            out.overlap = d.coresOverlap;
            out.fraction = t;
            return out;
        }
        const float approach = -dot(d.normal, translation) + length(cross(omega, d.normal)) * radius;
        if (approach <= 0) return out;
        const float next = t + (d.distance - target) / approach;
        if (!(next < 1)) return out;
        if (next <= t) break;
        t = next;
    }
    out.hit = true;  // not proven free beyond, so the motion ends there
    out.fraction = safe;
    return out;
}

}  // namespace

SweepHit sweep(const ConvexView& a, const ConvexView& b, const Frame& bInA, const Vec3& translation, float closer) {
    return sweepAny(a, b, bInA, translation, closer);
}

SweepHit sweep(const TriangleView& a, const ConvexView& b, const Frame& bInA, const Vec3& translation, float closer) {
    return sweepAny(a, b, bInA, translation, closer);
}

SweepHit timeOfImpact(const ConvexView& a, const ConvexView& b, const Frame& start, const Frame& end, float target) {
    return timeOfImpactAny(a, b, start, end, target);
}

SweepHit timeOfImpact(const TriangleView& a, const ConvexView& b, const Frame& start, const Frame& end, float target) {
    return timeOfImpactAny(a, b, start, end, target);
}

}  // namespace ragtop
