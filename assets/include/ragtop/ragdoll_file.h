#pragma once

#include <filesystem>

#include "ragtop/asset_error.h"
#include "ragtop/ragdoll.h"

namespace ragtop {

/// Reads name.ragdoll.json: JSON with comments, checked against the schema of the definition. `extends` names a file
/// that this one overrides. Throws AssetError: "file:line:column: /pointer is value, must be ...".
RagdollDef loadRagdoll(const std::filesystem::path& path);
/// Writes a file that reads back equal, number for number. Throws AssetError when it cannot.
void saveRagdoll(const RagdollDef& def, const std::filesystem::path& path);

}  // namespace ragtop
