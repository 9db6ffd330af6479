#include "quality.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <optional>
#include <variant>

#include "../stability/extremes.h"
#include "../stability/scenery.h"

namespace ragtop::speed {
namespace {

using stability::Engine;
using stability::larger;

double distance(const DVec3& a, const DVec3& b) { return std::hypot(a.x - b.x, a.y - b.y, a.z - b.z); }

/// A body of one shape where it is now; positions relative to the first body's.
struct Solid {
    const BodyDef* def;
    Vec3 at;
    Quat turned;
    Bounds bounds;
    const Box* box() const { return std::get_if<Box>(&def->shapes[0].geometry); }
};

/// Half the segment of a ball or capsule, and its radius; nothing for others.
struct Round {
    Vec3 half;
    float radius;
};
std::optional<Round> roundOf(const Solid& solid) {
    const Shape& shape = solid.def->shapes[0].geometry;
    if (const auto* ball = std::get_if<Sphere>(&shape)) return Round{{}, ball->radius};
    if (const auto* capsule = std::get_if<Capsule>(&shape))
        return Round{rotate(solid.turned, {0, capsule->halfHeight, 0}), capsule->radius};
    return {};
}

Vec3 reach(const Solid& solid) {
    if (const Box* box = solid.box()) {
        const Mat3 axes = toMat3(solid.turned);
        return abs(box->halfExtents.x * axes.cx) + abs(box->halfExtents.y * axes.cy) +
               abs(box->halfExtents.z * axes.cz);
    }
    const Round round = *roundOf(solid);
    return abs(round.half) + Vec3{round.radius, round.radius, round.radius};
}

/// Smallest overlap of the projections on all axes that can part two boxes; at most zero where one parts them.
float boxOverlap(const Solid& a, const Solid& b) {
    const Mat3 axesA = toMat3(a.turned), axesB = toMat3(b.turned);
    const std::array<Vec3, 3> u{axesA.cx, axesA.cy, axesA.cz}, v{axesB.cx, axesB.cy, axesB.cz};
    const Vec3 &ha = a.box()->halfExtents, &hb = b.box()->halfExtents;
    const Vec3 apart = b.at - a.at;
    float smallest = 1e9f;
    const auto test = [&](const Vec3& axis) {
        const float l = length(axis);
        if (l < 1e-3f) return;
        float sum = -std::abs(dot(apart, axis));
        for (int i = 0; i < 3; ++i) {
            const auto at = static_cast<std::size_t>(i);
            sum += ha[i] * std::abs(dot(u[at], axis)) + hb[i] * std::abs(dot(v[at], axis));
        }
        smallest = std::min(smallest, sum / l);
    };
    for (const Vec3& axis : u) test(axis);
    for (const Vec3& axis : v) test(axis);
    for (const Vec3& x : u)
        for (const Vec3& y : v) test(cross(x, y));
    return smallest;
}

/// Distance of two segments, each a middle and a half; by closest points with clamping.
float segmentDistance(const Vec3& p, const Vec3& halfP, const Vec3& q, const Vec3& halfQ) {
    const auto clampedShare = [](float t) { return std::clamp(t, -1.0f, 1.0f); };
    const Vec3 r = p - q;
    const float a = dot(halfP, halfP), e = dot(halfQ, halfQ), b = dot(halfP, halfQ);
    const float c = dot(halfP, r), f = dot(halfQ, r), denominator = a * e - b * b;
    float s = denominator > 1e-9f ? clampedShare((b * f - c * e) / denominator) : 0;
    const float t = e > 0 ? clampedShare((b * s + f) / e) : 0;
    if (a > 0) s = clampedShare((b * t - c) / a);
    return length(r + s * halfP - t * halfQ);
}

float ballInBox(const Solid& ball, const Solid& box) {
    const Vec3 local = inverseRotate(box.turned, ball.at - box.at), h = box.box()->halfExtents;
    const Vec3 closest = min(max(local, -h), h);
    return roundOf(ball)->radius - length(local - closest);
}

float overlapOf(const Solid& a, const Solid& b) {
    if (a.box() && b.box()) return boxOverlap(a, b);
    const auto roundA = roundOf(a), roundB = roundOf(b);
    if (roundA && roundB)
        return roundA->radius + roundB->radius - segmentDistance(a.at, roundA->half, b.at, roundB->half);
    const Solid& round = roundA ? a : b;
    if (!std::holds_alternative<Sphere>(round.def->shapes[0].geometry)) return 0;
    return ballInBox(round, roundA ? b : a);
}

bool mayMeet(const BodyDef& a, const BodyDef& b) {
    if (a.type == BodyType::fixed && b.type == BodyType::fixed) return false;
    const std::int32_t group = a.shapes[0].filter.group;
    return group == 0 || group != b.shapes[0].filter.group;
}

std::vector<Solid> solidsOf(const Scene& scene, const Engine& engine) {
    std::vector<Solid> solids;
    for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
        const BodyDef& def = scene.bodies[i].def;
        Solid solid{&def, {}, {}, {}};
        if (!solid.box() && !roundOf(solid)) continue;
        const Pose pose = def.type == BodyType::fixed ? def.pose : engine.motion(static_cast<int>(i)).pose;
        solid.at = toVec3(pose.position);
        solid.turned = pose.rotation;
        if (!isFinite(solid.at)) continue;
        solid.bounds = {solid.at - reach(solid), solid.at + reach(solid)};
        solids.push_back(solid);
    }
    std::ranges::sort(solids, {}, [](const Solid& solid) { return solid.bounds.lower.x; });
    return solids;
}

std::vector<float> overlapsOf(const Scene& scene, const Engine& engine) {
    const std::vector<Solid> solids = solidsOf(scene, engine);
    std::vector<float> overlaps;
    for (std::size_t i = 0; i < solids.size(); ++i)
        for (std::size_t j = i + 1; j < solids.size(); ++j) {
            if (solids[j].bounds.lower.x > solids[i].bounds.upper.x) break;
            if (!ragtop::overlaps(solids[i].bounds, solids[j].bounds) || !mayMeet(*solids[i].def, *solids[j].def))
                continue;
            const float overlap = overlapOf(solids[i], solids[j]);
            if (overlap > 0) overlaps.push_back(overlap);
        }
    std::ranges::sort(overlaps);
    return overlaps;
}

double gapOf(const Scene& scene, const SceneJoint& joint, const Engine& engine) {
    const JointBodies& frames = std::visit([](const auto& def) -> const JointBodies& { return def.bodies; }, joint.def);
    const auto anchor = [&](int body, const Frame& frame) {
        if (body == stability::kWorld) return DVec3{frame.position};
        const BodyDef& def = scene.bodies[static_cast<std::size_t>(body)].def;
        return transformPoint(def.type == BodyType::fixed ? def.pose : engine.motion(body).pose, frame.position);
    };
    return distance(anchor(joint.bodyA, frames.frameA), anchor(joint.bodyB, frames.frameB));
}

}  // namespace

Quality measureQuality(const Scene& scene, const Engine& engine) {
    Quality quality;
    const std::vector<float> overlaps = overlapsOf(scene, engine);
    if (!overlaps.empty()) {
        const auto last = static_cast<double>(overlaps.size() - 1);
        quality.overlapP99 = static_cast<double>(overlaps[static_cast<std::size_t>(0.99 * last)]);
        quality.overlapMax = static_cast<double>(overlaps.back());
    }
    for (const SceneJoint& joint : scene.joints) quality.gapMax = larger(quality.gapMax, gapOf(scene, joint, engine));
    for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
        const BodyDef& def = scene.bodies[i].def;
        if (def.type != BodyType::dynamic) continue;
        const DVec3 now = engine.motion(static_cast<int>(i)).pose.position;
        quality.movedMax = larger(quality.movedMax, distance(now, def.pose.position));
    }
    return quality;
}

}  // namespace ragtop::speed
