#pragma once

#include "ragtop/scene.h"

namespace ragtop {

/// m between the foremost and the rearmost wheel.
float wheelbase(const VehicleDef& def);
/// The input, −1 to 1, that turns a wheel in the middle of the front axle by `angle` rad to the left at `speed`.
float steerFor(const SteeringDef& steering, float angle, float speed);

/// What a driver does who keeps a car on the centre line of a road at up to `speed` m/s: steers for a point ahead on
/// the line by pure pursuit [Coulter, Implementation of the Pure Pursuit Path Tracking Algorithm, 1992], slows down for
/// bends, and brakes at the end of a road that has one. Depends on where the car is alone.
VehicleInput followRoad(const SceneRoad& road, const Vehicle& car, const Pose& chassis, float speed);

}  // namespace ragtop
