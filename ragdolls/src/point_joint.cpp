#include "point_joint.h"

namespace ragtop {

std::optional<PointJoint> pointJointOf(const RagdollDef& def, int part) {
    for (const RagdollJoint& joint : def.joints) {
        if (joint.child != part) continue;
        const bool holds =
            std::holds_alternative<BallDef>(joint.joint) || std::holds_alternative<HingeDef>(joint.joint) ||
            std::holds_alternative<FixedDef>(joint.joint) || std::holds_alternative<UniversalDef>(joint.joint);
        if (!holds) return {};
        const JointBodies bodies = std::visit([](const auto& each) { return each.bodies; }, joint.joint);
        return PointJoint{joint.parent, bodies.frameA.position, bodies.frameB.position};
    }
    return {};
}

void closeJoints(const RagdollDef& def, std::span<Pose> parts) {
    for (std::size_t i = 0; i < parts.size(); ++i)
        if (const auto joint = pointJointOf(def, static_cast<int>(i)))
            parts[i].position = jointed(*joint, parts[static_cast<std::size_t>(joint->parent)], parts[i].rotation);
}

}  // namespace ragtop
