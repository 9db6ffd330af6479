#include <algorithm>

#include "described_file.h"
#include "ragtop/data_folder.h"
#include "ragtop/scene.h"
#include "schema.h"

namespace ragtop {

namespace fs = std::filesystem;

std::vector<std::string> shippedScenes() {
    std::vector<std::string> names;
    try {
        for (const auto& entry : fs::directory_iterator(dataFolder() / "scenes")) {
            if (entry.path().extension() == ".json") names.push_back(entry.path().stem().string());
        }
    } catch (const AssetError&) {
        return {};
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
    const fs::path data = dataFolder();
    const auto names = shippedScenes();
    if (std::find(names.begin(), names.end(), nameOrPath) != names.end()) {
        return data / "scenes" / (std::string(nameOrPath) + ".json");
    }
    std::string message = std::string(nameOrPath) + ": no such scene, must be a file or one of";
    for (const std::string& name : names) message += (&name == names.data() ? " " : ", ") + name;
    if (const std::string near = nearestName(std::string(nameOrPath), names); !near.empty()) {
        message += "; did you mean \"" + near + "\"?";
    }
    throw AssetError(message);
}

}  // namespace ragtop
