#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "ragtop/asset_error.h"
#include "ragtop/vehicle_def.h"

namespace ragtop {

/// A tire that was measured.
struct TireFile {
    TireDef tire{};                      ///< with a magicFormula
    std::vector<std::string> leftOut{};  ///< numbers of the file that say something that is not modelled, by name
};

/// Reads a tire property file (name.tir) of the Magic Formula 5.2, PAC2002, 6.1 or 6.2, in m, N, rad, kg and s. What it
/// does not mention is 0, and scales are 1. Stiffness, relaxation length and rolling resistance are those at the
/// nominal load. Throws AssetError with "file:line: NAME is value, must be ..." for each mistake.
TireFile loadTire(const std::filesystem::path& path);

}  // namespace ragtop
