#include "narrowphase/distance.h"
#include "narrowphase/sweep_ball.h"
#include "narrowphase/triangle_feature.h"

/// Conservative advancement [Mirtich, 1996]: a step never longer than distance over the fastest possible approach.
namespace ragtop {
namespace {

constexpr int kMaxSweepSteps = 48;   ///< a bound, as that of GJK
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

bool touchesBall(const TriangleView& t, const Vec3& center, float radius) {
    const Vec3 v[3] = {t.a - center, t.b - center, t.c - center};
    if (std::abs(dot(t.normal, v[0])) > radius) return false;
    Feature feature;
    return !(lengthSquared(nearestOnTriangle(v, t.normal, {}, feature)) > radius * radius);
}

/// The direction of a distance is known to a few roundings, so a long step may end a little too deep; then half of it
/// is tried.
float halfBack(float safe, float t) { return safe + 0.5f * (t - safe); }

/// The first t up to `closer` at which distanceAt(t) has fallen to `target`, to within a tolerance; approachOf(d)
/// bounds how fast it falls along the direction of a distance.
template <class DistanceAt, class Approach>
SweepHit advance(DistanceAt&& distanceAt, Approach&& approachOf, float target, float tolerance, float closer,
                 int most) {
    SweepHit out;
    out.fraction = closer;
    float t = 0, safe = 0;
    for (int step = 0; step < most; ++step) {
        const Distance d = distanceAt(t);
        if (step > 0 && (d.coresOverlap || d.distance < target - tolerance)) {
            t = halfBack(safe, t);
            continue;
        }
        safe = t;
        out.point = d.pointA;
        out.normal = d.normal;
        if (d.distance <= target + tolerance) {
            out.hit = true;
            out.overlap = d.coresOverlap;
            out.fraction = t;
            return out;
        }
        const float approach = approachOf(d);
        if (approach <= 0) return out;
        const float next = t + (d.distance - target) / approach;
        if (!(next <= closer)) return out;
        if (next <= t) break;
        t = next;
    }
    out.hit = true;  // not proven free beyond, so the motion ends there
    out.fraction = safe;
    return out;
}

/// d(t) is convex while B only translates, so Newton's steps from the left never pass its root.
template <class ShapeA>
SweepHit sweepAny(const ShapeA& a, const ConvexView& b, const Frame& bInA, const Vec3& translation, float closer) {
    return advance(
        [&](float t) {
            return distance(a, b, {bInA.position + t * translation, bInA.rotation});
        },
        [&](const Distance& d) { return -dot(d.normal, translation); }, 0, kTouch * reach(b), closer, kMaxSweepSteps);
}

/// With the rotation vector ω of the whole motion and the reach r of B about its origin, no point of B approaches along
/// −n faster than −n · translation + |ω × n| r per unit of t.
template <class ShapeA>
SweepHit timeOfImpactAny(const ShapeA& a, const ConvexView& b, const Frame& start, const Frame& end, float target) {
    const Vec3 translation = end.position - start.position;
    const Vec3 omega = rotationVector(end.rotation * conjugate(start.rotation));
    const float angle = length(omega), radius = reach(b);
    const auto at = [&](float t) {
        const Quat rotation = angle > 0 ? rotationAbout(omega, t * angle) * start.rotation : start.rotation;
        return distance(a, b, {start.position + t * translation, normalized(rotation)});
    };
    const auto approach = [&](const Distance& d) {
        return -dot(d.normal, translation) + length(cross(omega, d.normal)) * radius;
    };
    SweepHit hit = advance(at, approach, target, kImpactTouch * radius, std::nextafter(1.0f, 0.0f), kMaxImpactSteps);
    if (!hit.hit) hit.fraction = 1;
    return hit;
}

}  // namespace

SweepHit sweep(const ConvexView& a, const ConvexView& b, const Frame& bInA, const Vec3& translation, float closer) {
    return sweepAny(a, b, bInA, translation, closer);
}

SweepHit sweep(const TriangleView& a, const ConvexView& b, const Frame& bInA, const Vec3& translation, float closer) {
    if (b.kind == ConvexKind::sphere && !touchesBall(a, bInA.position, (1 + kTouch) * b.radius))
        return sweepBall(a, bInA.position, b.radius, translation, closer);
    return sweepAny(a, b, bInA, translation, closer);
}

SweepHit timeOfImpact(const ConvexView& a, const ConvexView& b, const Frame& start, const Frame& end, float target) {
    return timeOfImpactAny(a, b, start, end, target);
}

SweepHit timeOfImpact(const TriangleView& a, const ConvexView& b, const Frame& start, const Frame& end, float target) {
    return timeOfImpactAny(a, b, start, end, target);
}

}  // namespace ragtop
