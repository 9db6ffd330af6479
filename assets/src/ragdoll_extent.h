#pragma once

#include "ragtop/ragdoll.h"
#include "ragtop/robot.h"

namespace ragtop {

/// The middle of the bones of all parts at rest, m in model space.
Vec3 middleOf(const RagdollDef& def);
/// The height of the lowest point of all shapes at rest, m, with model space turned by `rotation`.
float lowestPointOf(const RagdollDef& def, const Quat& rotation);
/// The same of what moves of a robot at home, with its root turned.
float lowestPointOf(const Robot& robot, const Quat& rotation);

}  // namespace ragtop
