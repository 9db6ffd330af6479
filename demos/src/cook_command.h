#pragma once

#include <string>
#include <vector>

#include "ragtop/decomposition.h"

namespace ragtop::demos {

struct CookCommand {
    std::string asset, out;
    std::vector<std::string> clips;  ///< other characters whose clips it gets as well
    float simplify = 0;              ///< m; above zero a mesh is made simpler first
    bool pieces = false;             ///< a mesh gets convex pieces as well
    DecompositionOptions limits;     ///< of those
};

/// Writes the cooked file of a character with its clips and ragdoll, of a ragdoll file, or of a mesh, and tells what is
/// in it. Throws AssetError on bad input.
void cookAsset(const CookCommand& command);

}  // namespace ragtop::demos
