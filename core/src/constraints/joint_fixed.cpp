#include "constraints/joint_types.h"

namespace ragtop {

/// Six rigid rows: C₁ = gap, C₂ = the rotation from A to B.
void refreshFixed(JointSim& joint, const JointPlace& place, const BodyPair& pair) {
    RigidBlock& block = joint.block;
    block.basis = {};
    block.errorFirst = place.gap;
    block.errorSecond = rotationError(place.a, place.b);
    refreshMass(block, pair.mass(joint.arms), BlockMass::whole);
}

}  // namespace ragtop
