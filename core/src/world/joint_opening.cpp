#include "world/joint_opening.h"

#include "base/prefetch.h"
#include "constraints/initial_violation.h"
#include "constraints/joint_types.h"
#include "direct/choice.h"

namespace ragtop {

namespace {

/// m, between what a joint holds together.
float gapOf(const ClosingView& world, const JointSim& sim, const JointBodiesAtStep& at) {
    if (sim.kind == JointKind::ball || sim.kind == JointKind::hinge || sim.kind == JointKind::fixed)
        return length(at.centerOffset + rotate(at.rotationB, sim.localB.position) -
                      rotate(at.rotationA, sim.localA.position));
    if (sim.kind == JointKind::distance) return 0;  // beyond a stop, or beyond what it was made with
    return jointState(sim, at, world.bodies.states.data(), 0).gap;
}

/// Ways that close joints know nothing of what couplings hold.
bool isCoupled(const JointSim& sim) {
    bool coupled = (sim.axis.features & AxisRows::kCoupled) != 0;
    for (std::uint32_t i = 0; hasAxes(sim.kind) && i < withAxes(sim).axes.freeRows; ++i)
        coupled = coupled || (withAxes(sim).axes.axis[i].features & AxisRows::kCoupled) != 0;
    return coupled;
}

/// What tells of a joint whether it is open lies in these lines of memory; none of it was touched lately.
void prefetchJoint(const ClosingView& world, std::uint32_t joint) {
    const JointSim& sim = world.joints.sims[joint];
    prefetch(&world.joints[joint].place);
    prefetch(&sim);
    prefetch(&sim.localB.rotation);
    prefetch(&sim.axis.features);
    prefetch(&sim.axis.atLower.margin);
    prefetch(&sim.axis.atUpper.margin);
    prefetch(&sim.ball.features);
    prefetch(&sim.ball.swing);
    prefetch(&sim.ball.twistLower.margin);
    prefetch(&sim.ball.twistUpper.margin);
    prefetch(&sim.ball.swingLimit);
}

}  // namespace

float opening(const ClosingView& world, std::uint32_t index) {
    const JointRecord& joint = world.joints[index];
    const JointSim& sim = world.joints.sims[index];
    const JointBodiesAtStep at = jointBodies(world.bodies, joint);
    const float sizeA = world.bodies[joint.bodyA].size, sizeB = world.bodies[joint.bodyB].size;
    const float size = !world.bodies.moves(joint.bodyA)   ? sizeB
                       : !world.bodies.moves(joint.bodyB) ? sizeA
                                                          : std::min(sizeA, sizeB);
    const float angle = kTorn / kTornStop * turnedApart(sim, at);
    return std::max(size > 0 ? gapOf(world, sim, at) / size : 0.0f, angle > kTorn ? angle : 0.0f);
}

float overrunNow(const ClosingView& world, std::uint32_t index) {
    const JointRecord& joint = world.joints[index];
    JointSim& sim = world.joints.sims[index];
    const Vec3 turning = world.bodies.states[sim.stateB].w - world.bodies.states[sim.stateA].w;
    // Margins are those of the last substep or the one before it.
    if (limitOverrun(sim) + 2 * world.context.h * length(turning) < kOpen) return 0;
    placeJoint(sim, jointBodies(world.bodies, joint), world.bodies.states.data(), world.bodies.inertias.data());
    return limitOverrun(sim);
}

float widestOpening(const ClosingView& world, std::span<const std::uint32_t> joints) {
    float widest = 0;
    for (const std::uint32_t joint : joints) {
        widest = std::max({widest, opening(world, joint), kTorn / kTornStop * limitOverrun(world.joints.sims[joint])});
    }
    return widest;
}

bool isOpen(const ClosingView& world, std::size_t g) {
    const EnergyGuard& guard = world.energyGuard;
    const std::span<const std::uint32_t> group = guard.membersOf(g);
    if (group.size() > direct::kMostBodies) return false;
    for (const std::uint32_t body : group)
        if (!world.bodies.moves(body) || !world.bodies.isAwake(body)) return false;
    bool open = false, coupled = false;
    const auto ofSubstep = [&](std::uint32_t body) {
        return world.context.h * world.context.h * lengthSquared(world.bodies.states[body].w);
    };
    constexpr std::size_t kAhead = 3;  // joints
    for (std::size_t k = guard.jointStarts[g]; k < guard.jointStarts[g + 1]; ++k) {
        if (k + kAhead < guard.joints.size()) prefetchJoint(world, guard.joints[k + kAhead]);
        const std::uint32_t joint = guard.joints[k];
        if (!world.joints.isHolding(joint)) continue;
        open = open || opening(world, joint) > std::min(kOpen + openingOfTurns(world, joint, ofSubstep), kTorn) ||
               overrunNow(world, joint) > kOpen;
        coupled = coupled || isCoupled(world.joints.sims[joint]);
    }
    return !coupled && (open || deepestTouch(world, group) > kOpen);
}

}  // namespace ragtop
