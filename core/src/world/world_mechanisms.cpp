// Mechanisms of joints alone, which keep their own time within a step (direct/mechanism.h).

#include <algorithm>

#include "constraints/joint_types.h"
#include "world/fallback.h"

namespace ragtop {

namespace {

using direct::DQuat;
using direct::Mechanism;
using direct::MechanismBody;
using direct::MechanismJoint;
using direct::MechanismJointKind;

MechanismJointKind mechanismJoint(JointKind kind) {
    return kind == JointKind::ball    ? MechanismJointKind::ball
           : kind == JointKind::hinge ? MechanismJointKind::hinge
                                      : MechanismJointKind::fixed;
}

}  // namespace

/// Rigid rows of balls, hinges and fixed joints, between bodies that turn freely and touch nothing. Where joints stand
/// open, or hold bodies in a line or a plane, these may have had no answer: Newton's method has one.
bool WorldImpl::keepsOwnTime(const DirectIsland& island) const {
    if (island.tree || island.contactCount > 0 || island.jointCount == 0) return false;
    for (std::uint32_t i = 0; i < island.bodyCount; ++i) {
        const std::uint32_t body = directSet.bodies[island.firstBody + i];
        if (!turnsFreely(body) || bodies[body].directFailures > 0) return false;
    }
    for (std::uint32_t i = 0; i < island.jointCount; ++i)
        if (!isTreeJoint(joints.sims[directSet.joints[island.firstJoint + i]])) return false;
    return true;
}

void WorldImpl::planMechanisms() {
    directSet.mechanisms.resize(std::max(directSet.mechanisms.size(), directSet.islands.size()));
    for (std::size_t i = 0; i < directSet.islands.size(); ++i) {
        DirectIsland& island = directSet.islands[i];
        island.mechanism = keepsOwnTime(island);
        if (!island.mechanism) continue;
        if (!directSet.mechanisms[i]) directSet.mechanisms[i] = std::make_unique<Mechanism>(memory);
        island.watched = false;
        for (std::uint32_t j = 0; j < island.jointCount; ++j)
            island.watched |= joints.sims[directSet.joints[island.firstJoint + j]].breakable != 0;
    }
}

/// All of a body but its place, in double.
void WorldImpl::loadMechanismBody(std::uint32_t index, MechanismBody& body, direct::MechanismPose& pose) const {
    const BodyRecord& record = bodies[index];
    const BodyState& state = bodies.states[record.state];
    const BodyDynamics& d = bodies.dynamics[record.state];
    pose.q = direct::toDouble(record.rotation);
    body = {};
    body.v = DVec3(state.v), body.w = DVec3(state.w);
    if (!bodies.moves(index)) return;
    body.inverseMass = static_cast<double>(state.invMass);
    body.moments = DVec3(d.inertia), body.inverseMoments = DVec3(d.inverseInertia);
    body.acceleration = DVec3(d.acceleration), body.torque = DVec3(d.torque);
    body.damping = static_cast<double>(record.linearDamping);
    body.turnDamping = static_cast<double>(record.angularDamping);
    body.momentum = direct::inWorld(pose.q, body.moments) * body.w;
}

/// Bodies as they are, in double, and joints with their loads.
void WorldImpl::beginMechanism(const DirectIsland& island, Mechanism& mechanism) {
    const std::uint32_t* members = directSet.bodies.data() + island.firstBody;
    const std::uint32_t* held = directSet.joints.data() + island.firstJoint;
    std::size_t others = 0;
    for (std::uint32_t j = 0; j < island.jointCount; ++j)
        others += !bodies.moves(joints[held[j]].bodyA) || !bodies.moves(joints[held[j]].bodyB);
    mechanism.resize(island.bodyCount, others, island.jointCount);
    const DVec3 origin = bodies[members[0]].center;
    for (std::uint32_t i = 0; i < island.bodyCount; ++i) {
        directSet.index[members[i]] = i;
        loadMechanismBody(members[i], mechanism.body(i), mechanism.pose(i));
        mechanism.pose(i).x = bodies[members[i]].center - origin;
    }
    std::size_t next = island.bodyCount;
    for (std::uint32_t j = 0; j < island.jointCount; ++j) {
        const JointRecord& record = joints[held[j]];
        const JointSim& sim = joints.sims[held[j]];
        MechanismJoint& joint = mechanism.joint(j);
        joint.kind = mechanismJoint(sim.kind);
        const auto place = [&](std::uint32_t body, const Frame& local, DVec3& anchor, DQuat& frame) {
            const DQuat toBody = conjugate(direct::toDouble(bodies[body].local.rotation));
            anchor = rotate(toBody, DVec3(local.position));
            frame = toBody * direct::toDouble(local.rotation);
            if (bodies.moves(body)) return directSet.index[body];
            loadMechanismBody(body, mechanism.body(next), mechanism.pose(next));
            mechanism.pose(next).x = jointCenter(record, body) - origin;
            return static_cast<std::uint32_t>(next++);
        };
        joint.a = place(record.bodyA, sim.localA, joint.anchorA, joint.frameA);
        joint.b = place(record.bodyB, sim.localB, joint.anchorB, joint.frameB);
        joint.force = DVec3(sim.block.impulseFirst);
        joint.torque = DVec3(sim.block.impulseSecond);
    }
    int pace = 1;
    for (std::uint32_t i = 0; i < island.bodyCount; ++i)
        pace = std::max(pace, static_cast<int>(bodies[members[i]].pace.inner));
    mechanism.setPace(pace);
    mechanism.begin();
}

/// Fewer inner steps when a second has asked for half of them only.
void WorldImpl::keepPace(const DirectIsland& island, const Mechanism& mechanism) {
    constexpr std::uint8_t kHysteresisSteps = 60;  // a second at 60 Hz
    int pace = mechanism.pace();
    const bool calm = pace > 1 && mechanism.largestNeed() <= 0.5 * pace;
    const BodyRecord& first = bodies[directSet.bodies[island.firstBody]];
    std::uint8_t steps = calm ? static_cast<std::uint8_t>(first.pace.calm + 1) : std::uint8_t{0};
    if (steps >= kHysteresisSteps) pace /= 2, steps = 0;
    for (std::uint32_t i = 0; i < island.bodyCount; ++i) {
        BodyRecord& body = bodies[directSet.bodies[island.firstBody + i]];
        body.pace.inner = static_cast<std::uint8_t>(pace);
        body.pace.calm = steps;
    }
}

/// Takes over what modules did to velocities since the last substep.
void WorldImpl::readMechanism(const DirectIsland& island, Mechanism& mechanism) {
    for (std::uint32_t i = 0; i < island.bodyCount; ++i) {
        const BodyState& state = bodies.states[directSet.bodies[island.firstBody + i]];
        const MechanismBody& body = mechanism.body(i);
        const Vec3 v = toVec3(body.v), w = toVec3(body.w);
        if (state.v == v && state.w == w) continue;
        mechanism.changeVelocity(i, DVec3(state.v) - DVec3(v), DVec3(state.w) - DVec3(w));
    }
    std::size_t next = island.bodyCount;
    for (std::uint32_t j = 0; j < island.jointCount; ++j) {
        const JointRecord& joint = joints[directSet.joints[island.firstJoint + j]];
        if (bodies.moves(joint.bodyA) && bodies.moves(joint.bodyB)) continue;
        const BodyState& state = bodies.states[bodies[bodies.moves(joint.bodyA) ? joint.bodyB : joint.bodyA].state];
        MechanismBody& body = mechanism.body(next++);
        body.v = DVec3(state.v), body.w = DVec3(state.w);
    }
}

/// Before velocities change: a mechanism adds what acts from outside by itself.
void WorldImpl::readMechanisms() {
    for (std::size_t i = 0; i < directSet.islands.size(); ++i)
        if (const DirectIsland& island = directSet.islands[i]; island.mechanism && !island.fellBack)
            readMechanism(island, *directSet.mechanisms[i]);
}

/// Where the bodies are at the end of a substep, and how they move.
void WorldImpl::writeMechanism(const DirectIsland& island, Mechanism& mechanism) {
    const DVec3 origin = bodies[directSet.bodies[island.firstBody]].center;
    for (std::uint32_t i = 0; i < island.bodyCount; ++i) {
        const std::uint32_t index = directSet.bodies[island.firstBody + i];
        const BodyRecord& record = bodies[index];
        const MechanismBody& body = mechanism.body(i);
        const direct::MechanismPose& pose = mechanism.pose(i);
        BodyState& state = bodies.states[index];
        state.v = toVec3(body.v), state.w = toVec3(body.w);
        state.dp = toVec3(pose.x - (record.center - origin));
        const Quat rotation = direct::toFloat(pose.q);
        state.dq = direct::toFloat(pose.q * conjugate(direct::toDouble(record.rotation)));
        bodies.inertias[index] = bodies.inverseInertiaAt(index, rotation);
        bodies.storeMomentum(index, rotation);
    }
}

/// Loads of the joints, and how often hinges have turned.
void WorldImpl::storeLoads(const DirectIsland& island, Mechanism& mechanism) {
    constexpr int kFast = 2;  // inner steps, beyond which a hinge may turn by radians in a step
    if (!context.lastSubstep && !island.watched && mechanism.pace() <= kFast) return;
    mechanism.findLoads();
    for (std::uint32_t j = 0; j < island.jointCount; ++j) {
        JointSim& sim = joints.sims[directSet.joints[island.firstJoint + j]];
        sim.block.impulseFirst = toVec3(mechanism.joint(j).force);
        sim.block.impulseSecond = toVec3(mechanism.joint(j).torque);
        refreshJoint(sim, BodyPair(bodies.states.data(), bodies.inertias.data(), sim.stateA, sim.stateB),
                     {jointContext, false});
        recordLoad(sim);
    }
}

/// Moves a mechanism through the substep before anything else has; it is seen where it is only after all have moved.
void WorldImpl::solveMechanism(DirectIsland& island, Mechanism& mechanism, DirectPass pass) {
    if (pass == DirectPass::velocities) {
        writeMechanism(island, mechanism);
        storeLoads(island, mechanism);
        return;
    }
    const auto h = static_cast<double>(context.h);
    if (!mechanism.advance(h, h * static_cast<double>(jointContext.softness.biasRate))) fallBack(*this, island, pass);
    island.report.iterations = mechanism.iterations();
    island.report.factorizations = mechanism.factorizations();
}

}  // namespace ragtop
