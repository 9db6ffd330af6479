#include "live_scene.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <map>
#include <utility>

#include "look.h"
#include "ragtop/start_overlaps.h"
#include "ragtop/visual.h"

namespace ragtop::live {
namespace {

WorldConfig configOf(const LiveSceneOptions& options, const Scene& scene) {
    WorldConfig config;
    if (options.threads > 1) config.tasks = tbbTasks(options.threads);
    config.lanes = options.lanes;
    config.expectedBodies = static_cast<int>(scene.bodies.size());
    return config;
}

RunningScene running(World& world, SceneInstance& instance) {
    RunningScene scene{&world, instance.bodies, instance.joints, {}, {}, {}, {}};
    for (Vehicle& vehicle : instance.vehicles) scene.vehicles.push_back(&vehicle);
    for (Ragdoll& ragdoll : instance.ragdolls) scene.ragdolls.push_back(&ragdoll);
    for (const RobotIds& robot : instance.robots) scene.robots.push_back(&robot);
    for (Cloth& cloth : instance.cloths) scene.cloths.push_back(&cloth);
    return scene;
}

std::map<std::string, int> namesOf(const Visual& visual) {
    std::map<std::string, int> names;
    for (const VisualNode& node : visual.nodes) names[node.name] = node.index;
    return names;
}

/// By its content [Fowler, Noll, Vo, FNV-1a].
std::string nameOf(const std::string& kind, const std::vector<std::byte>& bytes) {
    std::uint64_t hash = 14695981039346656037ull;
    for (const std::byte byte : bytes) hash = (hash ^ static_cast<std::uint64_t>(byte)) * 1099511628211ull;
    return fmt::format("{}_{:016x}.glb", kind, hash);
}

}  // namespace

LiveScene::LiveScene(const std::string& nameOrPath, const LiveSceneOptions& options)
    : LiveScene(load(findScene(nameOrPath), options), options) {
    if (nameOrPath != inFiles_.name) options_.own = path_;
}

LiveScene::Loaded LiveScene::load(const std::filesystem::path& path, const LiveSceneOptions& options) {
    const Scene scene = loadScene(path, options.overrides);
    return {path, scene, scene, std::make_shared<const Looks>(options.visuals ? cook(scene) : Looks{})};
}

LiveScene::LiveScene(Loaded loaded, const LiveSceneOptions& options)
    : path_(std::move(loaded.path)),
      options_(options),
      inFiles_(std::move(loaded.inFiles)),
      looks_(std::move(loaded.looks)),
      world_(loaded.tuned.settings, configOf(options, loaded.tuned)),
      instance_(loaded.tuned, world_),
      tuning_(loaded.tuned, inFiles_, running(world_, instance_)),
      watch_(inFiles_.files) {
    fillCast(loaded.tuned);
}

void LiveScene::fillCast(const Scene& scene) {
    cast_.world = &world_;
    cast_.step = scene.step;
    cast_.name = scene.name;
    cast_.description = scene.description;
    cast_.warnings = scene.warnings;
    for (std::string& line : startOverlaps(scene)) cast_.warnings.push_back(std::move(line));
    cast_.warnings.insert(cast_.warnings.end(), looks_->warnings.begin(), looks_->warnings.end());
    if (scene.camera) cast_.camera = CastCamera{scene.camera->target, scene.camera->eye};
    for (std::size_t i = 0; i < instance_.vehicles.size(); ++i) {
        cast_.vehicles.push_back({scene.vehicles[i].name, &instance_.vehicles[i], scene.vehicles[i].placement});
    }
    for (std::size_t i = 0; i < instance_.ragdolls.size(); ++i) {
        cast_.ragdolls.push_back({scene.ragdolls[i].name, &instance_.ragdolls[i]});
    }
    for (std::size_t i = 0; i < instance_.cloths.size(); ++i)
        cast_.cloths.push_back({scene.cloths[i].name, &instance_.cloths[i], scene.cloths[i].color});
    for (const SceneRoad& road : scene.roads) cast_.roads.push_back({road.name, road.closed, road.width, road.line});
    cast_.visuals = looks_->visuals;
    cast_.look = [looks = looksOf(scene, instance_)](BodyId body) {
        const auto found = looks.find(body);
        return found == looks.end() ? Look{} : found->second;
    };
    cast_.beforeStep = [this](const std::vector<bool>& driven) {
        for (std::size_t i = 0; i < driven.size(); ++i) instance_.scripted[i] = !driven[i];
        instance_.drive(world_.time());
    };
}

/// One model per definition. What cannot be cooked is drawn by its shapes.
LiveScene::Looks LiveScene::cook(const Scene& scene) {
    Looks looks;
    std::map<const RagdollDef*, std::pair<std::string, std::map<std::string, int>>> skins;
    const auto attempt = [&](auto&& make) {
        try {
            make();
        } catch (const std::exception& error) {
            looks.warnings.push_back(std::string("its shapes are drawn: ") + error.what());
        }
    };
    const auto keep = [&](const std::string& kind, Visual visual) {
        looks.warnings.insert(looks.warnings.end(), visual.warnings.begin(), visual.warnings.end());
        looks.blobs.push_back({nameOf(kind, visual.glb), std::move(visual.glb)});
        return looks.blobs.back().name;
    };
    for (std::size_t i = 0; i < scene.ragdolls.size(); ++i) {
        const SceneRagdoll& ragdoll = scene.ragdolls[i];
        if (ragdoll.character.empty()) continue;
        const auto [skin, isNew] = skins.try_emplace(ragdoll.def.get());
        if (isNew) {
            attempt([&, &cooked = skin->second] {
                Visual visual = cookSkin(ragdoll.character, *ragdoll.def);
                auto nodes = namesOf(visual);
                cooked = {keep("skin", std::move(visual)), std::move(nodes)};
            });
        }
        if (skin->second.first.empty()) continue;
        looks.visuals.push_back({CastVisual::Kind::skin, skin->second.first, i, skin->second.second});
    }
    for (std::size_t i = 0; i < scene.vehicles.size(); ++i) {
        if (!scene.vehicles[i].def.visual) continue;
        attempt([&] {
            Visual visual = cookCar(scene.vehicles[i].def);
            auto nodes = namesOf(visual);
            looks.visuals.push_back({CastVisual::Kind::car, keep("car", std::move(visual)), i, std::move(nodes)});
        });
    }
    return looks;
}

std::unique_ptr<Stage> LiveScene::restarted() {
    return std::unique_ptr<Stage>(new LiveScene({path_, inFiles_, tuning_.scene(), looks_}, options_));
}

std::vector<SceneEntry> LiveScene::scenes() const {
    std::vector<SceneEntry> entries;
    if (!options_.own.empty()) entries.push_back({options_.own.stem().string(), sceneDescription(options_.own)});
    for (const std::string& name : shippedScenes()) entries.push_back({name, sceneDescription(findScene(name))});
    return entries;
}

std::unique_ptr<Stage> LiveScene::opened(const std::string& scene) {
    const auto open = [&](const std::filesystem::path& path) {
        return std::unique_ptr<Stage>(new LiveScene(load(path, options_), options_));
    };
    if (!options_.own.empty() && scene == options_.own.stem()) return open(options_.own);
    const auto names = shippedScenes();
    if (std::find(names.begin(), names.end(), scene) != names.end()) return open(findScene(scene));
    throw AssetError("scene is \"" + scene + "\", must be one of the list");
}

Reload LiveScene::reload() {
    Reload reload;
    const auto changed = watch_.changed();
    if (changed.empty()) return reload;
    const auto note = [&](bool ok, const std::string& message) {
        for (const auto& file : changed) reload.files.push_back({file.string(), ok, message});
    };
    try {
        Scene scene = loadScene(path_, options_.overrides);
        // Whether or not they can be used at once, the files are now those of this scene.
        watch_ = Watch(scene.files);
        if (sameStructure(inFiles_, scene)) {
            const TuneState before = tuning_.defaults();
            tuning_.setDefaults(scene);
            for (std::size_t i = 0; i < before.size(); ++i) {
                if (before[i] == tuning_.defaults()[i]) continue;
                reload.values.emplace_back(tuning_.fields()[i].path, tuning_.defaults()[i]);
            }
            inFiles_ = std::move(scene);
            note(true, std::to_string(reload.values.size()) + " values changed");
        } else {
            reload.anew.reset(new LiveScene(load(path_, options_), options_));
            note(true, "the scene was made anew");
        }
    } catch (const std::exception& error) {
        note(false, error.what());
    }
    return reload;
}

std::filesystem::path LiveScene::tuningFile(const std::string& name) const {
    return options_.tunings / (inFiles_.name + "_" + name + ".json");
}

std::string LiveScene::saveTuning(const std::string& name) {
    const auto file = tuningFile(name);
    ragtop::saveTuning(file, path_, tuning_.changed());
    return file.string();
}

std::vector<TunedValue> LiveScene::savedTuning(const std::string& name) {
    const Scene scene = loadScene(tuningFile(name), options_.overrides);
    if (!sameStructure(inFiles_, scene)) {
        throw AssetError(tuningFile(name).string() + ": is another scene, must extend " + path_.string());
    }
    std::vector<TunedValue> values;
    const auto fields = tunablesOf(scene);
    for (std::size_t i = 0; i < fields.size(); ++i) {
        if (fields[i].value != tuning_.fields()[i].value) values.emplace_back(fields[i].path, fields[i].value);
    }
    return values;
}

}  // namespace ragtop::live
