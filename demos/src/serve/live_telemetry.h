#pragma once

#include <cstdint>
#include <optional>

#include "cast.h"
#include "json.h"
#include "nodes.h"

namespace ragtop::live {

/// A `telemetry` message: times of the last step, vehicles, and the picked body, where that is there.
Json telemetryMessage(const Cast& cast, const Nodes& nodes, std::optional<std::uint32_t> picked, const DVec3& origin);

}  // namespace ragtop::live
