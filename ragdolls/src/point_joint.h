#pragma once

#include <optional>
#include <span>

#include "ragtop/ragdoll.h"

namespace ragtop {

/// Where a joint that holds two points together has them in the bones of its parts.
struct PointJoint {
    int parent = -1;
    Vec3 inParent{}, inChild{};  ///< m
};

/// Of the joint that carries a part; none where the part hangs on nothing or on a joint that slides.
std::optional<PointJoint> pointJointOf(const RagdollDef& def, int part);

/// Where the joint has the part, turned as it is.
inline DVec3 jointed(const PointJoint& joint, const Pose& parent, const Quat& rotation) {
    return transformPoint(parent, joint.inParent) - rotate(rotation, joint.inChild);
}

/// Moves parts to where their joints have them; turns stay.
void closeJoints(const RagdollDef& def, std::span<Pose> parts);

}  // namespace ragtop
