#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "ragtop/math.h"
#include "ragtop/tuning.h"

namespace ragtop::live {

using Json = nlohmann::ordered_json;

/// The shortest decimal that names this float; null where it is not finite.
Json number(float value);
Json array(const Vec3& v);
Json array(const Quat& q);
/// x, y, z from `origin`, then the rotation.
Json array(const Pose& pose, const DVec3& origin);
/// A tuned value as in a message.
Json tuneJson(const TuneValue& value);
/// On one line; bytes that are no UTF-8 are replaced.
std::string text(const Json& json);

}  // namespace ragtop::live
