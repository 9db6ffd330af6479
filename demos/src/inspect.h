#pragma once

#include <string>

namespace ragtop::demos {

/// What is in a vehicle, ragdoll, scene, character, robot or mesh file, as lines of text: units, sizes, masses, names,
/// warnings. Throws AssetError.
std::string inspect(const std::string& asset);

}  // namespace ragtop::demos
