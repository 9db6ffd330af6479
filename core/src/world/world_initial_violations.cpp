#include "world/world_impl.h"

namespace ragtop {

/// Of a joint that was just made and placed.
void WorldImpl::recordInitialViolation(std::uint32_t joint) {
    if (!isViolatedInitially(joints.sims[joint])) return;
    holdInitialViolation(joints.sims[joint]);
    joints.violated.push(joint);
}

/// Moves a body, which keeps its speed as seen from itself, and so its energy.
void WorldImpl::shiftBody(std::uint32_t index, const Shift& shift) {
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

/// Joints that were made beyond their limits come back a little in each step. What their velocities no longer fit then
/// they lose, as when the joint was made. Serial and in order of the list.
void WorldImpl::correctInitialViolations() {
    std::size_t kept = 0;
    for (const std::uint32_t j : joints.violated) {
        if (j == kNone) continue;
        const JointRecord& joint = joints[j];
        const bool awake = (bodies.moves(joint.bodyA) && bodies.isAwake(joint.bodyA)) ||
                           (bodies.moves(joint.bodyB) && bodies.isAwake(joint.bodyB));
        if (awake) {
            // Where a step that led beyond all numbers was undone, joints are still placed where it led.
            placeJoint(joints.sims[j], jointBodies(joint), bodies.states.data(), bodies.inertias.data());
            // What the first shift leaves open, as it is of first order, the second closes: rows would feed energy.
            for (const float most : {kTurnRecovery, 0.0f}) {
                const PairShift shift =
                    shiftBack(joints.sims[j], jointBodies(joint), bodies.states.data(), bodies.inertias.data(), most);
                shiftBody(joint.bodyA, shift.a);
                shiftBody(joint.bodyB, shift.b);
            }
            placeJoint(joints.sims[j], jointBodies(joint), bodies.states.data(), bodies.inertias.data());
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
