#include "gearbox.h"

#include <algorithm>
#include <cmath>

#include "engine.h"
#include "point_body.h"

namespace ragtop {
namespace {

constexpr float kAboveIdle = 1.05f;  ///< over idle, where the clutch begins to take hold
constexpr float kLocked = 1.5f;      ///< over idle, where it holds fully at closed throttle
constexpr float kLaunch = 0.4f;      ///< share of the range from idle to limiter added to that at full throttle

int automaticGear(const GearboxDef& def, int gear, float axleSpeed, float throttle) {
    const int highest = static_cast<int>(def.ratios.size());
    if (gear < 1) return 1;
    const float up = def.shiftDownRpm + (def.shiftUpRpm - def.shiftDownRpm) * (0.5f + 0.5f * throttle);
    const auto rpmIn = [&](int g) { return revolutionsPerMinute(axleSpeed * gearing(def, g)); };
    // Up only into a gear that would not shift down again; down only into one that would not shift up again.
    if (gear < highest && rpmIn(gear) > up && rpmIn(gear + 1) > 1.1f * def.shiftDownRpm) return gear + 1;
    if (gear > 1 && rpmIn(gear) < def.shiftDownRpm && rpmIn(gear - 1) < 0.9f * up) return gear - 1;
    return gear;
}

/// Towards the ratio that has the engine at the speed for its throttle; the way from end to end takes shiftTime.
float continuousRatio(const GearboxDef& def, float ratio, float axleSpeed, float throttle, float dt) {
    const float least = def.ratios.back(), most = def.ratios.front();
    const float rpm = def.shiftDownRpm + (def.shiftUpRpm - def.shiftDownRpm) * throttle;
    const float turning = std::max(axleSpeed, 0.0f) * def.finalDrive;
    const float wanted =
        turning * most > radiansPerSecond(rpm) ? std::max(radiansPerSecond(rpm) / turning, least) : most;
    if (ratio == 0 || def.shiftTime <= dt) return wanted;
    const float change = (most - least) * dt / def.shiftTime;
    return clampTo(wanted, std::max(ratio - change, least), std::min(ratio + change, most));
}

}  // namespace

int highestGear(const GearboxDef& def) { return def.continuous ? 1 : static_cast<int>(def.ratios.size()); }

float gearing(const GearboxDef& def, const GearboxState& state) {
    if (!def.continuous || state.gear < 1) return gearing(def, state.gear);
    return (state.ratio > 0 ? state.ratio : def.ratios.front()) * def.finalDrive;
}

float gearing(const GearboxDef& def, int gear) {
    if (gear == 0) return 0;
    if (gear < 0) return -def.reverseRatio * def.finalDrive;
    return def.ratios[static_cast<std::size_t>(gear - 1)] * def.finalDrive;
}

void shift(const GearboxDef& def, GearboxState& state, std::optional<int> wanted, float axleSpeed, float throttle,
           float dt) {
    // In whole steps, as many as are nearest: of a time that is one of them nothing but rounding may be left.
    const auto inSteps = [dt](float time) { return time < 0.5f * dt ? 0 : time; };
    state.shiftTimer = inSteps(state.shiftTimer - dt);
    int gear = state.gear;
    if (wanted) {
        gear = std::clamp(*wanted, -1, highestGear(def));
    } else if (def.continuous) {
        gear = def.automatic ? 1 : gear;
    } else if (def.automatic && state.shiftTimer == 0) {
        gear = automaticGear(def, gear, axleSpeed, throttle);
    }
    state.ratio = def.continuous ? continuousRatio(def, state.ratio, axleSpeed, throttle, dt) : 0;
    if (gear == state.gear) return;
    state.gear = gear;
    state.shiftTimer = inSteps(def.shiftTime);
}

float launchSpeed(const EngineDef& def, float throttle) {
    if (def.electric) return 0;
    const float idle = radiansPerSecond(def.idleRpm), limiter = radiansPerSecond(def.limiterRpm);
    return kLocked * idle + kLaunch * throttle * (limiter - idle);
}

float clutchCapacity(const VehicleDef& def, float engineSpeed, float shaftSpeed, float throttle, float pedal) {
    const float most = (1 - pedal) * def.gearbox.clutchTorque.value_or(2 * peakTorque(def.engine));
    if (def.engine.electric) return most;
    const float from = kAboveIdle * idleSpeed(def.engine);
    const auto ramp = [&](float speed, float end) { return clampTo((speed - from) / (end - from), 0, 1); };
    const float share =
        std::max(ramp(engineSpeed, launchSpeed(def.engine, throttle)), ramp(shaftSpeed, launchSpeed(def.engine, 0)));
    return share * most;
}

}  // namespace ragtop
