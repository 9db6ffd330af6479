#pragma once

#include <filesystem>
#include <string_view>

namespace ragtop {

/// The path of a model that a Debian package installs, named as "assimp-testmodels:X/BCN_Epileptic.X", or one of the
/// folder of samples, "samples:characters/knight.glb"; any other text is a path itself. That folder is what the
/// environment variable RAGTOP_SAMPLES names, else `../shared/data` beside the source tree. Throws AssetError that
/// names the package to install, or the file that is missing.
std::filesystem::path findAsset(std::string_view name);

}  // namespace ragtop
