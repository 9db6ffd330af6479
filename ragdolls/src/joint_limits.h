#pragma once

#include "ragtop/anatomy.h"
#include "ragtop/joint.h"
#include "ragtop/skeleton.h"

namespace ragtop {

/// The joint by which segment `child` hangs on its carrier, frames in their bones, limits anatomical. A ball's cone
/// lies about the middle of the human range, tilted where the pose at rest would be outside; a hinge's zero is the
/// pose at rest.
JointDef anatomicalJoint(const Skeleton& skeleton, const Anatomy& anatomy, int child, float limitScale);

}  // namespace ragtop
