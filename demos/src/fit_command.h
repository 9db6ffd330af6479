#pragma once

#include <optional>
#include <string>

#include "ragtop/decomposition.h"

namespace ragtop::demos {

struct FitCommand {
    std::string asset;
    DecompositionOptions limits;
    float simplify = 0;              ///< m; above zero the mesh is made simpler first
    int threads = 1;                 ///< that work
    bool json = false;               ///< prints JSON, with the vertices of all pieces
    std::optional<std::string> out;  ///< OBJ file of the pieces, an object each
};

/// Takes a closed mesh apart into convex pieces and tells how well they fit; false when they do not keep to the limits.
/// Throws AssetError on bad input.
bool fit(const FitCommand& command);

}  // namespace ragtop::demos
