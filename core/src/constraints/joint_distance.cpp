#include "constraints/joint_types.h"

namespace ragtop {

/// One scalar row along the line of the anchors, which all of it acts on; the block's basis holds its direction.
void refreshDistance(JointSim& joint, const JointPlace& place, const BodyPair& pair, bool begins) {
    joint.block.errorFirst = place.gap;
    const float distance = length(place.gap);
    // Coinciding anchors have no line: the last one serves, and at first A's x axis.
    Vec3& direction = joint.block.basis.cz;
    const Vec3 fallback = lengthSquared(direction) > 0 ? direction : rotate(place.a, {1, 0, 0});
    direction = normalized(place.gap, fallback);
    const float inverseMass = pair.mass(joint.arms, direction);
    joint.block.second.inverse[2] = inverseMass > 0 ? 1 / inverseMass : 0.0f;
    setMargins(joint.axis, distance, false);
    if (begins) joint.axis.springError = distance - joint.axis.target;
}

void solveDistance(JointSim& joint, BodyPair& pair, const JointContext& context, bool useBias) {
    const float mass = joint.block.second.inverse[2];
    if (!(mass > 0)) return;
    const Vec3 direction = joint.block.basis.cz;
    const float speed = dot(direction, pair.velocity(joint.arms).linear);
    const float amount = solveAxis(joint.axis, speed, 1 / mass, context, useBias);
    pair.apply(joint.arms, {amount * direction, {}});
}

}  // namespace ragtop
