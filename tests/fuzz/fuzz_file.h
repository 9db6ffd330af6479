#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <fstream>

#include "support/temporary_path.h"

namespace ragtop {

/// A file with these bytes, the same one for every input.
inline std::filesystem::path fuzzFile(const char* name, const std::uint8_t* bytes, std::size_t count) {
    const std::filesystem::path path = temporaryPath(name);
    std::ofstream(path, std::ios::binary)
        .write(reinterpret_cast<const char*>(bytes), static_cast<std::streamsize>(count));
    return path;
}

}  // namespace ragtop
