#pragma once

#include <filesystem>

#include "recording_tracks.h"

namespace ragtop {

/// Throws AssetError when the file cannot be written.
void writeGltf(const RecordedScene& scene, const std::filesystem::path& path);

}  // namespace ragtop
