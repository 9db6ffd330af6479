#pragma once

#include <optional>
#include <string>
#include <vector>

#include "limbs.h"

namespace ragtop {

/// What a skeleton was taken for, and the limbs that show it.
struct PlanChoice {
    BodyPlan plan = BodyPlan::other;
    float confidence = 0;
    LimbPair legs, arms;  ///< hind legs and forelegs, legs and wings; of six-legged ones the last and the first pair
    std::vector<LimbPair> more;  ///< other pairs that are long
    int head = -1;               ///< the first bone that is not trunk on the way to the head
    std::string missing;         ///< why it is none, or what it goes without
};

/// Weighs all signs for all plans and all limbs that could be its own.
PlanChoice choosePlan(const BoneTree& tree, const LimbSearch& search, const KnownRoles& known);

/// Where the head begins: among what hangs on the trunk between `legs` and `arms` and beyond, apart from them.
int findHead(const BoneTree& tree, const KnownRoles& known, const LimbPair& legs, const LimbPair& arms);

}  // namespace ragtop
