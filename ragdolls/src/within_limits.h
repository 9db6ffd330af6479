#pragma once

#include "ragtop/joint.h"

namespace ragtop {

/// The turn itself where the limits of a ball or hinge leave it, else the nearest on the way to the joint's zero that
/// is within them by `margin`, rad.
Quat withinLimits(const JointDef& def, const Quat& turn, float margin);

}  // namespace ragtop
