// Mechanisms of joints alone, which keep their own time within a step (direct/mechanism.h).

#include <algorithm>

#include "constraints/joint_types.h"
#include "islands/direct_view.h"
#include "model/joint_bodies.h"

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
static bool keepsOwnTime(const DirectView& d, const DirectIsland& island) {
    if (island.tree || island.contactCount > 0 || island.jointCount == 0) return false;
    for (std::uint32_t i = 0; i < island.bodyCount; ++i) {
        const std::uint32_t body = d.directSet.bodies[island.firstBody + i];
        if (!turnsFreely(d.bodies, body) || d.bodies[body].direct.failures > 0) return false;
    }
    for (std::uint32_t i = 0; i < island.jointCount; ++i)
        if (!isTreeJoint(d.joints.sims[d.directSet.joints[island.firstJoint + i]])) return false;
    return true;
}

void planMechanisms(const DirectView& d) {
    d.directSet.mechanisms.resize(std::max(d.directSet.mechanisms.size(), d.directSet.islands.size()));
    for (std::size_t i = 0; i < d.directSet.islands.size(); ++i) {
        DirectIsland& island = d.directSet.islands[i];
        island.mechanism = keepsOwnTime(d, island);
        if (!island.mechanism) continue;
        if (!d.directSet.mechanisms[i]) d.directSet.mechanisms[i] = std::make_unique<Mechanism>(d.memory);
        island.watched = false;
        for (std::uint32_t j = 0; j < island.jointCount; ++j)
            island.watched |= d.joints.sims[d.directSet.joints[island.firstJoint + j]].breakable != 0;
    }
}

/// All of a body but its place, in double.
static void loadMechanismBody(const DirectView& d, std::uint32_t index, MechanismBody& body,
                              direct::MechanismPose& pose) {
    const BodyRecord& record = d.bodies[index];
    const BodyState& state = d.bodies.states[record.state];
    const BodyDynamics& dynamics = d.bodies.dynamics[record.state];
    pose.q = direct::toDouble(record.rotation);
    body = {};
    body.v = DVec3(state.v), body.w = DVec3(state.w);
    if (!d.bodies.moves(index)) return;
    body.inverseMass = static_cast<double>(state.invMass);
    body.moments = DVec3(dynamics.inertia), body.inverseMoments = DVec3(dynamics.inverseInertia);
    body.acceleration = DVec3(dynamics.acceleration), body.torque = DVec3(dynamics.torque);
    body.damping = static_cast<double>(record.motion.linearDamping);
    body.turnDamping = static_cast<double>(record.motion.angularDamping);
    body.momentum = direct::inWorld(pose.q, body.moments) * body.w;
}

void beginMechanism(const DirectView& d, const DirectIsland& island, Mechanism& mechanism) {
    const std::uint32_t* members = d.directSet.bodies.data() + island.firstBody;
    const std::uint32_t* held = d.directSet.joints.data() + island.firstJoint;
    std::size_t others = 0;
    for (std::uint32_t j = 0; j < island.jointCount; ++j)
        others += !d.bodies.moves(d.joints[held[j]].bodyA) || !d.bodies.moves(d.joints[held[j]].bodyB);
    mechanism.resize(island.bodyCount, others, island.jointCount);
    const DVec3 origin = d.bodies[members[0]].center;
    for (std::uint32_t i = 0; i < island.bodyCount; ++i) {
        d.directSet.index[members[i]] = i;
        loadMechanismBody(d, members[i], mechanism.body(i), mechanism.pose(i));
        mechanism.pose(i).x = d.bodies[members[i]].center - origin;
    }
    std::size_t next = island.bodyCount;
    for (std::uint32_t j = 0; j < island.jointCount; ++j) {
        const JointRecord& record = d.joints[held[j]];
        const JointSim& sim = d.joints.sims[held[j]];
        MechanismJoint& joint = mechanism.joint(j);
        joint.kind = mechanismJoint(sim.kind);
        const auto place = [&](std::uint32_t body, const Frame& local, DVec3& anchor, DQuat& frame) {
            const DQuat toBody = conjugate(direct::toDouble(d.bodies[body].local.rotation));
            anchor = rotate(toBody, DVec3(local.position));
            frame = toBody * direct::toDouble(local.rotation);
            if (d.bodies.moves(body)) return d.directSet.index[body];
            loadMechanismBody(d, body, mechanism.body(next), mechanism.pose(next));
            mechanism.pose(next).x = jointCenter(d.bodies, record, body) - origin;
            return static_cast<std::uint32_t>(next++);
        };
        joint.a = place(record.bodyA, sim.localA, joint.anchorA, joint.frameA);
        joint.b = place(record.bodyB, sim.localB, joint.anchorB, joint.frameB);
        joint.force = DVec3(sim.block.impulseFirst);
        joint.torque = DVec3(sim.block.impulseSecond);
    }
    int pace = 1;
    for (std::uint32_t i = 0; i < island.bodyCount; ++i)
        pace = std::max(pace, static_cast<int>(d.bodies[members[i]].direct.pace.inner));
    mechanism.setPace(pace);
    mechanism.begin();
}

