#pragma once

#include <vector>

#include "bicycle.h"
#include "ragtop/body.h"
#include "ragtop/vehicle_def.h"

namespace ragtop {

struct WheelSpec;

/// What level 0 knows of a car.
struct BicycleSpec {
    Bicycle<float> car;
    Vec3 foot;                                    ///< on the ground below the centre of mass, in the standing car
    float forwardFriction = 0, sideFriction = 0;  ///< of all tires under their static loads
    float turning = 0;                            ///< kg, inertia of the wheels as mass of the car
    float wheelbase = 0;                          ///< m
    float rolls = 0, pitches = 0;  ///< rad per m/s² across and along, of struts and tires that bear it for good
};
BicycleSpec makeRide(const VehicleDef& def, const MassProperties& mass, const std::vector<WheelSpec>& wheels);

/// Where level 0 is on the ground.
struct BicycleRoad {
    Vec3 normal, forward, left;
    float weight = 0;                             ///< N on the ground
    float forwardFriction = 0, sideFriction = 0;  ///< of the tires there
    float downhill = 0;                           ///< m/s² of gravity forward
    float air = 0;                                ///< N s forward, of the step
    float resistance = 0;                         ///< of tires and ground that roll, over the weight
};

}  // namespace ragtop
