#pragma once

#include <string>

namespace ragtop::demos {

/// What is in a vehicle, ragdoll, scene, character, robot or mesh file, as lines of text: units, sizes, masses, names,
/// warnings. Throws AssetError.
std::string inspect(const std::string& asset);
/// The same as JSON: of a robot every element of its file with how often it was applied and left out, of a character
/// its bones, parts and roles, of others the lines.
std::string inspectAsJson(const std::string& asset);

}  // namespace ragtop::demos
