#pragma once

#include "constraints/joint_sim.h"

namespace ragtop {

/// Writes a drive into the definition of a ball or a hinge; false where it was there already.
bool setDrive(JointDef& def, const JointDrive& drive);
/// The same into what was compiled from that definition, to what compileJoint makes of it. False, and nothing is
/// changed, where rows come or go, which takes a compileJoint.
bool setDrive(JointSim& joint, const JointDef& def);

}  // namespace ragtop
