#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>
#include <span>

namespace ragtop {

/// A file in memory, aligned to a page.
struct MappedFile {
    std::span<const std::byte> bytes;
    std::shared_ptr<const void> owner;  ///< keeps it there
};

/// Maps a file, or reads it where files cannot be mapped. Throws CookedError.
MappedFile mapFile(const std::filesystem::path& path);

}  // namespace ragtop
