#pragma once

#include <array>
#include <limits>
#include <string>

#include "ragtop/settings.h"

/// A place where much goes on at once and most of it soon ends: a wall house that a ball runs into, people who fall on
/// stairs, parked cars, and lamps that swing on chains over them.
namespace ragtop::economy_bench {

/// What must stay good whatever is left out. `bound` is what the stability suite asks of such scenes; infinite where it
/// asks nothing.
struct Figure {
    const char* name;
    const char* unit;
    double bound;
};
inline constexpr std::array kFigures{
    Figure{"overlap p99", "mm", 10},  ///< of pairs that overlap, in the worst of all seconds
    Figure{"deepest", "mm", std::numeric_limits<double>::infinity()},  ///< likewise; under the ball it is any
    Figure{"deepest at rest", "mm", 20},                               ///< at the end
    Figure{"open joints", "mm", 10},                                   ///< the widest of all seconds
    Figure{"house moves", "mm", 10},                                   ///< its bricks before it is hit, at most
    Figure{"cars creep", "mm", 10},                                    ///< from when they have sunk into their springs
    Figure{"lamps err", "%", 4},  ///< of the energy of their swing, lost or gained in 5 s
};

struct Played {
    double ms = 0;                                  ///< of a processor, per simulated second
    std::array<double, kFigures.size()> figures{};  ///< where they were asked for
};

/// With `measured` the figures, which disturb the caches: times mean nothing then.
Played playMixedScene(const WorldSettings& settings, bool measured);

}  // namespace ragtop::economy_bench
