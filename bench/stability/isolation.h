#pragma once

#include <functional>
#include <limits>
#include <string>
#include <vector>

namespace ragtop::stability {

/// What became of a piece of work in a process of its own.
struct Outcome {
    std::string text;    ///< what the work returned
    std::string death;   ///< empty, or what ended it otherwise
    double seconds = 0;  ///< of processor time
};

/// Runs works in child processes, so many at once, so that one that crashes or aborts takes nothing with it. `done`
/// is given their outcomes in order. Works do not throw. One that takes more than `limit` seconds of processor time, or
/// four times that and `patience` by the clock, is ended; what it wrote is dropped.
void runIsolated(const std::vector<std::function<std::string()>>& works, int processes,
                 const std::function<void(std::size_t work, const Outcome&)>& done,
                 double limit = std::numeric_limits<double>::infinity(), double patience = 10);

}  // namespace ragtop::stability
