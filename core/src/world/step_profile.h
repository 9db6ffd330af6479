#pragma once

#include <chrono>
#include <memory_resource>
#include <span>
#include <vector>

#include "ragtop/world.h"

namespace ragtop {

/// How long the stages of the last step took; tells zones to whoever profiles.
class StepProfile {
public:
    explicit StepProfile(std::pmr::memory_resource* memory) : stages_(memory) {}

    void begin();
    /// Ends the stage before, if any.
    void beginStage(const char* name, const WorldCallbacks& callbacks);
    void end(const WorldCallbacks& callbacks);
    void forget() { stages_.clear(); }

    std::span<const StepStats::Stage> stages() const { return stages_; }
    double totalMs() const { return totalMs_; }

private:
    using Clock = std::chrono::steady_clock;
    void endStage(Clock::time_point now, const WorldCallbacks& callbacks);

    std::pmr::vector<StepStats::Stage> stages_;
    Clock::time_point stageStart_, start_;
    double totalMs_ = 0;
};

}  // namespace ragtop
