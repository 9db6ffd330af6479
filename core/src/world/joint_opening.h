#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>
#include <span>

#include "constraints/joint_sim.h"
#include "model/joint_bodies.h"
#include "world/joint_closing.h"

/// How far a step has left joints open, in sizes of the smaller of the bodies that they move.
namespace ragtop {

/// Gap between anchors, in sizes of the smaller body and beyond what turning leaves, or angle beyond a hard stop, rad,
/// that is closed.
inline constexpr float kOpen = 0.02f;
inline constexpr float kTorn = 0.1f;       ///< the same, which no step may leave of joints that were closed
inline constexpr float kTornStop = 0.05f;  ///< rad beyond a hard stop, likewise

/// The gap of a joint over the size, or what it is turned apart by, where that is torn; 0 where these have none.
float opening(const ClosingView& world, std::uint32_t joint);
/// How far the joint is beyond its hard stops, rad or in its lengths; it is placed anew only where it may be.
float overrunNow(const ClosingView& world, std::uint32_t joint);
/// Of joints that were just placed; what is beyond stops counts as the gap that is as torn.
float widestOpening(const ClosingView& world, std::span<const std::uint32_t> joints);

/// Has a step left a group of the energy guard with joints that are to be closed, or parts in each other?
bool isOpen(const ClosingView& world, std::size_t group);

/// What turning leaves of a gap: an arm r that turns by θ ends it ½ θ² r from where its speed led. `turnSquared` tells
/// θ² of a body.
template <class TurnSquared>
float openingOfTurns(const ClosingView& world, std::uint32_t index, TurnSquared&& turnSquared) {
    const JointRecord& joint = world.joints[index];
    const JointSim& sim = world.joints.sims[index];
    float left = 0, size = std::numeric_limits<float>::max();
    const auto add = [&](std::uint32_t body, const Vec3& arm) {
        if (!world.bodies.moves(body)) return;
        left += 0.5f * turnSquared(body) * length(arm);
        size = std::min(size, world.bodies[body].size);
    };
    add(joint.bodyA, sim.localA.position);
    add(joint.bodyB, sim.localB.position);
    return size > 0 ? left / size : 0;
}

/// Calls visit(joint) once for each joint of a group.
template <class Visit>
void forEachJoint(const ClosingView& world, std::span<const std::uint32_t> group, Visit&& visit) {
    for (const std::uint32_t joint : world.energyGuard.jointsOf(world.energyGuard.groupOfBody(group.front())))
        if (world.joints.isHolding(joint)) visit(joint);
}

}  // namespace ragtop
