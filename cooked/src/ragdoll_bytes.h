#pragma once

#include "field_bytes.h"
#include "ragtop/clip.h"
#include "ragtop/ragdoll.h"
#include "ragtop/robot_def.h"
#include "ragtop/skeleton.h"

namespace ragtop {

void put(FieldWriter& to, const Skeleton& skeleton);
void put(FieldWriter& to, const Clip& clip);
/// Throws std::invalid_argument where a part has a shape that ragdolls do not have.
void put(FieldWriter& to, const RagdollDef& ragdoll);
/// Throws std::invalid_argument where a body has a shape that is not convex.
void put(FieldWriter& to, const Robot& robot);

// The same back. Throw std::invalid_argument on bytes that are none of it.
Skeleton getSkeleton(FieldReader& from);
Clip getClip(FieldReader& from);
RagdollDef getRagdoll(FieldReader& from);
Robot getRobot(FieldReader& from);

}  // namespace ragtop
