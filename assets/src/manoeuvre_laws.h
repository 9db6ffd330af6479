#pragma once

#include "ragtop/manoeuvre.h"

namespace ragtop {

/// What laws need besides what was driven.
struct TrackCase {
    const Manoeuvre* manoeuvre;
    const VehicleDef* def;
    float friction;  ///< of the ground
};

/// Takes the value from the samples and judges it. A value that there is none of (a level never reached, no sample in
/// the window) is not a number and fails.
TrackValue measured(const TrackMeasurement& wanted, const TrackRun& run, const TrackCase& made);

}  // namespace ragtop
