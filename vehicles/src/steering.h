#pragma once

#include "ragtop/math.h"
#include "ragtop/vehicle_def.h"

namespace ragtop {

/// The angle (rad, positive to the left) after dt seconds of steering towards `input` (−1 left to 1 right).
float steeredAngle(const SteeringDef& def, float angle, float input, float speed, float dt);

/// Unit direction, in the chassis, into which a wheel rolls. `position` is relative to the middle of the axle that does
/// not steer.
///
/// With ackermann 1 the wheels of an axle turn about the point of the unsteered axle's line, x = R, about which a wheel
/// in the middle of their axle turns by δ: R = z/tan δ, so tan δᵢ = z/(R − xᵢ) = sin δ/(cos δ − (xᵢ/z) sin δ).
Vec3 wheelDirection(const SteeringDef& def, float steerFactor, const Vec3& position, float angle);

}  // namespace ragtop
