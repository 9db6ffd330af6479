#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include "ragtop/asset_error.h"
#include "ragtop/debug_draw.h"
#include "ragtop/id.h"
#include "ragtop/math.h"

namespace ragtop {

class World;

struct RecordingOptions {
    int every = 2;     ///< keeps one of so many captures; 60 steps a second give 30 frames a second
    DVec3 origin{};    ///< m; the file's origin. glTF has floats: put it near the action of a scene far away
};

/// Writes what happens in a world as an animated glTF file, one node per body. Bodies that come and go have no size
/// before and after; those that never move cost no animation. The world must outlive the last capture.
class Recording {
public:
    /// Keeps the world as it is now as the first frame.
    explicit Recording(const World& world, const RecordingOptions& options = {});
    ~Recording();
    Recording(Recording&&) noexcept;
    Recording& operator=(Recording&&) noexcept;

    /// Name and colour of a body in the file; otherwise they follow from its type.
    void name(BodyId body, std::string name);
    void paint(BodyId body, Color color);

    /// Call after each step.
    void capture();
    int frames() const;
    /// Writes binary glTF. Throws AssetError when it cannot.
    void write(const std::filesystem::path& path) const;

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace ragtop
