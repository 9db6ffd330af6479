#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "ragtop/asset_error.h"
#include "ragtop/ragdoll.h"

/// Ragdolls as glTF files with KHR_physics_rigid_bodies and KHR_implicit_shapes, which other programs read
/// (docs/files.md#physics-in-gltf).
namespace ragtop {

struct GltfRagdoll {
    RagdollDef ragdoll{};
    std::vector<std::string> warnings{};  ///< what of the file a ragdoll does not have
};

/// Whether a .gltf or .glb file has a node that physics moves; false where it cannot be read.
bool hasGltfRagdoll(const std::filesystem::path& path);

/// The bodies of a file as parts, and its joints. The file is read in a process of its own. Throws AssetError with the
/// place of what is wrong; no body in it, not readable, longer than 15 s.
GltfRagdoll loadGltfRagdoll(const std::filesystem::path& path);

/// Writes text (.gltf) or binary (.glb), which loadGltfRagdoll reads back equal. Throws AssetError where that cannot
/// be, or the ragdoll is not usable.
void saveGltfRagdoll(const RagdollDef& def, const std::filesystem::path& path);

}  // namespace ragtop
