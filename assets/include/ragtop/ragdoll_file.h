#pragma once

#include <filesystem>

#include "ragtop/asset_error.h"
#include "ragtop/ragdoll.h"

namespace ragtop {

/// Reads name.ragdoll.json: JSON with comments, checked against the schema of the definition. `extends` names a file
/// that this one overrides. Throws AssetError: "file:line:column: /pointer is value, must be ...".
RagdollDef loadRagdoll(const std::filesystem::path& path);
/// Writes the ragdoll of a model so that it can be edited: the fitted one to name.fitted.ragdoll.json, which is written
/// anew each time, and beside it, where there is none yet, name.ragdoll.json, which extends it and is for changes by
/// name of part. Returns the two together. Throws AssetError: cannot be written; a change of a part that is no more.
RagdollDef saveEditableRagdoll(const RagdollDef& fitted, const std::filesystem::path& path);
/// Writes a file that reads back equal, number for number. Throws AssetError when it cannot.
void saveRagdoll(const RagdollDef& def, const std::filesystem::path& path);

}  // namespace ragtop
