#include "constraints/joint_types.h"

namespace ragtop {

/// One scalar row along the line of the anchors, which all of it acts on; the block's basis holds its direction.
void refreshDistance(JointSim& joint, const JointPlace& place, const BodyPair& pair, const Refresh& refresh) {
    joint.block.errorFirst = place.gap;
    const float distance = length(place.gap);
    // Coinciding anchors have no line: the last one serves, and at first A's x axis.
    Vec3& direction = joint.block.basis.cz;
    const Vec3 fallback = lengthSquared(direction) > 0 ? direction : axisX(place.a);
    direction = normalized(place.gap, fallback);
    const float inverseMass = pair.mass(joint.arms, direction);
    joint.axis.inverseMass = inverseMass;
    setMargins(joint.axis, static_cast<double>(distance));
    if (!refresh.begins) return;
    beginAxis(joint.axis, static_cast<double>(distance), dot(direction, pair.velocity(joint.arms).linear), 0,
              refresh.context);
}

void solveDistance(JointSim& joint, BodyPair& pair, const JointContext& context, bool useBias) {
    const Vec3 direction = joint.block.basis.cz;
    const float speed = dot(direction, pair.velocity(joint.arms).linear);
    const float bend = useBias && joint.axis.keepsRange() ? bendOf(joint, 0, pair, context.h) : 0.0f;
    pair.apply(joint.arms, {solveAxis(joint.axis, speed, context, useBias, bend) * direction, {}});
}

}  // namespace ragtop
