#pragma once

#include <vector>

#include "assimp_scene.h"

namespace ragtop {

/// The nodes that move as a skeleton where no skin says which are bones: trees of nodes that clips turn, three or more
/// below each other, with what lies between and their tips. Cameras, lights, their targets and what merely carries them
/// are none. All false where nothing moves so.
std::vector<bool> movingSkeleton(const ImportedScene& scene);

}  // namespace ragtop
