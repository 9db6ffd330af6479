#pragma once

#include <span>
#include <vector>

#include "ragtop/vehicle_def.h"

namespace ragtop {

/// Couples the mean speeds of two groups of wheels: the two sides of an axle, or two axles. An open differential
/// couples nothing beyond what the gearing does and has no such row.
struct DifferentialRow {
    DifferentialDef def;
    std::vector<int> first, second;  ///< wheels of either group
    float share = 0;                 ///< of the engine's torque that comes through it
};

/// The rows of a car: one per neighbouring pair of driven wheels of an axle, one per neighbouring pair of driven axles.
std::vector<DifferentialRow> differentialRows(const VehicleDef& def);

/// One visit: moves both groups towards equal mean speed by an impulse (N m s) of at most what the type allows when
/// `torque` (N m s) drives the car, as wheels that take `held` to turn; returns the change of the impulse.
float solveDifferential(const DifferentialRow& row, std::span<const float> inertia, std::span<const float> held,
                        float torque, float h, float& impulse, std::span<float> spin);

/// Adds an impulse of a row to the wheels, without bounds.
void applyDifferential(const DifferentialRow& row, std::span<const float> inertia, float impulse,
                       std::span<float> spin);

}  // namespace ragtop
