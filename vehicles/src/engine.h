#pragma once

#include "ragtop/vehicle_def.h"

namespace ragtop {

constexpr float radiansPerSecond(float rpm) { return rpm * (kPi / 30); }
constexpr float revolutionsPerMinute(float speed) { return speed * (30 / kPi); }

/// Full-throttle torque (N m) at a speed (rad/s): straight between the points of the curve, level beyond its ends; of a
/// motor min(torque, power/|speed|).
float fullTorque(const EngineDef& def, float speed);
/// rad/s to which it is held at closed throttle; a motor stands.
float idleSpeed(const EngineDef& def);
/// The largest torque of the curve.
float peakTorque(const EngineDef& def);

/// What acts on the crankshaft in a substep, as impulses that stay within bounds while they push the speed towards a
/// target: the burning mixture towards the limiter's speed, the idle control towards idle, friction towards rest.
/// Net torque at throttle p is p · curve, less the brake torque, which fades out over the first fifth of the pedal (the
/// curve is net of friction already). A motor brakes by its regeneration instead. With a turbo p · curve is
/// p · curve · (1 − share (1 − boost)).
struct EngineRows {
    float throttle = 0, idle = 0, friction = 0;  ///< N m s
    bool operator==(const EngineRows&) const = default;
};

/// Bounds and targets of these rows for a substep.
struct EngineLimits {
    float throttle = 0, idle = 0, friction = 0;  ///< N m s
    float limiterSpeed = 0, idleSpeed = 0;       ///< rad/s
};
/// `target` replaces the limiter's speed while the gearbox wants the engine at another one.
EngineLimits engineLimits(const EngineDef& def, float speed, float throttle, float boost, float target, float h);

/// Boost after h: d b/dt = (throttle − b)/spoolTime, implicit.
float boostAfter(const EngineDef& def, float boost, float throttle, float h);

/// One visit: changes `speed` of the engine and the impulses; returns the change of the sum.
float solveEngine(const EngineDef& def, const EngineLimits& limits, EngineRows& rows, float& speed);

}  // namespace ragtop
