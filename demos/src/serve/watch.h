#pragma once

#include <filesystem>
#include <utility>
#include <vector>

namespace ragtop::live {

/// Tells which of some files have changed.
class Watch {
public:
    explicit Watch(const std::vector<std::filesystem::path>& files);
    /// Those written, gone or back since the last call.
    std::vector<std::filesystem::path> changed();

private:
    std::vector<std::pair<std::filesystem::path, std::filesystem::file_time_type>> files_;
};

}  // namespace ragtop::live
