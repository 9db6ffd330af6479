#pragma once

#include <filesystem>
#include <fstream>

#include "ragtop/world.h"

namespace ragtop::demos {

/// Writes where every body is, once a second and at the end: one line per body, by rising time.
class PosesFile {
public:
    /// Throws AssetError when the file cannot be written.
    explicit PosesFile(const std::filesystem::path& path);
    /// Call after each step; does something when a second of the world has gone by, or it is the last step.
    void add(const World& world, bool last);

private:
    std::ofstream out_;
    double next_ = 1;  ///< s
};

}  // namespace ragtop::demos
