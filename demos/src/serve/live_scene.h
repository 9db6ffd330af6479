#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "ragtop/scene.h"
#include "ragtop/world.h"
#include "stage.h"
#include "watch.h"

namespace ragtop::live {

struct LiveSceneOptions {
    std::filesystem::path own{};               ///< a scene that is listed beside the shipped ones
    std::vector<SceneOverride> overrides{};    ///< of every scene that is opened
    std::filesystem::path tunings = "tuning";  ///< folder of saved tunings
    bool visuals = true;                       ///< cook models to look at
    int threads = 1;
    int lanes = 0;
};

/// A scene file in a world.
class LiveScene : public Stage {
public:
    /// A name of a shipped scene, or a file. Throws AssetError.
    LiveScene(const std::string& nameOrPath, const LiveSceneOptions& options);

    Cast& cast() override { return cast_; }
    Tuning& tuning() override { return tuning_; }
    const std::vector<Blob>& blobs() const override { return looks_->blobs; }
    std::unique_ptr<Stage> restarted() override;
    std::vector<SceneEntry> scenes() const override;
    std::unique_ptr<Stage> opened(const std::string& scene) override;
    Reload reload() override;
    std::string saveTuning(const std::string& name) override;
    std::vector<TunedValue> savedTuning(const std::string& name) override;

private:
    /// Models cooked for a scene, and what is said about them; they outlive restarts.
    struct Looks {
        std::vector<Blob> blobs;
        std::vector<CastVisual> visuals;
        std::vector<std::string> warnings;
    };
    struct Loaded {
        std::filesystem::path path;
        Scene inFiles, tuned;
        std::shared_ptr<const Looks> looks;
    };
    LiveScene(Loaded loaded, const LiveSceneOptions& options);

    static Loaded load(const std::filesystem::path& path, const LiveSceneOptions& options);
    static Looks cook(const Scene& scene);
    std::filesystem::path tuningFile(const std::string& name) const;
    void fillCast(const Scene& scene);

    std::filesystem::path path_;
    LiveSceneOptions options_;
    Scene inFiles_;
    std::shared_ptr<const Looks> looks_;
    World world_;
    SceneInstance instance_;
    Tuning tuning_;
    Cast cast_;
    Watch watch_;
};

}  // namespace ragtop::live
