#include "world/step_profile.h"

#include <cassert>

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

/// Ticks after which their length is measured anew: a clock is asked in one of a thousand steps of a small world, and
/// after each of a large one.
constexpr std::uint64_t kMeasured = std::uint64_t{1} << 21;

}  // namespace

StepProfile::StepProfile() : made_(Clock::now()), madeAt_(ticks()) {}

void StepProfile::begin(bool timesStages) {
    timesStages_ = timesStages || count_ == 0;
    if (timesStages_) count_ = 0;
    zone_ = nullptr;
    begin_ = ticks();
}

void StepProfile::beginStage(const char* name, const WorldCallbacks& callbacks) {
    if (callbacks.endZone && zone_) callbacks.endZone(zone_);
    if (timesStages_) {
        assert(count_ < kMostStages);
        stages_[count_].name = name;
        begins_[count_++] = ticks();
    }
    zone_ = name;
    if (callbacks.beginZone) callbacks.beginZone(name);
}

/// Over all the time since the profile was made, so that reading the clock counts for ever less.
void StepProfile::measureTicks(std::uint64_t now) {
    measuredAt_ = now;
    const double ms = std::chrono::duration<double, std::milli>(Clock::now() - made_).count();
    tickMs_ = now > madeAt_ ? ms / static_cast<double>(now - madeAt_) : 0;
}

void StepProfile::end(const WorldCallbacks& callbacks) {
    const std::uint64_t now = ticks();
    if (callbacks.endZone && zone_) callbacks.endZone(zone_);
    if (tickMs_ == 0 || now - measuredAt_ > kMeasured) measureTicks(now);
    // A processor's counter may be some ticks behind another's.
    const auto between = [&](std::uint64_t from, std::uint64_t to) {
        return to > from ? tickMs_ * static_cast<double>(to - from) : 0;
    };
    totalMs_ = between(begin_, now);
    if (!timesStages_) return;
    for (std::size_t i = 0; i < count_; ++i) stages_[i].ms = between(begins_[i], i + 1 < count_ ? begins_[i + 1] : now);
}

}  // namespace ragtop
