#pragma once

#include <filesystem>

#include "assimp_scene.h"

struct aiScene;

namespace ragtop {

/// Adds normals, texture coordinates, materials and the textures of their colours to what was read of `from`, a scene
/// of `file`. Textures are taken from the file itself or from its folder; others, and those that are neither PNG nor
/// JPEG, become warnings.
void addLooks(const aiScene& from, const std::filesystem::path& file, ImportedScene& to);

}  // namespace ragtop
