#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include "cast.h"
#include "live_tuning.h"

namespace ragtop::live {

struct SceneEntry {
    std::string name, description;
};

/// A model for pages to fetch.
struct Blob {
    std::string name{};  ///< under /visual/; others have other names, so that pages may keep it
    std::vector<std::byte> bytes{};
};

class Stage;

/// What became of files that changed on disk.
struct Reload {
    struct File {
        std::string path;
        bool ok = true;
        std::string message;
    };
    std::vector<File> files{};         ///< empty: none has changed
    std::vector<TunedValue> values{};  ///< that run on with other values
    std::unique_ptr<Stage> anew{};     ///< or, where more than values has changed, the scene from its beginning
};

/// Where a cast comes from: scene files, or a program's own world.
class Stage {
public:
    virtual ~Stage() = default;
    virtual Cast& cast() = 0;
    virtual Tuning& tuning() = 0;
    virtual const std::vector<Blob>& blobs() const;
    /// The same anew, as it is tuned; null where only the world's first state can be restored. Throws AssetError.
    virtual std::unique_ptr<Stage> restarted() { return nullptr; }
    /// Those that `opened` takes.
    virtual std::vector<SceneEntry> scenes() const { return {}; }
    /// Another scene of the list. Throws AssetError.
    virtual std::unique_ptr<Stage> opened(const std::string& scene);
    /// Reads files again that have changed since the last call; what is wrong with them leaves everything as it is.
    virtual Reload reload() { return {}; }
    /// Writes what is tuned and returns the file. Throws AssetError.
    virtual std::string saveTuning(const std::string& name);
    /// All values with a saved tuning. Throws AssetError.
    virtual std::vector<TunedValue> savedTuning(const std::string& name);
};

}  // namespace ragtop::live
