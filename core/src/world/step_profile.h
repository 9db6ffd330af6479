#pragma once

#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <span>

#include "ragtop/world.h"

namespace ragtop {

/// How long the last step took, and the stages of the last one that they were timed in; tells zones to whoever
/// profiles.
class StepProfile {
public:
    StepProfile();

    /// `timesStages`: a dozen looks at a counter take a tenth of a microsecond, a tenth of the step of a small world.
    void begin(bool timesStages);
    /// Ends the stage before, if any. How long each took is known when all have ended.
    void beginStage(const char* name, const WorldCallbacks& callbacks);
    void end(const WorldCallbacks& callbacks);
    void forget() { count_ = 0; }

    std::span<const StepStats::Stage> stages() const { return {stages_.data(), count_}; }
    double totalMs() const { return totalMs_; }

private:
    using Clock = std::chrono::steady_clock;
    static constexpr std::size_t kMostStages = 12;  ///< of a step, with those of modules

    void measureTicks(std::uint64_t now);

    std::array<StepStats::Stage, kMostStages> stages_{};
    std::array<std::uint64_t, kMostStages> begins_{};  ///< ticks, of each stage
    std::size_t count_ = 0;
    bool timesStages_ = false;
    const char* zone_ = nullptr;                 ///< that was told last
    std::uint64_t begin_ = 0;                    ///< ticks, of the step
    Clock::time_point made_;                     ///< when the profile was
    std::uint64_t madeAt_ = 0, measuredAt_ = 0;  ///< ticks, then and when their length was measured last
    double tickMs_ = 0;
    double totalMs_ = 0;
};

}  // namespace ragtop
