#include "world/step_profile.h"

#if defined(__x86_64__)
#include <x86intrin.h>
#endif

namespace ragtop {

namespace {

/// Of a counter that runs evenly. Asking a clock for the time takes up to 0.1 µs, which a dozen stages of a small world
/// would pay for.
std::uint64_t ticks() {
#if defined(__x86_64__)
    return __rdtsc();
#else
    return static_cast<std::uint64_t>(std::chrono::steady_clock::now().time_since_epoch().count());
#endif
}

}  // namespace

void StepProfile::begin() {
    forget();
    start_ = Clock::now();
}

void StepProfile::endStage(const WorldCallbacks& callbacks) {
    if (callbacks.endZone) callbacks.endZone(stages_.back().name);
}

void StepProfile::beginStage(const char* name, const WorldCallbacks& callbacks) {
    if (!stages_.empty()) endStage(callbacks);
    stages_.push_back({name, 0});
    begins_.push_back(ticks());
    if (callbacks.beginZone) callbacks.beginZone(name);
}

/// The clock's time between the first stage and now is shared out by ticks.
void StepProfile::end(const WorldCallbacks& callbacks) {
    const std::uint64_t now = ticks();
    totalMs_ = std::chrono::duration<double, std::milli>(Clock::now() - start_).count();
    endStage(callbacks);
    const auto all = static_cast<double>(now - begins_.front());
    for (std::size_t i = 0; i < stages_.size(); ++i) {
        const std::uint64_t next = i + 1 < stages_.size() ? begins_[i + 1] : now;
        // A processor's counter may be some ticks behind another's.
        const double own = next > begins_[i] ? static_cast<double>(next - begins_[i]) : 0;
        stages_[i].ms = all > 0 ? totalMs_ * own / all : 0;
    }
}

}  // namespace ragtop
