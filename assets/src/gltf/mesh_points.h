#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "ragtop/math.h"

namespace ragtop {

/// The vertices of the mesh of that index; throws AssetError where it has none that can be read.
using MeshPoints = std::function<std::vector<Vec3>(int mesh)>;

/// Reads them from a glTF file, its buffers from its folder alone, when the first mesh is asked for. For a process that
/// may end: the library trusts its input.
MeshPoints meshPointsOf(const std::filesystem::path& file);

}  // namespace ragtop
