#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "ragtop/scene.h"

namespace ragtop::demos {

struct RunOptions {
    std::string scene;                     ///< name or file
    std::optional<double> seconds;         ///< instead of the scene's duration
    std::optional<std::uint64_t> steps;    ///< instead of both
    int threads = 1;
    int lanes = 0;
    std::vector<SceneOverride> overrides;
    std::optional<std::uint64_t> saveAt;   ///< step after which the state is written
    std::optional<std::string> restore;    ///< file of a state to go on from
    std::optional<std::string> out;        ///< folder for recording, telemetry, summary and state
    std::optional<std::string> poses;      ///< file of the poses of all bodies, once a second
};

/// Runs a scene and prints its summary. Throws AssetError on bad input.
void run(const RunOptions& options);

}  // namespace ragtop::demos
