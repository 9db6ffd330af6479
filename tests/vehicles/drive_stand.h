#pragma once

#include <vector>

#include "drivetrain.h"
#include "gearbox.h"
#include "hatchback.h"

namespace ragtop {

inline constexpr float kSubstep = 1.0f / 240;

/// A drivetrain on a stand: rolls that turn freely, each held back by a torque.
struct Stand {
    VehicleDef def;
    Drivetrain drivetrain;
    std::vector<float> resistances;
    double road = 0;  ///< J that the torques have done

    explicit Stand(const VehicleDef& d) : def(d), drivetrain(d), resistances(d.wheels.size(), 0.0f) {}

    void step(const DrivetrainInput& input, const std::vector<float>& torque) {
        const double before = drivetrain.rotatingEnergy(def.engine);
        for (std::size_t i = 0; i < torque.size(); ++i) {
            drivetrain.spin[i] += kSubstep * torque[i] / drivetrain.inertia()[i];
        }
        road += drivetrain.rotatingEnergy(def.engine) - before;
        drivetrain.begin(def, input, resistances, kSubstep);
        for (int i = 0; i < 200; ++i) {
            if (drivetrain.sweep(def, kSubstep) <= 1e-6f * kSubstep) break;
        }
        drivetrain.end(def, kSubstep);
    }
    /// Torque of the drivetrain on a wheel over the last steps, since it turned at `before`.
    double torqueOn(std::size_t i, float before, int steps, float torque) const {
        return static_cast<double>(
            (drivetrain.spin[i] - before) * drivetrain.inertia()[i] / (kSubstep * static_cast<float>(steps)) - torque);
    }
    void turnAt(int gear, float axleSpeed) {
        drivetrain.gearbox.gear = gear;
        drivetrain.engineSpeed = gearing(def.gearbox, gear) * axleSpeed;
        for (float& spin : drivetrain.spin) spin = axleSpeed;
    }
};

inline VehicleDef withDifferential(DifferentialType type) {
    VehicleDef def = hatchback();
    def.differential.type = type;
    def.gearbox.automatic = false;
    def.gearbox.efficiency = 1;
    return def;
}

}  // namespace ragtop
