#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>

#include "live_scene.h"

namespace ragtop::live {

struct ServeSceneOptions {
    std::string scene = "crash";  ///< name or file
    int port = 8080;              ///< 0: any free one
    std::optional<std::filesystem::path> page{};
    LiveSceneOptions world{};
    bool playing = true;
};

/// Serves scenes until `stop` says so. Throws AssetError on a bad scene, std::runtime_error on a taken port.
void serveScene(const ServeSceneOptions& options, const std::function<bool()>& stop);

}  // namespace ragtop::live
