#include "world/step_profile.h"

namespace ragtop {

namespace {

double millisecondsBetween(std::chrono::steady_clock::time_point from, std::chrono::steady_clock::time_point to) {
    return std::chrono::duration<double, std::milli>(to - from).count();
}

}  // namespace

void StepProfile::begin() {
    stages_.clear();
    start_ = Clock::now();
}

void StepProfile::endStage(Clock::time_point now, const WorldCallbacks& callbacks) {
    stages_.back().ms = millisecondsBetween(stageStart_, now);
    if (callbacks.endZone) callbacks.endZone(stages_.back().name);
}

void StepProfile::beginStage(const char* name, const WorldCallbacks& callbacks) {
    const auto now = Clock::now();
    if (!stages_.empty()) endStage(now, callbacks);
    stages_.push_back({name, 0});
    stageStart_ = now;
    if (callbacks.beginZone) callbacks.beginZone(name);
}

void StepProfile::end(const WorldCallbacks& callbacks) {
    const auto now = Clock::now();
    endStage(now, callbacks);
    totalMs_ = millisecondsBetween(start_, now);
}

}  // namespace ragtop
