#pragma once

#include <vector>

#include "retarget_body.h"

namespace ragtop {

/// What a bone between two parts, of fingers or toes turns as: something between two bones of the other body.
struct ChainBone {
    int bone = -1;
    int before = -1, after = -1;  ///< of the other body
    float share = 0;              ///< from `before` to `after`
};

/// Those of `to` that `from` has a chain for, parents before children.
std::vector<ChainBone> matchChains(const RetargetBody& from, const RetargetBody& to);

}  // namespace ragtop
