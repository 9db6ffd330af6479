#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace ragtop::demos {

/// What a run came to; summary.json has exactly these.
struct Summary {
    std::uint64_t hash = 0;
    std::uint64_t steps = 0;
    bool finite = true;
    double realTimeFactor = 0;     ///< simulated time over time inside World::step
    double realTimeFactorMin = 0;  ///< the same in the worst second
    std::vector<std::pair<std::string, double>> msPerStep;  ///< mean: total, then each stage
    int contacts = 0;
    double penetrationMax = 0;  ///< m, at the end
    double penetrationP99 = 0;  ///< m, at the end, over the overlapping pairs
    double jointGapMax = 0;     ///< m, at any step
    double movedMax = 0;        ///< m, masonry at the end
    double maxSpeed = 0;        ///< m/s, any body at any step
    double energy = 0;          ///< J, at the end
    std::vector<std::string> warnings;
};

std::string toJson(const Summary& summary);

/// Collects the time that each step took.
class StepTimes {
public:
    explicit StepTimes(double step) : step_(step) {}
    void add(double ms) { ms_.push_back(ms); }
    double realTimeFactor() const;
    /// The smallest over any second of the simulation, or over all of a shorter run.
    double worstSecond() const;
    double meanMs() const;

private:
    double step_;
    std::vector<double> ms_;
};

}  // namespace ragtop::demos
