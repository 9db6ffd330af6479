#pragma once

#include <assimp/DefaultIOSystem.h>

#include <filesystem>
#include <string>
#include <utility>

namespace ragtop {

/// Lets a file that is imported read what lies in its folder, and nothing else: names in a file come from strangers.
class FilesOfFolder : public Assimp::DefaultIOSystem {
public:
    explicit FilesOfFolder(const std::filesystem::path& file);

    bool Exists(const char* file) const override;
    Assimp::IOStream* Open(const char* file, const char* mode) override;

    /// Lets a file have another content.
    void replace(const std::string& file, std::string content) {
        replaced_ = file;
        content_ = std::move(content);
    }

    /// The first file outside of the folder that was asked for; empty: none was.
    const std::string& refused() const { return refused_; }

private:
    /// Where a name in the file leads; empty: out of the folder.
    std::string placeOf(const char* file) const;

    std::filesystem::path folder_;
    mutable std::string refused_;
    std::string replaced_, content_;
};

}  // namespace ragtop
