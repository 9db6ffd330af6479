#include "drivetrain.h"

#include <algorithm>
#include <cmath>

#include "brakes.h"
#include "point_body.h"

namespace ragtop {

Drivetrain::Drivetrain(const VehicleDef& def) : engineSpeed(idleSpeed(def.engine)), rows_(differentialRows(def)) {
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
    brakeHeat.assign(def.wheels.size(), 0);
    padWork_ = brakeHeat;
    for (std::vector<float>* each : {&brakeBound_, &rollBound_, &carried_, &spinBefore_, &meanSpin_, &given_})
        each->assign(def.wheels.size(), 0);
    differential.assign(rows_.size(), 0);
}

Drivetrain::Drivetrain(const VehicleDef& def, Drivetrain&& before) : Drivetrain(def) {
    engineSpeed = before.engineSpeed;
    engine = before.engine;
    clutch = before.clutch;
    boost = before.boost;
    work = before.work;
    gearbox = before.gearbox;
    gearbox.gear = std::min(gearbox.gear, static_cast<std::int32_t>(highestGear(def.gearbox)));
    if (!def.gearbox.continuous) gearbox.ratio = 0;
    spin = std::move(before.spin);
    brake = std::move(before.brake);
    brakeHeat = std::move(before.brakeHeat);
    if (before.differential.size() == differential.size()) differential = std::move(before.differential);
}

void Drivetrain::startRolling(const VehicleDef& def, float axleSpeed) {
    for (std::size_t i = 0; i < def.gearbox.ratios.size(); ++i) {
        gearbox.shiftTimer = 0;
        shift(def.gearbox, gearbox, {}, axleSpeed, 0, 0);
    }
    gearbox.shiftTimer = 0;
    engineSpeed = std::max(engineSpeed, gearing(def.gearbox, gearbox) * axleSpeed);
}

void Drivetrain::stop(const VehicleDef& def) {
    engineSpeed = idleSpeed(def.engine);
    engine = {};
    clutch = boost = 0;
    for (std::vector<float>* each : {&spin, &brake, &differential}) std::ranges::fill(*each, 0.0f);
    std::ranges::fill(brakeHeat, 0.0);
}

float Drivetrain::axleSpeed() const {
    float speed = 0;
    for (std::size_t i = 0; i < spin.size(); ++i) speed += share_[i] * spin[i];
    return speed;
}

float Drivetrain::shaftSpeed(const GearboxDef& def) const { return gearing(def, gearbox) * axleSpeed(); }

void Drivetrain::turnByClutch(float impulse, float inverseEngineInertia) {
    engineSpeed -= impulse * inverseEngineInertia;
    for (std::size_t i = 0; i < spin.size(); ++i) spin[i] += impulse * driveRatio_ * share_[i] / inertia_[i];
}

void Drivetrain::takeCoupling(const VehicleDef& def, const DrivetrainInput& input, float h) {
    const bool driven = std::any_of(share_.begin(), share_.end(), [](float s) { return s > 0; });
    ratio_ = driven ? gearing(def.gearbox, gearbox) : 0;
    const float shaft = ratio_ * axleSpeed();
    // While the clutch is out for a shift the engine goes to the speed at which the new gear meets it.
    const bool apart = gearbox.shiftTimer > 0 && def.gearbox.coupling == CouplingType::clutch;
    const float limiter = radiansPerSecond(def.engine.limiterRpm);
    const float target = apart ? clampTo(shaft, 0, limiter) : limiter;
    boost = boostAfter(def.engine, boost, input.throttle, h);
    limits_ = engineLimits(def.engine, engineSpeed, input.throttle, boost, target, h);
    CouplingLaw law;
    if (ratio_ != 0) {
        law = couplingLaw(def, {engineSpeed, shaft, input.throttle, input.clutch,
                                (limits_.throttle - limits_.friction) / h, gearbox.shiftTimer});
    }
    clutchBound_ = h * law.bound;
    clutchGive_ = law.give / h;
    driveRatio_ = law.torqueRatio * ratio_;
    loss_ = (1 - def.gearbox.efficiency) * std::abs(driveRatio_);
}

void Drivetrain::begin(const VehicleDef& def, const DrivetrainInput& input, const std::vector<float>& resistances,
                       float h) {
    engineBefore_ = engineSpeed;
    spinBefore_ = spin;
    std::ranges::fill(given_, 0.0f);
    for (std::size_t i = 0; i < std::min(spin.size(), input.wheelTorques.size()); ++i) {
        given_[i] = h * input.wheelTorques[i];
        spin[i] += given_[i] / inertia_[i];
    }
    takeCoupling(def, input, h);
    lock_ = input.lock;
    held_ = inertia_;
    for (std::size_t i = 0; i < spin.size(); ++i) {
        const float pads = 1 / (1 + def.wheels[i].brakeFade * std::max(brakeWarmth(def.wheels[i], i), 0.0f));
        brakeBound_[i] = h * brakeCapacity(def.wheels[i], pads * input.brake, pads * input.handbrake, resistances[i]);
        rollBound_[i] = h * resistances[i];
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
    for (std::size_t i = 0; i < spin.size(); ++i) inverse += ratio_ * driveRatio_ * share_[i] * share_[i] / held_[i];
    return 1 / (inverse + clutchGive_);
}

/// With what gears lose.
float Drivetrain::brakeBoundOf(std::size_t i) const { return brakeBound_[i] + loss_ * share_[i] * std::abs(clutch); }

float Drivetrain::sweep(const VehicleDef& def, float h) {
    float largest = 0;
    const auto note = [&](float change) { largest = std::max(largest, std::abs(change)); };
    note(ratio_ * solveEngine(def.engine, limits_, engine, engineSpeed));
    const float slip = engineSpeed - ratio_ * axleSpeed() - clutchGive_ * clutch;
    const float added = addBounded(clutch, slip * clutchMass(def.engine.inertia), -clutchBound_, clutchBound_);
    turnByClutch(added, 1 / def.engine.inertia);
    note(driveRatio_ * added);
    const DifferentialLoad load{driveRatio_ * clutch, clutch >= 0, lock_, h};
    for (std::size_t i = 0; i < rows_.size(); ++i) {
        note(solveDifferential(rows_[i], inertia_, held_, load, differential[i], spin));
    }
    for (std::size_t i = 0; i < spin.size(); ++i) {
        note(solveBrake(inertia_[i], held_[i], brakeBoundOf(i), stillSpin(i), brake[i], spin[i]));
    }
    return largest;
}

bool Drivetrain::hold(std::size_t wheel, float taken) {
    const float still = stillSpin(wheel);
    const float needed = brake[wheel] + taken + inertia_[wheel] * (still - spin[wheel]);
    if (!(std::abs(needed) <= brakeBoundOf(wheel))) return false;
    brake[wheel] = needed;
    spin[wheel] = still;
    return true;
}

void Drivetrain::holdWheels() {
    for (std::size_t i = 0; i < spin.size(); ++i) {
        solveBrake(inertia_[i], inertia_[i], brakeBoundOf(i), stillSpin(i), brake[i], spin[i]);
    }
}

/// What the impulses of this substep have done, each at the mean of the speeds before and after all of them.
void Drivetrain::count() {
    const auto wide = [](float x) { return static_cast<double>(x); };
    double axle = 0;
    for (std::size_t i = 0; i < spin.size(); ++i) {
        meanSpin_[i] = 0.5f * (spinBefore_[i] + spin[i]);
        axle += wide(share_[i]) * wide(meanSpin_[i]);
        work.engine += wide(given_[i]) * wide(meanSpin_[i]);
        const double lost = -wide(brake[i]) * wide(meanSpin_[i]), bound = wide(brakeBoundOf(i));
        padWork_[i] = 0;
        if (!(bound > 0)) continue;
        work.rolling += lost * wide(rollBound_[i]) / bound;
        // Pads rub by what the wheel turns faster than what carries them.
        padWork_[i] = wide(padImpulse(i)) * wide(carried_[i] - meanSpin_[i]);
        work.brakes += padWork_[i];
        work.gears += lost * (bound - wide(brakeBound_[i])) / bound;
    }
    const double turning = 0.5 * wide(engineBefore_ + engineSpeed);
    work.engine += wide(engine.throttle + engine.idle + engine.friction) * turning;
    work.clutch += wide(clutch) * (turning - wide(driveRatio_) * axle);
    for (std::size_t i = 0; i < rows_.size(); ++i) work.differentials += lossOf(rows_[i], differential[i], meanSpin_);
}

double Drivetrain::workOnCarriers() const {
    double sum = 0;
    for (std::size_t i = 0; i < spin.size(); ++i)
        sum -= static_cast<double>(padImpulse(i)) * static_cast<double>(carried_[i]);
    return sum;
}

double Drivetrain::rotatingEnergy(const EngineDef& def) const {
    const auto energy = [](float inertia, float speed) {
        return 0.5 * static_cast<double>(inertia) * static_cast<double>(speed) * static_cast<double>(speed);
    };
    double sum = energy(def.inertia, engineSpeed);
    for (std::size_t i = 0; i < spin.size(); ++i) sum += energy(inertia_[i], spin[i]);
    return sum;
}

/// By backward Euler, C dT/dt = P − (k₀ + k₁ |ω r|) T, so that heat is exactly what pads took less what the air did.
void Drivetrain::coolBrakes(const VehicleDef& def, float h) {
    for (std::size_t i = 0; i < spin.size(); ++i) {
        const WheelDef& wheel = def.wheels[i];
        if (!wheel.brakeHeatCapacity) continue;
        const float lost = wheel.brakeCooling + wheel.brakeCoolingPerSpeed * std::abs(meanSpin_[i]) * wheel.radius;
        brakeHeat[i] = (brakeHeat[i] + padWork_[i]) / (1 + static_cast<double>(h * lost / *wheel.brakeHeatCapacity));
    }
}

void Drivetrain::end(const VehicleDef& def, float h) {
    count();
    coolBrakes(def, h);
    const float s = 1 / h;
    engine = {s * engine.throttle, s * engine.idle, s * engine.friction};
    clutch *= s;
    for (float& torque : brake) torque *= s;
    for (float& torque : differential) torque *= s;
}

}  // namespace ragtop
