#include "ragdoll_extent.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace ragtop {
namespace {

/// How far a shape reaches below the origin of its frame.
struct DepthBelow {
    Quat rotation;

    float operator()(const Sphere& s) const { return s.radius; }
    float operator()(const Capsule& s) const {
        return s.radius + s.halfHeight * std::abs(rotate(rotation, {0, 1, 0}).y);
    }
    float operator()(const Box& s) const {
        // Row of the rotation that belongs to y.
        const Vec3 up = inverseRotate(rotation, {0, 1, 0});
        return dot(abs(up), s.halfExtents);
    }
    float operator()(const ConvexHull& s) const {
        float depth = -std::numeric_limits<float>::infinity();
        for (const Vec3& v : s.vertices()) depth = std::max(depth, -rotate(rotation, v).y);
        return depth;
    }
    template <class Other>
    float operator()(const Other&) const {
        return 0;
    }
};

}  // namespace

Vec3 middleOf(const RagdollDef& def) {
    if (def.parts.empty()) return {};
    Vec3 lower = def.parts[0].bind.position, upper = lower;
    for (const RagdollPart& part : def.parts) {
        lower = min(lower, part.bind.position);
        upper = max(upper, part.bind.position);
    }
    return 0.5f * (lower + upper);
}

float lowestPointOf(const RagdollDef& def, const Quat& rotation) {
    float lowest = std::numeric_limits<float>::infinity();
    for (const RagdollPart& part : def.parts) {
        const Frame frame = Frame{{}, rotation} * part.bind * part.frame;
        lowest = std::min(lowest, frame.position.y - std::visit(DepthBelow{frame.rotation}, part.shape));
    }
    return std::isfinite(lowest) ? lowest : 0;
}

float lowestPointOf(const Robot& robot, const Quat& rotation) {
    float lowest = std::numeric_limits<float>::infinity();
    for (const RobotBody& body : robot.bodies) {
        if (body.anchored) continue;
        for (const ShapeDef& shape : body.shapes) {
            const Frame frame = Frame{{}, rotation} * body.pose * shape.frame;
            lowest = std::min(lowest, frame.position.y - std::visit(DepthBelow{frame.rotation}, shape.geometry));
        }
    }
    return std::isfinite(lowest) ? lowest : 0;
}

}  // namespace ragtop
