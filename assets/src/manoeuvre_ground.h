#pragma once

#include <optional>

#include "ragtop/manoeuvre.h"
#include "ragtop/world.h"

namespace ragtop {

Quat trackTilt(const TrackGround& ground);
/// Puts the ground with all that is on it into a world; `friction` instead of the ground's.
void layTrack(World& world, const TrackGround& ground, std::optional<float> friction);

}  // namespace ragtop
