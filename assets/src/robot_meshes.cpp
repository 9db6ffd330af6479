#include "robot_meshes.h"

#include <algorithm>
#include <string_view>
#include <system_error>

namespace ragtop {
namespace {

namespace fs = std::filesystem;

constexpr int kPackageLevels = 4;  // from the description's folder up, in which a package is sought

fs::path wholeOf(const fs::path& path) {
    std::error_code ignored;
    return fs::absolute(path, ignored).lexically_normal();
}

/// By its name alone, as importers of models do.
bool isWithin(const fs::path& folder, const fs::path& file) {
    const fs::path inside = wholeOf(file).lexically_relative(wholeOf(folder));
    return !inside.empty() && *inside.begin() != "..";
}

class MeshSearch {
public:
    /// What is at a name in a folder, unless that leads out of `within`.
    void look(const fs::path& folder, const fs::path& name, const fs::path& within) {
        if (!found.file.empty()) return;
        std::error_code ignored;
        const fs::path place = folder / name;
        if (!isWithin(within, place))
            found.isOutside = true;
        else if (fs::is_regular_file(place, ignored))
            found.file = place;
    }

    RobotMeshFile found;
};

}  // namespace

RobotMeshFile findRobotMesh(const std::string& name, const fs::path& description,
                            const std::vector<fs::path>& packageRoots) {
    constexpr std::string_view kPackage = "package://", kFile = "file://";
    fs::path folder = wholeOf(description).parent_path();
    MeshSearch search;
    if (!name.starts_with(kPackage)) {
        const fs::path own = name.starts_with(kFile) ? name.substr(kFile.size()) : name;
        for (const fs::path& root : packageRoots)
            if (own.is_absolute()) search.look(root, own, root);
        search.look(folder, own, folder.parent_path());
        return search.found;
    }
    const std::string withName = name.substr(kPackage.size());
    const std::string rest = withName.substr(std::min(withName.find('/') + 1, withName.size()));
    for (const fs::path& root : packageRoots) {
        search.look(root, withName, root);
        search.look(root, rest, root);
    }
    for (int level = 0; level < kPackageLevels; ++level, folder = folder.parent_path())
        search.look(folder, rest, folder);
    return search.found;
}

}  // namespace ragtop
