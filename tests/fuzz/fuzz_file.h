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

/// Links of a URDF whose joints form a loop hold each other in the library, which ends with the process that robots are
/// read in. A fuzzer has one source, so this is defined once.
extern "C" const char* __lsan_default_suppressions() { return "leak:liburdfdom_model"; }
