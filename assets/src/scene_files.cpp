#include <algorithm>

#include "described_file.h"
#include "ragtop/scene.h"
#include "schema.h"

namespace ragtop {
namespace {

namespace fs = std::filesystem;

/// The source tree's data while it exists, else the installed one.
fs::path sceneFolder() {
    std::error_code error;
    for (const char* data : {RAGTOP_DATA_SOURCE_DIR, RAGTOP_DATA_INSTALL_DIR}) {
        if (fs::path folder = fs::path(data) / "scenes"; fs::is_directory(folder, error)) return folder;
    }
    return fs::path(RAGTOP_DATA_INSTALL_DIR) / "scenes";
}

}  // namespace

std::vector<std::string> shippedScenes() {
    std::vector<std::string> names;
    std::error_code error;
    for (const auto& entry : fs::directory_iterator(sceneFolder(), error)) {
        if (entry.path().extension() == ".json") names.push_back(entry.path().stem().string());
    }
    std::sort(names.begin(), names.end());
    return names;
}

std::string sceneDescription(const fs::path& path) {
    try {
        const JsonDocument document = loadExtended(path);
        const Json& root = document.root();
        return root.is_object() ? root.value("description", "") : "";
    } catch (const std::exception&) {
        return "";
    }
}

fs::path findScene(std::string_view nameOrPath) {
    std::error_code error;
    const fs::path path(nameOrPath);
    if (fs::is_regular_file(path, error)) return path;
    const auto names = shippedScenes();
    if (std::find(names.begin(), names.end(), nameOrPath) != names.end()) {
        return sceneFolder() / (std::string(nameOrPath) + ".json");
    }
    std::string message = std::string(nameOrPath) + ": no such scene, must be a file or one of";
    for (const std::string& name : names) message += (&name == names.data() ? " " : ", ") + name;
    if (const std::string near = nearestName(std::string(nameOrPath), names); !near.empty()) {
        message += "; did you mean \"" + near + "\"?";
    }
    throw AssetError(message);
}

}  // namespace ragtop
