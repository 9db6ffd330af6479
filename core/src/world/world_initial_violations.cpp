#include "world/world_impl.h"

namespace ragtop {

/// Of a joint that was just made and placed.
void WorldImpl::recordInitialViolation(std::uint32_t joint) {
    if (!isViolatedInitially(jointSims[joint])) return;
    holdInitialViolation(jointSims[joint]);
    violatedJoints.push(joint);
}

/// Moves a body, which keeps its speed as seen from itself, and so its energy.
void WorldImpl::shiftBody(std::uint32_t index, const Shift& shift) {
    if (!moves(index)) return;
    BodyRecord& body = bodies[index];
    const Quat before = body.rotation;
    const Pose after = SweptPath{{body.center, before}, shift.way, shift.turn}.at(1);
    body.center = after.position;
    body.rotation = after.rotation;
    body.sleepTimer = 0;
    turnVelocity(index, before, after.rotation);
    refreshInertia(index);
}

/// Joints that were made beyond their limits come back a little in each step. What their velocities no longer fit then
/// they lose, as when the joint was made. Serial and in order of the list.
void WorldImpl::correctInitialViolations() {
    std::size_t kept = 0;
    for (const std::uint32_t j : violatedJoints) {
        if (j == kNone) continue;
        const JointRecord& joint = joints[j];
        const bool awake = (moves(joint.bodyA) && isAwake(joint.bodyA)) || (moves(joint.bodyB) && isAwake(joint.bodyB));
        if (awake) {
            // What the first shift leaves open, as it is of first order, the second closes: rows would feed energy.
            for (const float most : {kTurnRecovery, 0.0f}) {
                const PairShift shift =
                    shiftBack(jointSims[j], jointBodies(joint), states.data(), inertias.data(), most);
                shiftBody(joint.bodyA, shift.a);
                shiftBody(joint.bodyB, shift.b);
            }
            placeJoint(jointSims[j], jointBodies(joint), states.data(), inertias.data());
            fitVelocities(jointSims[j], states.data(), inertias.data());
            for (const std::uint32_t body : {joint.bodyA, joint.bodyB})
                if (moves(body)) storeMomentum(body);
            holdInitialViolation(jointSims[j]);
            if (!isViolatedInitially(jointSims[j])) {
                compile(j);
                continue;
            }
        }
        violatedJoints[kept++] = j;
    }
    violatedJoints.resizeForOverwrite(kept);
}

}  // namespace ragtop
