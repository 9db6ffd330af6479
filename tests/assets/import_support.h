#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <string>

#include "ragtop/asset_error.h"
#include "ragtop/find_asset.h"
#include "support/temporary_path.h"

namespace ragtop {

/// A file of the shared samples; the test is skipped where they are absent.
#define RAGTOP_SAMPLE(variable, name)                                                                \
    const std::filesystem::path variable = std::filesystem::path(RAGTOP_SHARED_DIR) / "data" / name; \
    if (!std::filesystem::exists(variable)) GTEST_SKIP() << "no sample " << variable

/// A file of Debian's assimp-testmodels; the test is skipped where the package is not installed.
#define RAGTOP_MODEL(variable, name)                     \
    std::filesystem::path variable;                      \
    try {                                                \
        variable = findAsset("assimp-testmodels:" name); \
    } catch (const AssetError& missing) {                \
        GTEST_SKIP() << missing.what();                  \
    }                                                    \
    static_assert(true)

/// Does what was read, which has a list of warnings, warn with the word in some of them?
template <class Read>
bool warns(const Read& read, const std::string& word) {
    return std::any_of(read.warnings.begin(), read.warnings.end(),
                       [&](const std::string& warning) { return warning.find(word) != std::string::npos; });
}

/// What an AssetError says; empty when there was none. It has to be one line that begins with the file.
inline std::string importError(const std::filesystem::path& file, const std::function<void()>& load) {
    try {
        load();
    } catch (const AssetError& error) {
        const std::string text = error.what();
        EXPECT_EQ(text.find('\n'), std::string::npos) << text;
        EXPECT_EQ(text.find(file.string()), 0u) << text;
        return text;
    }
    return {};
}

/// A file that lives as long as the test.
class TemporaryFile {
public:
    TemporaryFile(const std::string& name, const std::string& content)
        : path_(temporaryPath(name)) {
        std::ofstream(path_, std::ios::binary) << content;
    }
    ~TemporaryFile() {
        std::error_code ignored;
        std::filesystem::remove(path_, ignored);
    }
    TemporaryFile(const TemporaryFile&) = delete;
    TemporaryFile& operator=(const TemporaryFile&) = delete;
    const std::filesystem::path& path() const { return path_; }

private:
    std::filesystem::path path_;
};

}  // namespace ragtop
