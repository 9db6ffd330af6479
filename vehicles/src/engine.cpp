#include "engine.h"

#include <algorithm>

#include "point_body.h"

namespace ragtop {

float fullTorque(const EngineDef& def, float speed) {
    const auto& curve = def.torqueCurve;
    const float rpm = revolutionsPerMinute(speed);
    if (rpm <= curve.front().rpm) return curve.front().torque;
    for (std::size_t i = 1; i < curve.size(); ++i) {
        const TorquePoint &a = curve[i - 1], &b = curve[i];
        if (rpm < b.rpm) return a.torque + (b.torque - a.torque) * ((rpm - a.rpm) / (b.rpm - a.rpm));
    }
    return curve.back().torque;
}

float peakTorque(const EngineDef& def) {
    float peak = 0;
    for (const TorquePoint& point : def.torqueCurve) peak = std::max(peak, point.torque);
    return peak;
}

EngineLimits engineLimits(const EngineDef& def, float speed, float throttle, float target, float h) {
    EngineLimits limits;
    limits.throttle = h * throttle * fullTorque(def, speed);
    limits.friction = h * std::max(1 - 5 * throttle, 0.0f) * def.brakeTorque;
    limits.idleSpeed = radiansPerSecond(def.idleRpm);
    limits.limiterSpeed = target;
    // Idle must win against friction, with something left to catch a falling engine.
    limits.idle = h * std::max(fullTorque(def, limits.idleSpeed), 2 * def.brakeTorque);
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