void keepPace(const DirectView& d, const DirectIsland& island, const Mechanism& mechanism) {
    constexpr std::uint8_t kHysteresisSteps = 60;  // a second at 60 Hz
    int pace = mechanism.pace();
    const bool calm = pace > 1 && mechanism.largestNeed() <= 0.5 * pace;
    const BodyRecord& first = d.bodies[d.directSet.bodies[island.firstBody]];
    std::uint8_t steps = calm ? static_cast<std::uint8_t>(first.direct.pace.calm + 1) : std::uint8_t{0};
    if (steps >= kHysteresisSteps) pace /= 2, steps = 0;
    for (std::uint32_t i = 0; i < island.bodyCount; ++i) {
        BodyRecord& body = d.bodies[d.directSet.bodies[island.firstBody + i]];
        body.direct.pace.inner = static_cast<std::uint8_t>(pace);
        body.direct.pace.calm = steps;
    }
}

/// Takes over what modules did to velocities since the last substep.
static void readMechanism(const DirectView& d, const DirectIsland& island, Mechanism& mechanism) {
    for (std::uint32_t i = 0; i < island.bodyCount; ++i) {
        const BodyState& state = d.bodies.states[d.directSet.bodies[island.firstBody + i]];
        const MechanismBody& body = mechanism.body(i);
        const Vec3 v = toVec3(body.v), w = toVec3(body.w);
        if (state.v == v && state.w == w) continue;
        mechanism.changeVelocity(i, DVec3(state.v) - DVec3(v), DVec3(state.w) - DVec3(w));
    }
    std::size_t next = island.bodyCount;
    for (std::uint32_t j = 0; j < island.jointCount; ++j) {
        const JointRecord& joint = d.joints[d.directSet.joints[island.firstJoint + j]];
        if (d.bodies.moves(joint.bodyA) && d.bodies.moves(joint.bodyB)) continue;
        const std::uint32_t number = d.bodies[d.bodies.moves(joint.bodyA) ? joint.bodyB : joint.bodyA].state;
        const BodyState& state = d.bodies.states[number];
        const BodyDynamics& dynamics = d.bodies.dynamics[number];
        MechanismBody& body = mechanism.body(next++);
        // What takes it through the substep, where it speeds up (model/kinematic_slopes.h).
        const float h = d.context.h;
        body.v = DVec3(state.v + 0.5f * h * dynamics.acceleration), body.w = DVec3(state.w + h * dynamics.torque);
    }
}

void readMechanisms(const DirectView& d) {
    for (std::size_t i = 0; i < d.directSet.islands.size(); ++i)
        if (const DirectIsland& island = d.directSet.islands[i]; island.mechanism && !island.fellBack)
            readMechanism(d, island, *d.directSet.mechanisms[i]);
}

/// Where the bodies are at the end of a substep, and how they move.
static void writeMechanism(const DirectView& d, const DirectIsland& island, Mechanism& mechanism) {
    const DVec3 origin = d.bodies[d.directSet.bodies[island.firstBody]].center;
    for (std::uint32_t i = 0; i < island.bodyCount; ++i) {
        const std::uint32_t index = d.directSet.bodies[island.firstBody + i];
        const BodyRecord& record = d.bodies[index];
        const MechanismBody& body = mechanism.body(i);
        const direct::MechanismPose& pose = mechanism.pose(i);
        BodyState& state = d.bodies.states[index];
        state.v = toVec3(body.v), state.w = toVec3(body.w);
        state.dp = toVec3(pose.x - (record.center - origin));
        const Quat rotation = direct::toFloat(pose.q);
        state.dq = direct::toFloat(pose.q * conjugate(direct::toDouble(record.rotation)));
        d.bodies.inertias[index] = d.bodies.inverseInertiaAt(index, rotation);
        d.bodies.storeMomentum(index, rotation);
    }
}

/// Loads of the joints, and how often hinges have turned.
static void storeLoads(const DirectView& d, const DirectIsland& island, Mechanism& mechanism) {
    constexpr int kFast = 2;  // inner steps, beyond which a hinge may turn by radians in a step
    if (!d.context.lastSubstep && !island.watched && mechanism.pace() <= kFast) return;
    mechanism.findLoads();
    for (std::uint32_t j = 0; j < island.jointCount; ++j) {
        JointSim& sim = d.joints.sims[d.directSet.joints[island.firstJoint + j]];
        sim.block.impulseFirst = toVec3(mechanism.joint(j).force);
        sim.block.impulseSecond = toVec3(mechanism.joint(j).torque);
        refreshJoint(sim, BodyPair(d.bodies.states.data(), d.bodies.inertias.data(), sim.stateA, sim.stateB),
                     {d.jointContext, false});
        recordLoad(sim);
    }
}

void solveMechanism(const DirectView& d, DirectIsland& island, Mechanism& mechanism, DirectPass pass) {
    if (pass == DirectPass::velocities) {
        writeMechanism(d, island, mechanism);
        storeLoads(d, island, mechanism);
        return;
    }
    const auto h = static_cast<double>(d.context.h);
    if (!mechanism.advance(h, h * static_cast<double>(d.jointContext.softness.biasRate))) fallBack(d, island, pass);
    island.report.iterations = mechanism.iterations();
    island.report.factorizations = mechanism.factorizations();
}

}  // namespace ragtop
