#include "world/joint_opening.h"

#include "constraints/initial_violation.h"
#include "constraints/joint_types.h"

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

}  // namespace ragtop
