#pragma once

#include <cmath>
#include <span>
#include <vector>

#include "coupling.h"
#include "differential.h"
#include "drive_work.h"
#include "engine.h"
#include "gearbox.h"
#include "ragtop/vehicle_def.h"

namespace ragtop {

/// What the driver and the road ask of the drivetrain in a substep.
struct DrivetrainInput {
    float throttle = 0, brake = 0, handbrake = 0, clutch = 0, lock = 0;
    std::span<const float> wheelTorques{};  ///< N m, of the first wheels
};

/// Everything that turns: the engine, and the wheels with what brakes and couples them. All of it is impulses that
/// stay within bounds while they remove a difference of speeds, swept together with the tires until they agree:
///
///     engine     friction, mixture, idle                  engine.h
///     coupling   ω_e = i Σ sⱼ ωⱼ + give · T, in bounds    i: gearing, sⱼ: shares, Σ sⱼ = 1     coupling.h
///     axles      equal speeds, within what they lock      differential.h
///     brakes     ωⱼ = pⱼ cⱼ, within pads and losses       pⱼ: padShare, cⱼ: carryPads; brakes.h
///
/// The coupling drives wheel j with R i sⱼ of its torque, R its torque ratio, so an open differential is what is left
/// when nothing else couples its wheels.
class Drivetrain {
public:
    Drivetrain() = default;
    explicit Drivetrain(const VehicleDef& def);
    /// With the state of another one that has as many wheels.
    Drivetrain(const VehicleDef& def, Drivetrain&& before);

    /// The gear and engine speed of a car whose driven wheels turn at `axleSpeed`.
    void startRolling(const VehicleDef& def, float axleSpeed);
    /// All at rest but the engine, which idles; the gear stays.
    void stop(const VehicleDef& def);
    /// Sets the bounds for a substep of h and applies the impulses of the last one; `resistances` of the rolling
    /// wheels, N m.
    void begin(const VehicleDef& def, const DrivetrainInput& input, const std::vector<float>& resistances, float h);
    /// One sweep; the largest change of an impulse at a wheel, N m s.
    float sweep(const VehicleDef& def, float h);
    /// Turns impulses into torques, and what pads have taken into heat.
    void end(const VehicleDef& def, float h);

    /// Speed of the gearbox's input shaft, rad/s.
    float shaftSpeed(const GearboxDef& def) const;

    // State: saved and restored.
    float engineSpeed = 0;  ///< rad/s
    EngineRows engine;      ///< N m; N m s between begin and end, as all below
    float clutch = 0;       ///< from engine to coupling
    float boost = 0;        ///< 0 to 1, of a turbo
    GearboxState gearbox;
    std::vector<float> spin;  ///< rad/s, per wheel
    std::vector<float> brake;
    std::vector<double> brakeHeat;  ///< J in disc and pads, over that of the air
    std::vector<float> differential;
    DriveWork work;

    /// K of a wheel's disc and pads over the air.
    float brakeWarmth(const WheelDef& wheel, std::size_t i) const {
        return wheel.brakeHeatCapacity ? static_cast<float>(brakeHeat[i]) / *wheel.brakeHeatCapacity : 0;
    }
    /// The share of `brake` that pads hold, which what carries the wheel feels the other way; between begin and end.
    float padShare(std::size_t i) const {
        const float bound = brakeBoundOf(i);
        return bound > 0 ? (brakeBound_[i] - rollBound_[i]) / bound : 0;
    }
    float padImpulse(std::size_t i) const { return brake[i] * padShare(i); }
    /// Says at which speed what carries a wheel's pads turns about its axle, rad/s forward, in this substep. Pads hold
    /// the wheel to that, so that what they do to wheel and carrier takes energy and gives none.
    void carryPads(std::size_t i, float speed) { carried_[i] = speed; }
    /// ½ Σ I ω² of engine and wheels, J.
    double rotatingEnergy(const EngineDef& def) const;
    const std::vector<float>& inertia() const { return inertia_; }
    /// What a wheel takes to turn together with its tire, which grips by `impulse` per unit of speed of its tread: what
    /// comes through the shafts is solved with that, as what the tires take of it comes off in their next visit.
    void grip(std::size_t wheel, float radius, float impulse) {
        held_[wheel] = inertia_[wheel] + radius * radius * impulse;
    }
    /// Can its brake bring a wheel to rest on its pads in this substep, but for what its tire does?
    bool mayHold(std::size_t wheel) const {
        return inertia_[wheel] * std::abs(spinBefore_[wheel] - stillSpin(wheel)) <= brakeBoundOf(wheel);
    }
    /// J that pads give to what carries them, between begin and end.
    double workOnCarriers() const;
    /// rad/s of a wheel that its brake holds.
    float stillSpin(std::size_t i) const { return carried_[i] != 0 ? padShare(i) * carried_[i] : 0; }
    /// Has the brake bring the wheel to rest there against `taken` of its tire, N m s, if it can.
    bool hold(std::size_t wheel, float taken);
    /// Holds what brakes hold, where tires have turned it since.
    void holdWheels();

private:
    float axleSpeed() const;
    float brakeBoundOf(std::size_t i) const;
    float clutchMass(float engineInertia) const;
    void takeCoupling(const VehicleDef& def, const DrivetrainInput& input, float h);
    void turnByClutch(float impulse, float inverseEngineInertia);
    void count();
    void coolBrakes(const VehicleDef& def, float h);

    std::vector<float> inertia_, held_, share_;
    std::vector<DifferentialRow> rows_;

    EngineLimits limits_;
    float ratio_ = 0, driveRatio_ = 0;  ///< of speeds; of torques
    float clutchBound_ = 0, clutchGive_ = 0, loss_ = 0, lock_ = 0;
    std::vector<float> brakeBound_, rollBound_;  ///< all but what gears lose; of it, what tires and ground resist by
    std::vector<float> carried_;                 ///< rad/s, of what carries pads
    float engineBefore_ = 0;
    std::vector<float> spinBefore_, meanSpin_, given_;  ///< rad/s; N m s
    std::vector<double> padWork_;                       ///< J of a substep
};

}  // namespace ragtop
