#pragma once

#include <cstdint>

#include "direct/linear.h"

namespace ragtop::direct {

/// A contact point, beside which joints are closed.
struct ClosingPoint {
    std::uint32_t stateA = 0, stateB = 0;
    DVec3 normal;      ///< from A to B
    DVec3 armA, armB;  ///< m, from the centres of mass
    double room = 0;   ///< m, by which the surfaces may come nearer; below 0 they are to part
    bool isFar = false;  ///< further apart than a round of closing moves bodies
};

}  // namespace ragtop::direct
