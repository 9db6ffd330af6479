#include "drivetrain.h"

#include <algorithm>
#include <cmath>

#include "brakes.h"
#include "point_body.h"

namespace ragtop {

Drivetrain::Drivetrain(const VehicleDef& def)
    : engineSpeed(radiansPerSecond(def.engine.idleRpm)), rows_(differentialRows(def)) {
    float total = 0;
    for (const WheelDef& wheel : def.wheels) total += wheel.driveShare;
    for (const WheelDef& wheel : def.wheels) {
        // Rim and tire: between a disc (½ m r²) and a hoop (m r²).
        inertia_.push_back(0.75f * wheel.mass * wheel.radius * wheel.radius);
        share_.push_back(total > 0 ? wheel.driveShare / total : 0);
    }
    held_ = inertia_;
    spin.assign(def.wheels.size(), 0);
    brake.assign(def.wheels.size(), 0);
    brakeBound_.assign(def.wheels.size(), 0);
    differential.assign(rows_.size(), 0);
}

Drivetrain::Drivetrain(const VehicleDef& def, Drivetrain&& before) : Drivetrain(def) {
    engineSpeed = before.engineSpeed;
    engine = before.engine;
    clutch = before.clutch;
    gearbox = before.gearbox;
    gearbox.gear = std::min(gearbox.gear, static_cast<std::int32_t>(def.gearbox.ratios.size()));
    spin = std::move(before.spin);
    brake = std::move(before.brake);
    if (before.differential.size() == differential.size()) differential = std::move(before.differential);
}

void Drivetrain::startRolling(const VehicleDef& def, float axleSpeed) {
    for (std::size_t i = 0; i < def.gearbox.ratios.size(); ++i) {
        gearbox.shiftTimer = 0;
        shift(def.gearbox, gearbox, {}, axleSpeed, 0, 0);
    }
    gearbox.shiftTimer = 0;
    engineSpeed = std::max(engineSpeed, gearing(def.gearbox, gearbox.gear) * axleSpeed);
}

void Drivetrain::stop(const VehicleDef& def) {
    engineSpeed = radiansPerSecond(def.engine.idleRpm);
    engine = {};
    clutch = 0;
    for (std::vector<float>* each : {&spin, &brake, &differential}) std::ranges::fill(*each, 0.0f);
}

float Drivetrain::axleSpeed() const {
    float speed = 0;
    for (std::size_t i = 0; i < spin.size(); ++i) speed += share_[i] * spin[i];
    return speed;
}

float Drivetrain::shaftSpeed(const GearboxDef& def) const { return gearing(def, gearbox.gear) * axleSpeed(); }

void Drivetrain::turnByClutch(float impulse, float inverseEngineInertia) {
    engineSpeed -= impulse * inverseEngineInertia;
    for (std::size_t i = 0; i < spin.size(); ++i) spin[i] += impulse * ratio_ * share_[i] / inertia_[i];
}

void Drivetrain::begin(const VehicleDef& def, const DrivetrainInput& input, const std::vector<float>& resistances,
                       float h) {
    const bool shifting = gearbox.shiftTimer > 0;
    const bool driven = std::any_of(share_.begin(), share_.end(), [](float s) { return s > 0; });
    ratio_ = driven ? gearing(def.gearbox, gearbox.gear) : 0;
    loss_ = (1 - def.gearbox.efficiency) * std::abs(ratio_);
    const float shaft = ratio_ * axleSpeed();

    // While the clutch is out for a shift the engine goes to the speed at which the new gear meets it.
    const float limiter = radiansPerSecond(def.engine.limiterRpm);
    const float target = shifting ? clampTo(shaft, 0, limiter) : limiter;
    limits_ = engineLimits(def.engine, engineSpeed, input.throttle, target, h);
    clutchBound_ = 0;
    if (ratio_ != 0 && !shifting) {
        clutchBound_ = h * clutchCapacity(def, engineSpeed, shaft, input.throttle, input.clutch);
    }
    held_ = inertia_;
    for (std::size_t i = 0; i < spin.size(); ++i) {
        brakeBound_[i] = h * brakeCapacity(def.wheels[i], input.brake, input.handbrake, resistances[i]);
    }

    // The last substep's torques, as a first guess.
    engine.friction = clampTo(h * engine.friction, -limits_.friction, limits_.friction);
    engine.throttle = clampTo(h * engine.throttle, 0, limits_.throttle);
    engine.idle = clampTo(h * engine.idle, 0, limits_.idle);
    engineSpeed += (engine.friction + engine.throttle + engine.idle) / def.engine.inertia;
    clutch = clampTo(h * clutch, -clutchBound_, clutchBound_);
    turnByClutch(clutch, 1 / def.engine.inertia);
    for (std::size_t i = 0; i < spin.size(); ++i) {
        const float bound = brakeBoundOf(i);
        brake[i] = clampTo(h * brake[i], -bound, bound);
        spin[i] += brake[i] / inertia_[i];
    }
    for (std::size_t i = 0; i < rows_.size(); ++i) {
        differential[i] *= h;
        applyDifferential(rows_[i], inertia_, differential[i], spin);
    }
}

float Drivetrain::clutchMass(float engineInertia) const {
    float inverse = 1 / engineInertia;
    for (std::size_t i = 0; i < spin.size(); ++i) inverse += ratio_ * ratio_ * share_[i] * share_[i] / held_[i];
    return 1 / inverse;
}

/// With what gears lose.
float Drivetrain::brakeBoundOf(std::size_t i) const { return brakeBound_[i] + loss_ * share_[i] * std::abs(clutch); }

float Drivetrain::sweep(const VehicleDef& def, float h) {
    float largest = 0;
    const auto note = [&](float change) { largest = std::max(largest, std::abs(change)); };
    note(ratio_ * solveEngine(def.engine, limits_, engine, engineSpeed));
    const float added = addBounded(clutch, (engineSpeed - ratio_ * axleSpeed()) * clutchMass(def.engine.inertia),
                                   -clutchBound_, clutchBound_);
    turnByClutch(added, 1 / def.engine.inertia);
    note(ratio_ * added);
    for (std::size_t i = 0; i < rows_.size(); ++i) {
        note(solveDifferential(rows_[i], inertia_, held_, ratio_ * clutch, h, differential[i], spin));
    }
    for (std::size_t i = 0; i < spin.size(); ++i) {
        note(solveBrake(inertia_[i], held_[i], brakeBoundOf(i), brake[i], spin[i]));
    }
    return largest;
}

void Drivetrain::holdWheels() {
    for (std::size_t i = 0; i < spin.size(); ++i) {
        solveBrake(inertia_[i], inertia_[i], brakeBoundOf(i), brake[i], spin[i]);
    }
}

void Drivetrain::end(float h) {
    const float s = 1 / h;
    engine = {s * engine.throttle, s * engine.idle, s * engine.friction};
    clutch *= s;
    for (float& torque : brake) torque *= s;
    for (float& torque : differential) torque *= s;
}

}  // namespace ragtop
