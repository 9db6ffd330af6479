#include "watch.h"

#include <algorithm>
#include <system_error>

namespace ragtop::live {
namespace {

/// The smallest time there is for a file that is not there.
std::filesystem::file_time_type writtenAt(const std::filesystem::path& file) {
    std::error_code error;
    const auto time = std::filesystem::last_write_time(file, error);
    return error ? std::filesystem::file_time_type::min() : time;
}

}  // namespace

Watch::Watch(const std::vector<std::filesystem::path>& files) {
    for (const auto& file : files) {
        const bool known =
            std::any_of(files_.begin(), files_.end(), [&](const auto& one) { return one.first == file; });
        if (!known) files_.emplace_back(file, writtenAt(file));
    }
}

std::vector<std::filesystem::path> Watch::changed() {
    std::vector<std::filesystem::path> changed;
    for (auto& [file, seen] : files_) {
        const auto now = writtenAt(file);
        if (now == seen) continue;
        seen = now;
        changed.push_back(file);
    }
    return changed;
}

}  // namespace ragtop::live
