#pragma once

#include <string>
#include <vector>

#include "assimp_scene.h"
#include "json_document.h"

namespace ragtop {

/// The springs of VRMC_springBone 1.0 in the text of a glTF file [VRM Consortium]. Nodes are those of the file. Throws
/// AssetError with places.
ImportedSprings readGltfSprings(const JsonDocument& gltf);

}  // namespace ragtop
