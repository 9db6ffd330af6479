#pragma once

#include <string>

namespace ragtop {

/// By its name.
bool isGltf(const std::string& file);

/// The content of a glTF file whose skins all have `inverseBindMatrices`: identities where the file has none, which is
/// what that means [Khronos, glTF 2.0, 5.28.1] and what assimp takes for granted. Empty: the file is fine as it is, or
/// is none that can be read. Throws AssetError where a skin has fewer matrices than joints.
std::string withBindMatrices(const std::string& file);

}  // namespace ragtop
