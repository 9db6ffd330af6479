#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "live_tuning.h"
#include "ragtop/id.h"
#include "ragtop/math.h"

/// Everything that reaches a world from outside while it runs.
namespace ragtop::live {

/// What is empty stays as it is.
struct DriveInput {
    std::size_t vehicle = 0;
    std::optional<float> throttle{}, brake{}, steer{}, handbrake{};
    std::optional<std::optional<int>> gear{};  ///< an empty gear inside: automatic
};
/// Puts a car at rest where it started.
struct ResetInput {
    std::size_t vehicle = 0;
};
struct GrabInput {
    BodyId body;
    Vec3 point;    ///< m, in the body
    DVec3 target;  ///< m
};
struct DragInput {
    DVec3 target;  ///< m
};
struct ReleaseInput {};
struct ShootInput {
    DVec3 origin;    ///< m
    Vec3 direction;  ///< need not have unit length
    float speed = 0, radius = 0;
};
/// Values by path.
struct TuneInput {
    std::vector<std::pair<std::string, TuneValue>> values{};
};

using Input = std::variant<DriveInput, ResetInput, GrabInput, DragInput, ReleaseInput, ShootInput, TuneInput>;

}  // namespace ragtop::live
