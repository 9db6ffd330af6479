#pragma once

#include <filesystem>

namespace ragtop {

/// The folder of what is shipped: `scenes`, `vehicles`, `ragdolls`, `manoeuvres` and, where it has been installed, `page`.
/// It is the first of these:
///   - what the environment variable RAGTOP_DATA names, if it is set;
///   - that of the installation which the running program or the shared library is part of, wherever it has been moved;
///   - the source tree's, for what runs from a build tree;
///   - that of the prefix that the build was configured for.
/// Throws AssetError, which names the folders tried, when none of them is there.
std::filesystem::path dataFolder();

}  // namespace ragtop
