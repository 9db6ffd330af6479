#include "ragtop/data_folder.h"

#include <dlfcn.h>

#include <cstdlib>
#include <string>
#include <vector>

#include "ragtop/asset_error.h"

namespace ragtop {
namespace {

namespace fs = std::filesystem;

// Read at run time, so that whatever the optimiser does they are strings in the library: the test of a moved
// installation finds them there and writes others over them.
const char* volatile sources = RAGTOP_DATA_SOURCE_DIR;
const char* volatile installation = RAGTOP_DATA_INSTALL_DIR;

bool holdsData(const fs::path& folder) {
    std::error_code error;
    return fs::is_directory(folder / "scenes", error);
}

/// Empty unless this code is in a shared library. Of a program the linker knows but the name it was called by.
fs::path ownLibrary() {
    static const char here = 0;
    Dl_info info{};
    if (dladdr(&here, &info) == 0 || !info.dli_fname) return {};
    fs::path file(info.dli_fname);
    return file.is_absolute() ? file : fs::path{};
}

/// Of an installation, by what is installed beside the data.
std::vector<fs::path> foldersOfInstallation() {
    std::vector<fs::path> folders;
    const auto add = [&](const fs::path& file, const char* fromThere) {
        std::error_code error;
        const fs::path real = fs::canonical(file, error);
        if (!error) folders.push_back((real.parent_path() / fromThere).lexically_normal());
    };
    add("/proc/self/exe", RAGTOP_DATA_FROM_BIN);
    if (const fs::path library = ownLibrary(); !library.empty()) add(library, RAGTOP_DATA_FROM_LIB);
    return folders;
}

}  // namespace

fs::path dataFolder() {
    if (const char* named = std::getenv("RAGTOP_DATA")) {
        if (holdsData(named)) return named;
        throw AssetError("RAGTOP_DATA is \"" + std::string(named) + "\", must be a folder with scenes in it");
    }
    std::vector<fs::path> folders = foldersOfInstallation();
    folders.insert(folders.end(), {sources, installation});
    std::string message = "there are no shipped scenes: install them, or let RAGTOP_DATA name their folder; looked for";
    for (const fs::path& folder : folders) {
        if (holdsData(folder)) return folder;
        message += (&folder == folders.data() ? " " : ", ") + (folder / "scenes").string();
    }
    throw AssetError(message);
}

}  // namespace ragtop
