#pragma once

#include <array>

#include "ragtop/vehicle_def.h"

/// What the hardpoints of an axle make of its wheels' travel: the curves that suspensions are judged by, of the linkage
/// alone, without forces [Milliken, Milliken, Race Car Vehicle Dynamics, 1995, ch. 17; Dixon, Suspension Geometry and
/// Computation, 2009].
namespace ragtop {

/// Of an axle, in the chassis.
struct AxlePlace {
    double leftRise = 0, rightRise = 0;  ///< m of the hubs above where they are in the standing car
    double rack = 0;                     ///< m to the left
};

/// Of a wheel at a place of its axle. "Out" is away from the middle of the car. Rates are per m that the wheel rises
/// alone.
struct WheelPosture {
    DVec3 hub, contact;      ///< m, in the chassis; of the lowest point of the tire
    double camber = 0;       ///< rad, positive with the top out
    double toe = 0;          ///< rad, positive looking in
    double caster = 0;       ///< rad of the steering axis, positive with its top behind; 0 where nothing steers
    double kingpin = 0;      ///< rad of the steering axis, positive with its top in
    double trail = 0;        ///< m by which the steering axis meets the ground ahead of the contact
    double scrub = 0;        ///< m by which it meets the ground inside of the contact
    double motionRatio = 1;  ///< m of the spring per m
    double camberRate = 0;   ///< rad/m
    double toeRate = 0;      ///< rad/m
    double rollCenter = 0;   ///< m above the ground: of forces at this wheel's contact; of a beam as it rolls
    double brakeSlope = 0;   ///< m by which the contact goes forward per m, with the wheel braked at the carrier;
                             ///< above 0 braking lifts the body there
    double driveSlope = 0;   ///< the same of the hub, as where shafts drive the wheel
};

/// Left wheel, right wheel. Throws std::invalid_argument that says which axle cannot come there, or has no linkage.
std::array<WheelPosture, 2> wheelPostures(const VehicleDef& def, unsigned axle, const AxlePlace& place);

/// m by which the rack travels to the left per rad that its wheels turn to the left, about straight ahead; 0 where the
/// axle does not steer. Throws as wheelPostures.
double rackTravel(const VehicleDef& def, unsigned axle);

}  // namespace ragtop
