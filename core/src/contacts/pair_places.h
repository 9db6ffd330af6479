#pragma once

#include <cstdint>

#include "contacts/tables.h"
#include "narrowphase/four_capsules.h"
#include "ragtop/math.h"

namespace ragtop {

/// Where a pair is that is asked for its contacts.
struct PairPlace {
    Frame bInA;            ///< of shape B in the axes of shape A
    float margin = 0;      ///< m, up to which points are found: all that the step may bring into touch
    float moved = 0;       ///< m, against each other, since manifolds were found
    float perTravel = 1;   ///< of such motion, at most, for what both bodies travel
    CapsuleTouch touch{};  ///< single where both are capsules that touch in a point, if anywhere
};

/// Of `count` contacts, at most four, in a step of dt seconds.
void placePairs(const ConstTables& tables, float dt, const std::uint32_t* asked, int count, PairPlace* out);

}  // namespace ragtop
