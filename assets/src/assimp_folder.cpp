#include "assimp_folder.h"

#include <assimp/MemoryIOWrapper.h>

#include <cstdint>
#include <system_error>

namespace ragtop {
namespace {

/// By its name alone: links lead where their owner wants them to.
std::filesystem::path whole(const std::filesystem::path& path) {
    std::error_code ignored;
    return std::filesystem::absolute(path, ignored).lexically_normal();
}

}  // namespace

FilesOfFolder::FilesOfFolder(const std::filesystem::path& file) : folder_(whole(file).parent_path()) {}

std::string FilesOfFolder::placeOf(const char* file) const {
    for (const std::filesystem::path& place : {std::filesystem::path(file), folder_ / file}) {
        const std::filesystem::path inside = whole(place).lexically_relative(folder_);
        if (!inside.empty() && *inside.begin() != "..") return place.string();
    }
    if (refused_.empty()) refused_ = file;
    return {};
}

bool FilesOfFolder::Exists(const char* file) const {
    const std::string place = placeOf(file);
    return !place.empty() && DefaultIOSystem::Exists(place.c_str());
}

Assimp::IOStream* FilesOfFolder::Open(const char* file, const char* mode) {
    if (!replaced_.empty() && replaced_ == file)
        return new Assimp::MemoryIOStream(reinterpret_cast<const std::uint8_t*>(content_.data()), content_.size());
    const std::string place = placeOf(file);
    return place.empty() ? nullptr : DefaultIOSystem::Open(place.c_str(), mode);
}

}  // namespace ragtop
