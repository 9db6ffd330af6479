#pragma once

#include <string>

#include "ragtop/character.h"

namespace ragtop::demos {

/// What a character was taken for, as a JSON object: plan, roles with how sure they are, bones, parts and warnings.
std::string bodyJson(const Character& character, const Anatomy& anatomy, const RagdollDef& ragdoll);

}  // namespace ragtop::demos
