#pragma once

#include <cstdint>

#include "model/bodies.h"
#include "model/joints.h"

/// Where the bodies of a joint are.
namespace ragtop {

const JointBodies& bodiesOf(const JointDef& def);
/// Of one of a joint's bodies. The world as a body has its centre at the joint's frame, so that nothing large is
/// rounded.
DVec3 jointCenter(const Bodies& bodies, const JointRecord& joint, std::uint32_t body);
JointBodiesAtStep jointBodies(const Bodies& bodies, const JointRecord& joint);
/// The same. Of two bodies that have states the record is not needed, which lies by itself.
JointBodiesAtStep jointBodies(const Bodies& bodies, const Joints& joints, std::uint32_t joint);

}  // namespace ragtop
