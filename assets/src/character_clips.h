#pragma once

#include <vector>

#include "character_import.h"
#include "ragtop/clip.h"

namespace ragtop {

/// The clips of a file for the bones of its character, in metres with Y up. What a clip does to nodes between two bones
/// is part of what the lower one does; what scales it is left out, and added to the character's warnings.
std::vector<Clip> makeClips(ImportedCharacter& imported);

}  // namespace ragtop
