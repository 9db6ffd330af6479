#include "convex_depth.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "difference_polytope.h"
#include "double_math.h"

namespace ragtop::demos {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// Rotation in double; q is normalized on the way, since single precision leaves it a little off.
DVec3 turn(const Quat& q, const DVec3& v) {
    const double w = q.w, norm = static_cast<double>(q.x) * q.x + static_cast<double>(q.y) * q.y +
                                 static_cast<double>(q.z) * q.z + w * w;
    const DVec3 u{q.x, q.y, q.z};
    const DVec3 t = (2 / norm) * cross(u, v);
    return v + w * t + cross(u, t);
}

double highest(const ConvexSolid& s, const DVec3& n) {
    double best = -kInfinity;
    for (const DVec3& p : s.points) best = std::max(best, dot(p, n));
    return best + s.radius;
}
double lowest(const ConvexSolid& s, const DVec3& n) {
    double best = kInfinity;
    for (const DVec3& p : s.points) best = std::min(best, dot(p, n));
    return best - s.radius;
}

/// Distance of the closest points of two segments [Ericson, Real-Time Collision Detection, 2005, 5.1.9].
double segmentDistance(const DVec3& p1, const DVec3& q1, const DVec3& p2, const DVec3& q2) {
    const DVec3 d1 = q1 - p1, d2 = q2 - p2, r = p1 - p2;
    const double a = dot(d1, d1), e = dot(d2, d2), f = dot(d2, r), c = dot(d1, r), b = dot(d1, d2);
    double s = 0, t = 0;
    if (a > 0 && e > 0) {
        const double denominator = a * e - b * b;
        s = denominator > 1e-12 * a * e ? std::clamp((b * f - c * e) / denominator, 0.0, 1.0) : 0;
        t = (b * s + f) / e;
        if (t < 0 || t > 1) {
            t = std::clamp(t, 0.0, 1.0);
            s = std::clamp((b * t - c) / a, 0.0, 1.0);
        }
    } else if (a > 0) {
        s = std::clamp(-c / a, 0.0, 1.0);
    } else if (e > 0) {
        t = std::clamp(f / e, 0.0, 1.0);
    }
    return length((p1 + s * d1) - (p2 + t * d2));
}

bool isRound(const ConvexSolid& s) { return s.points.size() <= 2; }

ConvexSolid boxSolid(const Vec3& half, const Pose& pose) {
    ConvexSolid solid;
    for (int i = 0; i < 8; ++i) {
        solid.points.push_back(
            pose.position +
            turn(pose.rotation, DVec3{i & 1 ? half.x : -half.x, i & 2 ? half.y : -half.y, i & 4 ? half.z : -half.z}));
    }
    return solid;
}

}  // namespace

ConvexSolid solidOf(const Shape& shape, const Pose& pose) {
    ConvexSolid solid;
    if (const auto* box = std::get_if<Box>(&shape)) return boxSolid(box->halfExtents, pose);
    if (const auto* ball = std::get_if<Sphere>(&shape)) {
        solid.points = {pose.position};
        solid.radius = ball->radius;
    } else if (const auto* capsule = std::get_if<Capsule>(&shape)) {
        const DVec3 up = turn(pose.rotation, {0, 1, 0});
        solid.points = {pose.position + capsule->halfHeight * up, pose.position - DVec3(capsule->halfHeight * up)};
        solid.radius = capsule->radius;
    } else if (const auto* hull = std::get_if<ConvexHull>(&shape)) {
        for (const Vec3& v : hull->vertices()) solid.points.push_back(pose.position + turn(pose.rotation, DVec3(v)));
    }
    return solid;
}

double overlapDepth(const ConvexSolid& a, const ConvexSolid& b) {
    if (isRound(a) && isRound(b)) {
        const double apart = segmentDistance(a.points.front(), a.points.back(), b.points.front(), b.points.back());
        return std::max(0.0, a.radius + b.radius - apart);
    }
    return std::max(0.0, DifferencePolytope(a, b).leastOverlap());
}

double overlapDepth(const ConvexSolid& solid, const DVec3& p, const DVec3& q, const DVec3& r) {
    const DVec3 product = cross(q - p, r - p);
    const double area = length(product);
    if (!(area > 0)) return 0;
    const DVec3 n = (1 / area) * product;
    const auto deepest = std::min_element(solid.points.begin(), solid.points.end(),
                                          [&](const DVec3& a, const DVec3& b) { return dot(a, n) < dot(b, n); });
    const double depth = solid.radius - dot(*deepest - p, n);
    const double size = highest(solid, n) - lowest(solid, n);
    if (depth <= 0 || depth > size) return 0;
    for (const auto& [from, to] : {std::array{p, q}, std::array{q, r}, std::array{r, p}}) {
        if (dot(cross(to - from, *deepest - from), n) < 0) return 0;
    }
    return depth;
}

Box3 boundsOf(const ConvexSolid& solid) {
    return {{lowest(solid, {1, 0, 0}), lowest(solid, {0, 1, 0}), lowest(solid, {0, 0, 1})},
            {highest(solid, {1, 0, 0}), highest(solid, {0, 1, 0}), highest(solid, {0, 0, 1})}};
}

}  // namespace ragtop::demos
