#pragma once

#include "ragtop/body_pose.h"

namespace ragtop {

/// An upper arm that points along a unit vector in the axes of the chest, as far as shoulders go.
PartAngles pointing(BodySide side, const Vec3& along);

}  // namespace ragtop
