#pragma once

#include <span>
#include <vector>

#include "ragtop/vehicle.h"

/// Drivers: what a person, or a test track, does with a car's controls.
namespace ragtop {

/// A line on the ground for a driver to follow, as points a few metres apart.
struct DriverLine {
    std::span<const DVec3> points{};  ///< m, at least two
    bool closed = false;              ///< the first point follows the last
};

/// Points at most 2 m apart on a smooth curve through all of those given
/// [Catmull, Rom, A Class of Local Interpolating Splines, 1974]. At least two are needed.
std::vector<DVec3> smoothLine(std::span<const DVec3> through, bool closed);

/// Where a place is beside a line, seen from above.
struct LinePlace {
    float along = 0;   ///< m from the first point, along the line
    float aside = 0;   ///< m, positive to the left of it
    float length = 0;  ///< m of the whole line
};
LinePlace placeAt(const DriverLine& line, const DVec3& place);

/// m between the foremost and the rearmost wheel.
float wheelbase(const VehicleDef& def);
/// The input, −1 to 1, that turns a wheel in the middle of the front axle by `angle` rad to the left at `speed`.
float steerFor(const SteeringDef& steering, float angle, float speed);

/// What a driver does who keeps a car on a line at up to `speed` m/s: steers for a point ahead on the line by pure
/// pursuit [Coulter, Implementation of the Pure Pursuit Path Tracking Algorithm, 1992], slows down for bends, and
/// brakes at the end of a line that has one. Depends on where the car is alone.
VehicleInput followLine(const DriverLine& line, const Vehicle& car, const Pose& chassis, float speed);

}  // namespace ragtop
