#pragma once

#include "json_value.h"
#include "ragtop/scene_tuning.h"

namespace ragtop {

/// The member "tuning" of a scene file: values by the paths of scene_tuning.h.
Json tuningSchema();
/// Tunes a scene as the member says. Throws AssetError at the place of the value that cannot be.
void readTuning(const JsonValue& tuning, Scene& scene);
Json writeTuning(std::span<const TunedValue> values);

}  // namespace ragtop
