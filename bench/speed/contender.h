#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "courses.h"
#include "quality.h"

namespace ragtop::speed {

enum class Clock {
    wall,       ///< what passes
    processor,  ///< what this program uses of all processors; right for one thread where others work beside it
};

/// ms, from some time on.
double now(Clock clock);

/// How Ragtop did its work in a window.
struct Work {
    std::vector<std::pair<std::string, double>> stages;  ///< mean ms per step
    std::map<std::string, double>
        solverMix;                   ///< mean share of awake bodies that were swept, or solved directly and why
    std::optional<double> residual;  ///< mean over steps of the worst direct island's; empty where all is swept
    std::size_t peakBytes = 0;       ///< held by the world, at most, since it was made
    long allocations = 0;            ///< asked of the heap in the window's last 60 steps
};

struct WindowResult {
    std::string name;
    double ms = 0;       ///< mean over the window's steps
    double worstMs = 0;  ///< of the slowest of them
    std::optional<Quality> quality;
    std::optional<Work> work;  ///< Ragtop's
};

enum class Purpose {
    times,
    quality,  ///< measured while it plays, which takes caches from the steps: times mean nothing
};

/// Play all windows of a course; results of those that have a name.
std::vector<WindowResult> playRagtop(const Course& course, int threads, int lanes, Clock clock, Purpose purpose);
/// Throws where the program was built without it.
std::vector<WindowResult> playBullet(const Course& course, Clock clock, Purpose purpose);
bool hasBullet();

}  // namespace ragtop::speed
