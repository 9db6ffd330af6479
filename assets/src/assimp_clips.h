#pragma once

#include <string>

#include "assimp_scene.h"

struct aiScene;

namespace ragtop {

/// Reads the clips of a scene whose nodes have been read.
void addClips(const aiScene& from, ImportedScene& to);

/// Empty when a clip has keys that rise, are finite and belong to nodes.
std::string whyInvalid(const ImportedClip& clip, std::size_t nodeCount);

}  // namespace ragtop
