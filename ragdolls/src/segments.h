#pragma once

#include "body_plan.h"
#include "bone_tree.h"
#include "ragtop/anatomy.h"

namespace ragtop {

/// Up, forward and left of a body from its limbs at rest; remarks on what had to be guessed go to the note.
void orient(const Skeleton& skeleton, const BoneTree& tree, const KnownRoles& known, const PlanChoice& choice,
            Anatomy& anatomy);

/// Segments of a body whose limbs are known.
void segmentBody(const Skeleton& skeleton, const BoneTree& tree, const KnownRoles& known, const PlanChoice& choice,
                 Anatomy& anatomy);

/// Bones that are long for their skeleton begin segments, at most 24.
void segmentOther(const BoneTree& tree, Anatomy& anatomy);

}  // namespace ragtop
