#pragma once

#include "ragtop/manoeuvre.h"

namespace ragtop {

/// What laws need besides what was driven.
struct TrackCase {
    const Manoeuvre* manoeuvre;
    const VehicleDef* def;
    float friction;  ///< of the ground
};

/// The car as a bicycle: its steered wheels in front, the others behind.
struct Axles {
    double front = 0, rear = 0;  ///< rad⁻¹ N: cornering stiffness
    double a = 0, b = 0;         ///< m from the centre of mass to steered and unsteered axle
    double relaxation = 0;       ///< m, of its tires
    double mass = 0, yawInertia = 0;
};
Axles axlesOf(const VehicleDef& def);

/// Whose chassis weighs as much as all of the car: on carriers it has what these leave.
VehicleDef asOneBody(VehicleDef def);

/// Takes the value from the samples and judges it. A value that there is none of (a level never reached, no sample in
/// the window) is not a number and fails.
TrackValue measured(const TrackMeasurement& wanted, const TrackRun& run, const TrackCase& made);

}  // namespace ragtop
