#pragma once

#include <chrono>
#include <filesystem>
#include <functional>

#include "byte_stream.h"

namespace ragtop {

/// What a file may take to be read.
inline constexpr std::chrono::seconds kImportTime(15);

/// Calls `write` in a process of its own, which imports the file and writes what it has in it, then `read` here with
/// those bytes. An AssetError of `write` is thrown here. Throws AssetError too where there is no such file, and where
/// the process crashes, takes too much time or memory, or writes something else than `read` reads.
void importInChild(const std::filesystem::path& path, const std::function<void(ByteWriter&)>& write,
                   const std::function<void(ByteReader&)>& read, std::chrono::milliseconds timeout = kImportTime);

}  // namespace ragtop
