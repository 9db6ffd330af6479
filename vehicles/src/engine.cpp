#include "engine.h"

#include <algorithm>
#include <cmath>

#include "point_body.h"

namespace ragtop {

float fullTorque(const EngineDef& def, float speed) {
    if (def.electric) {
        const float turning = std::abs(speed);
        const bool weakened = turning * def.electric->torque > def.electric->power;
        return weakened ? def.electric->power / turning : def.electric->torque;
    }
    const auto& curve = def.torqueCurve;
    const float rpm = revolutionsPerMinute(speed);
    if (rpm <= curve.front().rpm) return curve.front().torque;
    for (std::size_t i = 1; i < curve.size(); ++i) {
        const TorquePoint &a = curve[i - 1], &b = curve[i];
        if (rpm < b.rpm) return a.torque + (b.torque - a.torque) * ((rpm - a.rpm) / (b.rpm - a.rpm));
    }
    return curve.back().torque;
}

float idleSpeed(const EngineDef& def) { return def.electric ? 0 : radiansPerSecond(def.idleRpm); }

float peakTorque(const EngineDef& def) {
    if (def.electric) return def.electric->torque;
    float peak = 0;
    for (const TorquePoint& point : def.torqueCurve) peak = std::max(peak, point.torque);
    return peak;
}

float boostAfter(const EngineDef& def, float boost, float throttle, float h) {
    return def.turbo ? (boost * def.turbo->spoolTime + h * throttle) / (def.turbo->spoolTime + h) : throttle;
}

EngineLimits engineLimits(const EngineDef& def, float speed, float throttle, float boost, float target, float h) {
    EngineLimits limits;
    const float full = fullTorque(def, speed), fade = std::max(1 - 5 * throttle, 0.0f);
    limits.throttle = h * throttle * full;
    if (def.turbo) limits.throttle *= 1 - def.turbo->share * (1 - boost);
    limits.limiterSpeed = target;
    limits.idleSpeed = idleSpeed(def);
    if (def.electric) {
        limits.friction = h * fade * def.electric->regeneration * full;
        return limits;
    }
    limits.friction = h * fade * (def.brakeTorque + def.brakeViscosity * std::abs(speed));
    // Idle must win against friction, with something left to catch a falling engine.
    const float resists = def.brakeTorque + def.brakeViscosity * limits.idleSpeed;
    limits.idle = h * std::max(fullTorque(def, limits.idleSpeed), 2 * resists);
    return limits;
}

float solveEngine(const EngineDef& def, const EngineLimits& limits, EngineRows& rows, float& speed) {
    const float inverseInertia = 1 / def.inertia;
    const auto visit = [&](float& impulse, float target, float lower, float upper) {
        const float added = addBounded(impulse, (target - speed) * def.inertia, lower, upper);
        speed += added * inverseInertia;
        return added;
    };
    return visit(rows.friction, 0, -limits.friction, limits.friction) +
           visit(rows.throttle, limits.limiterSpeed, 0, limits.throttle) +
           visit(rows.idle, limits.idleSpeed, 0, limits.idle);
}

}  // namespace ragtop
