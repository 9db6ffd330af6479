#pragma once

#include "constraints/joint_swing.h"

namespace ragtop {

/// How far d is from the edge of an elliptic cone with these half angles, rad: swing vectors (y cos φ, z sin φ).
SwingMargin ellipseMargin(float y, float z, const Vec3& d);

}  // namespace ragtop
