#include "run.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <fstream>
#include <iterator>
#include <map>
#include <utility>

#include "measure.h"
#include "poses.h"
#include "progress.h"
#include "ragtop/recording.h"
#include "ragtop/start_overlaps.h"
#include "ragtop/tasks.h"
#include "ragtop/world.h"
#include "serve/look.h"
#include "summary.h"
#include "telemetry.h"

namespace ragtop::demos {
namespace {

namespace fs = std::filesystem;

class SceneRun {
public:
    explicit SceneRun(const RunOptions& options)
        : options_(options),
          scene_(loadScene(findScene(options.scene), options.overrides)),
          world_(scene_.settings, config(options, scene_)),
          instance_(scene_, world_),
          times_(scene_.step) {
        summary_.warnings = scene_.warnings;
        for (std::string& line : startOverlaps(scene_)) summary_.warnings.push_back(std::move(line));
        for (const std::string& warning : summary_.warnings) fmt::print(stderr, "warning: {}\n", warning);
        last_ = options.steps.value_or(
            static_cast<std::uint64_t>(std::llround(options.seconds.value_or(scene_.duration) / scene_.step)));
    }

    void go() {
        if (options_.restore) restore(*options_.restore);
        if (world_.stepCount() > last_) {
            throw AssetError(fmt::format("--restore {}: is at step {}, must be at most the last step, {}",
                                         *options_.restore, world_.stepCount(), last_));
        }
        prepareOutput();
        if (options_.poses) poses_.emplace(*options_.poses);
        Progress progress(last_);
        while (world_.stepCount() < last_) {
            step();
            progress.show(world_.stepCount(), lastMs_);
        }
        finish();
    }

private:
    static WorldConfig config(const RunOptions& options, const Scene& scene) {
        WorldConfig config;
        if (options.threads > 1) config.tasks = tbbTasks(options.threads);
        config.lanes = options.lanes;
        config.expectedBodies = static_cast<int>(scene.bodies.size());
        return config;
    }

    void prepareOutput() {
        if (!options_.out) return;
        std::error_code error;
        fs::create_directories(*options_.out, error);
        if (error) throw AssetError(*options_.out + ": is no folder and cannot be made one: " + error.message());
        telemetry_.emplace(fs::path(*options_.out) / "telemetry.csv", scene_, instance_);
        recording_.emplace(world_);
        if (!scene_.cloths.empty()) {
            summary_.warnings.push_back(
                fmt::format("recording.glb has bodies alone: {} cloths are left out", scene_.cloths.size()));
            fmt::print(stderr, "warning: {}\n", summary_.warnings.back());
        }
        for (const auto& [body, look] : live::looksOf(scene_, instance_)) {
            if (!look.name.empty()) recording_->name(body, look.name);
            if (look.color) recording_->paint(body, *look.color);
        }
    }

    void step() {
        instance_.drive(world_.time());
        const auto start = std::chrono::steady_clock::now();
        world_.step(scene_.step);
        lastMs_ = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
        observe();
        if (options_.saveAt == world_.stepCount()) save();
    }

    void observe() {
        times_.add(lastMs_);
        const StepStats stats = world_.stats();
        for (const StepStats::Stage& stage : stats.stages) {
            const auto known =
                std::find_if(stages_.begin(), stages_.end(), [&](const auto& s) { return s.first == stage.name; });
            if (known == stages_.end())
                stages_.emplace_back(stage.name, stage.ms);
            else
                known->second += stage.ms;
        }
        ++observed_;
        summary_.finite = summary_.finite && allFinite(world_) && allFinite(instance_);
        summary_.maxSpeed = std::max(summary_.maxSpeed, largestSpeed(world_));
        summary_.jointGapMax = std::max(summary_.jointGapMax, largestJointGap(world_));
        if (telemetry_) telemetry_->add(world_, instance_, lastMs_);
        if (recording_) recording_->capture();
        if (poses_) poses_->add(world_, world_.stepCount() == last_);
    }

    void save() const {
        const fs::path path = fs::path(options_.out.value_or(".")) / fmt::format("state_{}.bin", world_.stepCount());
        std::vector<std::byte> state(world_.saveSize());
        state.resize(world_.save(state));
        std::ofstream file(path, std::ios::binary);
        file.write(reinterpret_cast<const char*>(state.data()), static_cast<std::streamsize>(state.size()));
        if (!file.flush()) throw AssetError(path.string() + ": cannot be written");
    }

    void restore(const std::string& path) {
        std::ifstream file(path, std::ios::binary);
        if (!file || !fs::is_regular_file(path)) throw AssetError(path + ": no such file");
        const std::vector<char> bytes{std::istreambuf_iterator<char>(file), {}};
        try {
            world_.restore(std::as_bytes(std::span(bytes)));
        } catch (const std::invalid_argument& error) {
            throw AssetError(path + ": is no state of this scene: " + error.what());
        }
    }

    void finish() {
        summary_.hash = world_.hash();
        summary_.steps = world_.stepCount();
        summary_.realTimeFactor = times_.realTimeFactor();
        summary_.realTimeFactorMin = times_.worstSecond();
        summary_.msPerStep.emplace_back("total", times_.meanMs());
        for (const auto& [name, ms] : stages_)
            summary_.msPerStep.emplace_back(name, ms / static_cast<double>(observed_));
        summary_.contacts = world_.stats().contacts;
        summary_.finite = summary_.finite && allFinite(world_);
        if (summary_.finite) {
            const auto depths = overlaps(world_, scene_, instance_);
            summary_.penetrationMax = depths.empty() ? 0 : depths.back();
            summary_.penetrationP99 = quantile(depths, 0.99);
        }
        summary_.movedMax = largestDisplacement(world_, scene_, instance_);
        summary_.energy = world_.energy();
        const std::string json = toJson(summary_);
        fmt::print("{}", json);
        if (!options_.out) return;
        const fs::path path = fs::path(*options_.out) / "summary.json";
        std::ofstream file(path);
        file << json;
        if (!file.flush()) throw AssetError(path.string() + ": cannot be written");
        recording_->write(fs::path(*options_.out) / "recording.glb");
    }

    const RunOptions& options_;
    Scene scene_;
    World world_;
    SceneInstance instance_;
    StepTimes times_;
    Summary summary_;
    std::uint64_t last_ = 0, observed_ = 0;
    double lastMs_ = 0;
    std::vector<std::pair<std::string, double>> stages_;
    std::optional<Telemetry> telemetry_;
    std::optional<Recording> recording_;
    std::optional<PosesFile> poses_;
};

}  // namespace

void run(const RunOptions& options) { SceneRun(options).go(); }

}  // namespace ragtop::demos
