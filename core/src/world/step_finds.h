#pragma once

#include <cstdint>

#include "ragtop/math.h"
#include "world/records.h"

/// What stages of a step find, for a moment.
namespace ragtop {

/// Where a body touches a side of another one (world_seams.cpp).
struct TouchedPlane {
    bool touches = false;
    DVec3 at;
    Vec3 normal;      ///< towards the body that touches it
    float depth = 0;  ///< m, of the overlap
};

/// A tree of joints (world_trees.cpp).
struct DrawnTree {
    std::uint32_t anchor = kNone;  ///< body that does not move
    std::uint32_t bodies = 0, joints = 0;
    bool watched = false;  ///< impulses are wanted after every substep
    bool twofold = false;  ///< masses ask for double precision
};

}  // namespace ragtop
