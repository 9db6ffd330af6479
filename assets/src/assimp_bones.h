#pragma once

#include <cstdint>
#include <map>
#include <string>

#include "assimp_scene.h"

struct aiNode;
struct aiScene;

namespace ragtop {

/// Where the nodes of assimp's scene are among those of ours.
using NodePlaces = std::map<const aiNode*, std::int32_t>;

/// Sets the node of each bone of the meshes. assimp tells its name alone, which meshes may have too: a node that
/// carries none is preferred.
void findBoneNodes(const NodePlaces& places, ImportedScene& to);

/// Reads the springs of a glTF file, which assimp passes over.
void findSprings(const aiScene& from, const std::string& file, const NodePlaces& places, ImportedScene& to);

/// Throws AssetError where a glTF file requires an extension that is not read, or a skin has no matrices, at which the
/// importer would crash.
void checkGltf(const std::string& file);

/// The JSON of a text or binary glTF file.
std::string gltfText(const std::string& file);

}  // namespace ragtop
