#pragma once

#include <string>
#include <vector>

#include "ragtop/clip.h"
#include "ragtop/ragdoll.h"

namespace ragtop::demos {

/// The clips of another character's file for the bones of this ragdoll; prints a line for each. Throws AssetError on
/// bad input, and where the file has no clips.
std::vector<Clip> borrowClips(const std::string& asset, const RagdollDef& to);

}  // namespace ragtop::demos
