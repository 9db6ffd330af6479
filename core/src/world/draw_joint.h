#pragma once

#include "ragtop/debug_draw.h"
#include "ragtop/joint.h"
#include "ragtop/math.h"

namespace ragtop {

/// Anchors, axes and limits of a joint: the cone of a swing, the arc of a twist or hinge, the ends of a slide; red
/// where a limit is reached. `a` and `b` are the joint's frame in either body, `size` the length of what is drawn, m.
void drawJoint(DebugDraw& draw, const JointDef& def, const JointState& state, const Pose& a, const Pose& b, float size);

}  // namespace ragtop
