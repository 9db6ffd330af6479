#pragma once

#include <string>
#include <vector>

#include "gltf/mesh_points.h"
#include "json_document.h"
#include "ragtop/ragdoll.h"

namespace ragtop {

/// A ragdoll from the text of a glTF file, and the nodes that became its bones, parts and joints.
struct RagdollFromGltf {
    RagdollDef def{};
    std::vector<int> bones{}, parts{}, joints{};
    std::vector<std::string> warnings{};
};

/// Whether some node of the file moves by physics.
bool hasGltfPhysics(const JsonDocument& gltf);

/// What the extensions alone say. Bodies are parts, in the order of `extras.ragtop.parts` of the file, or from the
/// first body along its joints. Throws AssetError with places: wrong values, indices that lead nowhere, no body.
RagdollFromGltf readGltfPhysics(const JsonDocument& gltf, const MeshPoints& points);

/// The same, changed by what `extras.ragtop` of nodes say beyond it, as written by gltfOf.
RagdollFromGltf readGltfRagdoll(const JsonDocument& gltf, const MeshPoints& points);

/// Adds to nodes what readGltfRagdoll has to change to give `def`.
void addExtras(Json& gltf, const RagdollDef& def, const std::string& file, const MeshPoints& points);

/// A file that is read back equal: what the extensions cannot say is in `extras`. Throws AssetError where parts share a
/// bone.
Json gltfOf(const RagdollDef& def, const std::string& file);

}  // namespace ragtop
