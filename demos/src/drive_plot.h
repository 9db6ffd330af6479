#pragma once

#include <string>

#include "ragtop/manoeuvre.h"

namespace ragtop::demos {

/// An SVG with a plot over time for each of the manoeuvre's channels.
std::string plotOf(const Manoeuvre& manoeuvre, const TrackRun& run);

}  // namespace ragtop::demos
