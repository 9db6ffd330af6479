#pragma once

#include <span>
#include <vector>

#include "manoeuvre_laws.h"

namespace ragtop {

/// The trailer as a vehicle that nothing drives, steers or brakes, without air. Its origin is on the ground between the
/// axles.
VehicleDef trailerOf(const TrackTrailer& trailer, const VehicleDef& car);

/// The hitch, in the car and in the trailer.
Vec3 hitchOfCar(const VehicleDef& car);
Vec3 hitchOfTrailer(const TrackTrailer& trailer, const VehicleDef& car);

/// As TrackLaw::hitchPull, between the first and the last sample.
double hitchPull(const TrackTrailer& trailer, const VehicleDef& car, std::span<const TrackSample> samples);

/// Samples whose articulation is that of the linear single-track car and trailer, which go straight at the first.
std::vector<TrackSample> linearSwing(const TrackTrailer& trailer, const VehicleDef& car,
                                     std::span<const TrackSample> samples);

}  // namespace ragtop
