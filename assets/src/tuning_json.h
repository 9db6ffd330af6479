#pragma once

#include <functional>
#include <string>

#include "json_value.h"
#include "ragtop/scene_tuning.h"

namespace ragtop {

/// The member "tuning" of a scene file: values by the paths of scene_tuning.h.
Json tuningSchema();
/// Tunes a scene as the member says, at paths of what `isThere`. Throws AssetError at the place of a value that cannot be,
/// or collects it as a fault.
void readTuning(const JsonValue& tuning, Scene& scene, const std::function<bool(const std::string&)>& isThere);
Json writeTuning(std::span<const TunedValue> values);

}  // namespace ragtop
