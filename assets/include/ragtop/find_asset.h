#pragma once

#include <filesystem>
#include <string_view>

namespace ragtop {

/// The path of a model that a Debian package installs, named as "assimp-testmodels:X/BCN_Epileptic.X"; any other
/// text is a path itself. Throws AssetError that names the package to install, or the file that is missing.
std::filesystem::path findAsset(std::string_view name);

}  // namespace ragtop
