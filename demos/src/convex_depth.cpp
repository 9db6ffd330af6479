#include "convex_depth.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

namespace ragtop::demos {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

double dot(const DVec3& a, const DVec3& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
DVec3 cross(const DVec3& a, const DVec3& b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
double length(const DVec3& a) { return std::sqrt(dot(a, a)); }

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

/// By how much A must move back along n, from A to B, to leave B.
double overlapAlong(const ConvexSolid& a, const ConvexSolid& b, const DVec3& n) { return highest(a, n) - lowest(b, n); }

/// The least overlap over both senses of the normals and edge products of two polytopes.
double leastOverlap(const ConvexSolid& a, const ConvexSolid& b) {
    double least = kInfinity;
    const auto test = [&](const DVec3& n) {
        least = std::min({least, overlapAlong(a, b, n), overlapAlong(a, b, -1.0 * n)});
    };
    for (const DVec3& n : a.faceNormals) test(n);
    for (const DVec3& n : b.faceNormals) test(n);
    for (const DVec3& e : a.edges) {
        for (const DVec3& f : b.edges) {
            const DVec3 n = cross(e, f);
            if (const double l = length(n); l > 1e-6) test((1 / l) * n);
        }
    }
    return least;
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

/// Distance of a point from a box of eight corners.
double distanceToBox(const ConvexSolid& box, const DVec3& p) {
    DVec3 outside;
    for (const DVec3& n : box.faceNormals) {
        const double at = dot(p, n);
        const double beyond = std::max({at - highest(box, n), lowest(box, n) - at, 0.0});
        outside = outside + beyond * n;
    }
    return length(outside);
}

/// Distance of a segment from a box: convex along the segment, so a ternary search finds its least.
double distanceToBox(const ConvexSolid& box, const DVec3& p, const DVec3& q) {
    double low = 0, high = 1;
    const auto at = [&](double t) { return distanceToBox(box, p + t * (q - p)); };
    for (int i = 0; i < 100; ++i) {
        const double a = low + (high - low) / 3, b = high - (high - low) / 3;
        (at(a) <= at(b) ? high : low) = at(a) <= at(b) ? b : a;
    }
    return std::min({at(low), at(high), at(0), at(1)});
}

/// A grid of directions and then smaller and smaller steps around the best of them. Never below the true depth.
double searchedOverlap(const ConvexSolid& a, const ConvexSolid& b) {
    constexpr int kDirections = 200;
    constexpr double kWorthwhile = 1e-7;  // m; along ridges of the overlap a search without it goes on by ever less
    double least = leastOverlap(a, b);
    if (least <= 0) return least;
    DVec3 best{0, 1, 0};
    const auto test = [&](const DVec3& n) {
        const double overlap = overlapAlong(a, b, n);
        if (overlap >= least) return;
        least = overlap;
        best = n;
    };
    const double golden = std::numbers::pi * (3 - std::sqrt(5.0));
    for (int i = 0; i < kDirections; ++i) {
        const double y = 1 - 2 * (i + 0.5) / kDirections, r = std::sqrt(1 - y * y);
        test({r * std::cos(golden * i), y, r * std::sin(golden * i)});
    }
    for (double stride = 0.2; stride > 1e-7;) {
        const DVec3 start = best;
        const double before = least;
        for (const DVec3& d : {DVec3{1, 0, 0}, DVec3{0, 1, 0}, DVec3{0, 0, 1}}) {
            for (const double s : {stride, -stride}) {
                const DVec3 n = start + s * d;
                test((1 / length(n)) * n);
            }
        }
        if (before - least < kWorthwhile) stride /= 2;
    }
    return least;
}

ConvexSolid boxSolid(const Vec3& half, const Pose& pose) {
    ConvexSolid solid;
    solid.exactAxes = true;
    for (const DVec3& axis : {DVec3{1, 0, 0}, DVec3{0, 1, 0}, DVec3{0, 0, 1}}) {
        solid.faceNormals.push_back(turn(pose.rotation, axis));
    }
    solid.edges = solid.faceNormals;
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
        solid.exactAxes = true;
    } else if (const auto* capsule = std::get_if<Capsule>(&shape)) {
        const DVec3 up = turn(pose.rotation, {0, 1, 0});
        solid.points = {pose.position + capsule->halfHeight * up, pose.position - DVec3(capsule->halfHeight * up)};
        solid.radius = capsule->radius;
        solid.edges = {up};
        solid.exactAxes = true;
    } else if (const auto* hull = std::get_if<ConvexHull>(&shape)) {
        for (const Vec3& v : hull->vertices()) solid.points.push_back(pose.position + turn(pose.rotation, DVec3(v)));
    }
    return solid;
}

double overlapDepth(const ConvexSolid& a, const ConvexSolid& b) {
    const double radii = a.radius + b.radius;
    if (isRound(a) && isRound(b)) {
        return std::max(0.0,
                        radii - segmentDistance(a.points.front(), a.points.back(), b.points.front(), b.points.back()));
    }
    if (!a.exactAxes || !b.exactAxes) return std::max(0.0, searchedOverlap(a, b));
    if (isRound(a) || isRound(b)) {
        const ConvexSolid& box = isRound(a) ? b : a;
        const ConvexSolid& round = isRound(a) ? a : b;
        const double distance = distanceToBox(box, round.points.front(), round.points.back());
        if (distance > 0) return std::max(0.0, radii - distance);
    }
    return std::max(0.0, leastOverlap(a, b));
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
