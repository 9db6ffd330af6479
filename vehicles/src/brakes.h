#pragma once

#include "ragtop/vehicle_def.h"

namespace ragtop {

/// Largest torque (N m) with which pads and the `resistance` of the rolling wheel oppose its rotation. Coulomb: what is
/// needed to stop it or hold it, up to this.
float brakeCapacity(const WheelDef& wheel, float pedal, float handbrake, float resistance);

/// One visit: brings the wheel towards the spin `still` by an impulse within the bound (N m s), as one that takes
/// `held` to turn; returns the change of the impulse.
float solveBrake(float inertia, float held, float bound, float still, float& impulse, float& spin);

}  // namespace ragtop
