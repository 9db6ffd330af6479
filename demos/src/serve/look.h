#pragma once

#include <map>

#include "cast.h"
#include "ragtop/scene.h"

namespace ragtop::live {

/// Names and colours of the bodies of a scene.
std::map<BodyId, Look> looksOf(const Scene& scene, const SceneInstance& instance);

}  // namespace ragtop::live
