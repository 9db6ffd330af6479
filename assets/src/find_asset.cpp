#include "ragtop/find_asset.h"

#include <array>
#include <cstdlib>
#include <string>
#include <system_error>
#include <utility>

#include "ragtop/asset_error.h"

namespace ragtop {
namespace {

/// Packages of models, and the folder each installs them in.
constexpr std::array<std::pair<std::string_view, std::string_view>, 1> kPackages{{
    {"assimp-testmodels", "/usr/share/assimp/models"},
}};

constexpr std::string_view kSamples = "samples:";

std::filesystem::path samplesFolder() {
    const char* named = std::getenv("RAGTOP_SAMPLES");
    return named ? named : RAGTOP_SAMPLES_DIR;
}

std::filesystem::path findSample(std::string_view name) {
    std::error_code ignored;
    const std::filesystem::path folder = samplesFolder(), path = folder / name.substr(kSamples.size());
    if (std::filesystem::is_regular_file(path, ignored)) return path;
    throw AssetError(std::string(name), "",
                     "no such file in " + folder.lexically_normal().string() + "; RAGTOP_SAMPLES names the folder");
}

}  // namespace

std::filesystem::path findAsset(std::string_view name) {
    if (name.starts_with(kSamples)) return findSample(name);
    std::error_code ignored;
    for (const auto& [package, folder] : kPackages) {
        if (!name.starts_with(package) || name.substr(package.size(), 1) != ":") continue;
        const std::filesystem::path root(folder);
        const std::filesystem::path path = root / name.substr(package.size() + 1);
        if (std::filesystem::is_regular_file(path, ignored)) return path;
        if (std::filesystem::is_directory(root, ignored))
            throw AssetError(std::string(name), "", "the package has no such file in " + root.string());
        throw AssetError(std::string(name), "", "not installed; apt-get install " + std::string(package));
    }
    std::filesystem::path path(name);
    if (!std::filesystem::is_regular_file(path, ignored)) throw AssetError(std::string(name), "", "no such file");
    return path;
}

}  // namespace ragtop
