#include <algorithm>
#include <cmath>
#include <vector>

#include "fit.h"

namespace ragtop {
namespace {

/// A shape as a sum of a segment, a box and a ball, of which each may be nothing, or as corners about its frame.
struct Core {
    Vec3 center, half;  ///< of the segment, from its middle to its end
    float radius = 0;
    Vec3 boxHalf{};
    Mat3 axes;
    std::vector<Vec3> corners{};  ///< of a hull, from the centre
};

Core coreOf(const FittedShape& fitted, float margin) {
    Core core{fitted.frame.position, {}, margin, {}, toMat3(fitted.frame.rotation)};
    if (const auto* capsule = std::get_if<Capsule>(&fitted.shape)) {
        core.half = capsule->halfHeight * core.axes.cy;
        core.radius += capsule->radius;
    } else if (const auto* box = std::get_if<Box>(&fitted.shape)) {
        core.boxHalf = box->halfExtents;
    } else if (const auto* hull = std::get_if<ConvexHull>(&fitted.shape)) {
        for (const Vec3& corner : hull->vertices()) core.corners.push_back(core.axes * corner);
    }
    return core;
}

/// The point that is farthest along a direction, from the centre.
Vec3 farthestOf(const Core& core, const Vec3& direction) {
    Vec3 point = dot(core.half, direction) < 0 ? -core.half : core.half;
    const auto along = [&](const Vec3& axis, float half) { point += (dot(axis, direction) < 0 ? -half : half) * axis; };
    along(core.axes.cx, core.boxHalf.x);
    along(core.axes.cy, core.boxHalf.y);
    along(core.axes.cz, core.boxHalf.z);
    if (!core.corners.empty())
        point += *std::max_element(core.corners.begin(), core.corners.end(),
                                   [&](const Vec3& a, const Vec3& b) { return dot(a, direction) < dot(b, direction); });
    return point + core.radius * normalized(direction, {0, 1, 0});
}

float reachAlong(const Core& core, const Vec3& direction) { return dot(farthestOf(core, direction), direction); }

bool separatedAlong(const Core& a, const Core& b, const Vec3& direction) {
    const float way = dot(b.center - a.center, direction);
    return way > reachAlong(a, direction) + reachAlong(b, -direction) ||
           -way > reachAlong(a, -direction) + reachAlong(b, direction);
}

/// Towards the nearest point of all ways from one to the other, by ways to ever farther points [Gilbert 1966]. Of hulls
/// that are nearer than a hundredth of their size it may find no gap.
bool separatedByDescent(const Core& a, const Core& b) {
    constexpr int kTries = 64;
    Vec3 way = b.center - a.center;
    for (int i = 0; i < kTries && lengthSquared(way) > 0; ++i) {
        if (separatedAlong(a, b, way)) return true;
        const Vec3 shorter = b.center + farthestOf(b, -way) - a.center - farthestOf(a, way), change = shorter - way;
        const float square = lengthSquared(change);
        if (!(square > 0)) return false;
        way += std::clamp(-dot(way, change) / square, 0.0f, 1.0f) * change;
    }
    return false;
}

/// The shortest way between two segments [Ericson, Real-Time Collision Detection, 2005, 5.1.9].
Vec3 betweenSegments(const Core& a, const Core& b) {
    const Vec3 r = a.center - b.center;
    const float aa = dot(a.half, a.half), bb = dot(b.half, b.half), ab = dot(a.half, b.half);
    const float ar = dot(a.half, r), br = dot(b.half, r);
    const float determinant = aa * bb - ab * ab;
    const auto clamped = [](float value) { return std::clamp(value, -1.0f, 1.0f); };
    float s = determinant > 1e-6f * aa * bb ? clamped((ab * br - ar * bb) / determinant) : 0.0f;
    const float t = bb > 0 ? clamped((ab * s + br) / bb) : 0.0f;
    if (aa > 0) s = clamped((ab * t - ar) / aa);
    return b.center + t * b.half - a.center - s * a.half;
}

}  // namespace

float bottomOf(const FittedShape& fitted, const Vec3& up) {
    return dot(fitted.frame.position, up) - reachAlong(coreOf(fitted, 0), -up);
}

bool mayOverlap(const FittedShape& a, const FittedShape& b, float margin) {
    const Core coreA = coreOf(a, 0.5f * margin), coreB = coreOf(b, 0.5f * margin);
    if (separatedAlong(coreA, coreB, betweenSegments(coreA, coreB))) return false;
    if (separatedAlong(coreA, coreB, coreB.center - coreA.center)) return false;
    if (!coreA.corners.empty() || !coreB.corners.empty()) return !separatedByDescent(coreA, coreB);
    for (int i = 0; i < 3; ++i) {
        const Vec3& axisA = i == 0 ? coreA.axes.cx : i == 1 ? coreA.axes.cy : coreA.axes.cz;
        const Vec3& axisB = i == 0 ? coreB.axes.cx : i == 1 ? coreB.axes.cy : coreB.axes.cz;
        if (separatedAlong(coreA, coreB, axisA) || separatedAlong(coreA, coreB, axisB)) return false;
        for (int j = 0; j < 3; ++j) {
            const Vec3& other = j == 0 ? coreB.axes.cx : j == 1 ? coreB.axes.cy : coreB.axes.cz;
            const Vec3 direction = cross(axisA, other);
            // Parallel axes give no direction; that of the faces has been tried.
            if (lengthSquared(direction) > 1e-6f && separatedAlong(coreA, coreB, direction)) return false;
        }
    }
    return true;
}

}  // namespace ragtop
