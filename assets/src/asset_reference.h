#pragma once

#include <string>
#include <vector>

#include "json_value.h"
#include "ragtop/ragdoll.h"
#include "ragtop/robot.h"
#include "ragtop/shape.h"

namespace ragtop {

/// The file that the string `value` names: relative to the file that it stands in, or by findAsset
/// ("assimp-testmodels:…", "samples:…"). Throws AssetError that names the place of the reference.
std::filesystem::path assetFile(const JsonValue& value);

/// Why there is no such file; empty where there is one.
std::string whyAbsent(const JsonValue& value);

/// The triangles, or the convex hull, of the mesh file that the string `value` names.
Shape loadMeshReference(const JsonValue& value, bool convex);

/// A ragdoll made from the rigged character in the file that the string `value` names. What the import and the
/// fitting had to guess is added to `warnings`.
RagdollDef ragdollFromCharacter(const JsonValue& value, const RagdollOptions& options, std::vector<std::string>& warnings);

/// The robot in the file that the string `value` names; what of it is left out is added to `warnings`.
Robot robotFromFile(const JsonValue& value, std::vector<std::string>& warnings);

}  // namespace ragtop
