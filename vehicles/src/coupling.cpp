#include "coupling.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "engine.h"

namespace ragtop {
namespace {

constexpr float kTogether = 0.999f;  ///< speed ratio beyond which a converter damps as there

CouplingLaw converterLaw(const VehicleDef& def, const CouplingInput& in) {
    const float fast = std::max(in.engineSpeed, in.shaftSpeed), slow = std::min(in.engineSpeed, in.shaftSpeed);
    if (!(fast > 0)) return {};
    const float ratio = std::clamp(slow / fast, 0.0f, kTogether);
    const ConverterPoint point = converterAt(def.gearbox, ratio);
    // A turbine that is turned backwards stalls the pump as one that stands.
    const float slip = std::max(fast - slow, (1 - kTogether) * fast);
    constexpr float kInfinite = std::numeric_limits<float>::infinity();
    const float give = slip / ((1 - in.pedal) * point.capacity * fast * fast);
    if (!(give < kInfinite)) return {};
    const bool drives = in.engineSpeed >= in.shaftSpeed;
    // Between two points their line may be above what power allows. At no speed of a shaft there is a zero of each
    // sign.
    const float most = ratio > 0 ? 1 / ratio : kInfinite;
    return {kInfinite, give, drives ? std::min(point.torqueRatio, most) : 1};
}

float lockUpOf(const VehicleDef& def, const CouplingInput& in) {
    const std::optional<float>& from = def.gearbox.lockUpRatio;
    if (!from || in.shiftTimer > 0 || !(in.shaftSpeed >= *from * in.engineSpeed)) return 0;
    // As the shaft alone would have a clutch: open again before the engine stalls.
    return clutchCapacity(def, 0, in.shaftSpeed, in.throttle, in.pedal);
}

}  // namespace

ConverterPoint converterAt(const GearboxDef& def, float speedRatio) {
    const auto& map = def.converterMap;
    const auto next = std::ranges::find_if(map, [&](const ConverterPoint& p) { return p.speedRatio > speedRatio; });
    if (next == map.begin() || next == map.end()) return next == map.end() ? map.back() : map.front();
    const ConverterPoint &a = *(next - 1), &b = *next;
    const float share = (speedRatio - a.speedRatio) / (b.speedRatio - a.speedRatio);
    return {speedRatio, a.torqueRatio + share * (b.torqueRatio - a.torqueRatio),
            a.capacity + share * (b.capacity - a.capacity)};
}

CouplingLaw couplingLaw(const VehicleDef& def, const CouplingInput& in) {
    if (def.gearbox.coupling == CouplingType::converter) {
        const float bridged = lockUpOf(def, in);
        return bridged > 0 ? CouplingLaw{bridged} : converterLaw(def, in);
    }
    const bool shifting = in.shiftTimer > 0;
    if (shifting && def.gearbox.coupling == CouplingType::clutch) return {};
    const float most = clutchCapacity(def, in.engineSpeed, in.shaftSpeed, in.throttle, in.pedal);
    if (!shifting) return {most};
    const float taken = in.engineTorque + def.engine.inertia * (in.engineSpeed - in.shaftSpeed) / in.shiftTimer;
    return {std::min(most, std::abs(taken))};
}

}  // namespace ragtop
