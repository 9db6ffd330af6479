#pragma once

#include <chrono>
#include <cstdint>
#include <memory_resource>
#include <span>
#include <vector>

#include "ragtop/world.h"

namespace ragtop {

/// How long the stages of the last step took; tells zones to whoever profiles.
class StepProfile {
public:
    explicit StepProfile(std::pmr::memory_resource* memory) : stages_(memory), begins_(memory) {}

    void begin();
    /// Ends the stage before, if any. How long each took is known when all have ended.
    void beginStage(const char* name, const WorldCallbacks& callbacks);
    void end(const WorldCallbacks& callbacks);
    void forget() { stages_.clear(), begins_.clear(); }

    std::span<const StepStats::Stage> stages() const { return stages_; }
    double totalMs() const { return totalMs_; }

private:
    using Clock = std::chrono::steady_clock;
    void endStage(const WorldCallbacks& callbacks);

    std::pmr::vector<StepStats::Stage> stages_;
    std::pmr::vector<std::uint64_t> begins_;  ///< ticks, of each stage
    Clock::time_point start_;
    double totalMs_ = 0;
};

}  // namespace ragtop
