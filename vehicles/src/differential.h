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

/// What a differential is under in a substep.
struct DifferentialLoad {
    float torque = 0;    ///< N m s into all driven wheels
    bool driven = true;  ///< by the engine; else it is driven by the wheels
    float lock = 0;      ///< 0 to 1, what the driver asks of active ones
    float h = 0;         ///< s
};

/// One visit: moves both groups towards equal mean speed by an impulse (N m s), as wheels that take `held` to turn;
/// returns the change of the impulse. With T what comes through the row and each side at T/2 but for what passes P from
/// the second to the first, torques differ by 2 P, and
///
///     limitedSlip  P ≤ (preload + lockingRatio |T|)/2
///     helical      P ≤ (B − 1)/(B + 1) |T|/2, so that (T/2 + P)/(T/2 − P) ≤ B
///     viscous      P = c Δω at the substep's end
///     active       P ≤ lock · activeTorque
float solveDifferential(const DifferentialRow& row, std::span<const float> inertia, std::span<const float> held,
                        const DifferentialLoad& load, float& impulse, std::span<float> spin);
/// J that the impulse of a row takes from wheels that turn at these speeds on average.
double lossOf(const DifferentialRow& row, float impulse, std::span<const float> meanSpin);

/// Adds an impulse of a row to the wheels, without bounds.
void applyDifferential(const DifferentialRow& row, std::span<const float> inertia, float impulse,
                       std::span<float> spin);

}  // namespace ragtop
