#pragma once

#include "ragtop/scene.h"

namespace ragtop {

/// Puts what a scene has after what the other one has; settings, step, duration and description are left out. Materials
/// keep their names, with the name of their scene before them where others have them already.
void appendScene(Scene&& from, Scene& to);

}  // namespace ragtop
