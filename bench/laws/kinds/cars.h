#pragma once

#include "parts.h"
#include "ragtop/vehicle_def.h"

/// Vehicles drawn by chance.
namespace ragtop::laws {

/// What a ground asks of a vehicle.
struct CarLimits {
    float largest = 2.5f;  ///< over the size of a hatchback
    bool isTowed = false;  ///< has no drive
};

/// A usable definition of 200 kg to 20 t on 3 to 8 wheels, at any level: origin on the ground below, nose along +z.
/// Brakes lock the wheels or do a third of that.
VehicleDef drawCar(Dice& dice, const CarLimits& limits = {});

}  // namespace ragtop::laws
