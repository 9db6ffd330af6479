#pragma once

#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>
#include <system_error>

/// A folder of this process that goes away with it, whatever is in it then.
class TemporaryOfProcess {
public:
    TemporaryOfProcess() {
        path = (std::filesystem::temp_directory_path() / "ragtop_XXXXXX").string();
        if (!mkdtemp(path.data())) throw std::runtime_error(path + ": cannot be made");
    }
    ~TemporaryOfProcess() {
        std::error_code ignored;
        // Children that were forked off end too, and leave it be.
        if (getpid() == owner_) std::filesystem::remove_all(path, ignored);
    }
    TemporaryOfProcess(const TemporaryOfProcess&) = delete;
    TemporaryOfProcess& operator=(const TemporaryOfProcess&) = delete;

    std::string path;

private:
    const pid_t owner_ = getpid();
};

/// A path for a file or folder of one test: tests run at once, each in a process of its own. Nobody needs to remove it.
inline std::filesystem::path temporaryPath(const std::string& name) {
    static const TemporaryOfProcess folder;
    return std::filesystem::path(folder.path) / name;
}

/// A file of one test with this text.
inline std::filesystem::path fileWith(const std::string& name, const std::string& text) {
    const auto path = temporaryPath(name);
    std::ofstream(path) << text;
    return path;
}
