#pragma once

#include "assimp_scene.h"

namespace ragtop {

/// Skins whose vertices stand in the frames of their bones, so that at bind all bones are in one place, as where a glTF
/// has no inverseBindMatrices: their vertices go to where the nodes at rest bring them, which becomes the bind pose.
void unfoldSkins(ImportedScene& scene);

}  // namespace ragtop
