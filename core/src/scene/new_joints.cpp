// Joints that were just made: velocities that they do not allow, and places beyond their limits.

#include "continuous/swept_motion.h"
#include "model/joint_bodies.h"
#include "scene/scene.h"

namespace ragtop {

void shiftBody(Bodies& bodies, std::uint32_t index, const Shift& shift) {
    if (!bodies.moves(index)) return;
    BodyRecord& body = bodies[index];
    const Quat before = body.rotation;
    const Pose after = SweptPath{{body.center, before}, shift.way, shift.turn}.at(1);
    body.center = after.position;
    body.rotation = after.rotation;
    body.sleepTimer = 0;
    bodies.turnVelocity(index, before, after.rotation);
    bodies.refreshInertia(index);
}

void Scene::settleNewJoints() const {
    for (const std::uint32_t j : joints.created)
        if (j != kNone)
            placeJoint(joints.sims[j], jointBodies(bodies, joints[j]), bodies.states.data(), bodies.inertias.data());
    constexpr int kJointIterations = 32;  // a bound; ends when all fit
    bool fits = false;
    for (int i = 0; i < kJointIterations && !fits; ++i) {
        fits = true;
        for (const std::uint32_t j : joints.created)
            if (j != kNone && fitVelocities(joints.sims[j], bodies.states.data(), bodies.inertias.data())) fits = false;
    }
    for (const std::uint32_t j : joints.created) {
        if (j == kNone) continue;
        if (isViolatedInitially(joints.sims[j])) {
            holdInitialViolation(joints.sims[j]);
            joints.violated.push(j);
        }
        for (const std::uint32_t body : {joints[j].bodyA, joints[j].bodyB})
            if (bodies.moves(body)) bodies.storeMomentum(body);
    }
    joints.created.clear();
}

void Scene::correctInitialViolations() const {
    std::size_t kept = 0;
    for (const std::uint32_t j : joints.violated) {
        if (j == kNone) continue;
        const JointRecord& joint = joints[j];
        const bool awake = (bodies.moves(joint.bodyA) && bodies.isAwake(joint.bodyA)) ||
                           (bodies.moves(joint.bodyB) && bodies.isAwake(joint.bodyB));
        if (awake) {
            // Where a step that led beyond all numbers was undone, joints are still placed where it led.
            placeJoint(joints.sims[j], jointBodies(bodies, joint), bodies.states.data(), bodies.inertias.data());
            // What the first shift leaves open, as it is of first order, the second closes: rows would feed energy.
            for (const float most : {kTurnRecovery, 0.0f}) {
                const PairShift shift = shiftBack(joints.sims[j], jointBodies(bodies, joint), bodies.states.data(),
                                                  bodies.inertias.data(), most);
                shiftBody(bodies, joint.bodyA, shift.a);
                shiftBody(bodies, joint.bodyB, shift.b);
            }
            placeJoint(joints.sims[j], jointBodies(bodies, joint), bodies.states.data(), bodies.inertias.data());
            fitVelocities(joints.sims[j], bodies.states.data(), bodies.inertias.data());
            for (const std::uint32_t body : {joint.bodyA, joint.bodyB})
                if (bodies.moves(body)) bodies.storeMomentum(body);
            holdInitialViolation(joints.sims[j]);
            if (!isViolatedInitially(joints.sims[j])) {
                compile(j);
                continue;
            }
        }
        joints.violated[kept++] = j;
    }
    joints.violated.resizeForOverwrite(kept);
}

}  // namespace ragtop
