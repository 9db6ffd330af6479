#pragma once

#include <cstddef>
#include <vector>

#include "ragtop/spring_bones.h"
#include "spring_group.h"

namespace ragtop {

/// The bones of a chain from its first to its last; none where the last does not hang on the first.
std::vector<int> bonesOf(const SpringChain& chain, const Skeleton& skeleton);
/// m, where the weight of bones[index] is in that bone.
Vec3 weightOf(const SpringChain& chain, const std::vector<int>& bones, std::size_t index, const Skeleton& skeleton);

/// A bone of the skeleton that some chain moves, or that hangs on one.
struct SpringBone {
    int bone = -1;
    int carrier = -1;  ///< the bone of the nearest chain above; −1: none
    int place = -1;    ///< group · SpringGroup::kLanes + lane; −1: hangs on its carrier without a spring
};

/// What is found once for a skeleton.
struct SpringPlan {
    std::vector<SpringBone> bones{};    ///< carriers before what they carry
    std::vector<SpringGroup> groups{};  ///< likewise
    float quickest = 0;                 ///< rad/s, largest rate of a bone in the world's gravity
    float size = 0;                     ///< m, of the skeleton
};

/// Of a valid definition.
SpringPlan planOf(const SpringBonesDef& def, const Skeleton& skeleton);

}  // namespace ragtop
