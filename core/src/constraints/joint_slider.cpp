#include "constraints/joint_types.h"

namespace ragtop {

/// Five rigid rows: C₁ = the rotation from A to B, C₂ = the gap across A's x axis. The gap is free along that axis.
void refreshSlider(JointSim& joint, const JointPlace& place, const BodyPair& pair, const Refresh& refresh) {
    RigidBlock& block = joint.block;
    const Vec3 x = rotate(place.a, {1, 0, 0});
    block.basis = {rotate(place.a, {0, 1, 0}), rotate(place.a, {0, 0, 1}), x};
    block.errorFirst = rotationError(place.a, place.b);
    block.errorSecond = transposeTimes(block.basis, place.gap);
    block.impulseSecond -= dot(block.impulseSecond, x) * x;
    refreshMass(block, pair.mass(joint.arms), BlockMass::whole);
    const float mass = block.second.inverse[2], travel = block.errorSecond.z;
    joint.axis.inverseMass = mass > 0 ? 1 / mass : 0.0f;
    setMargins(joint.axis, static_cast<double>(travel));
    if (!refresh.begins) return;
    const bool hadImpact =
        beginAxis(joint.axis, static_cast<double>(travel), dot(x, pair.velocity(joint.arms).linear),
                  length(block.impulseSecond), refresh.context, bendOf(joint, 0, pair, refresh.context.h));
    beginBlock(block, hadImpact);
}

}  // namespace ragtop
