#include "live_program.h"

#include <cmath>
#include <stdexcept>

namespace ragtop::live {
namespace {

/// What may be tuned, as if it came from a file.
Scene sceneOf(const World& world, const ServeOptions& options) {
    Scene scene;
    scene.settings = world.settings();
    for (const auto& [name, vehicle, start] : options.vehicles) {
        if (!vehicle) throw std::invalid_argument("vehicles: \"" + name + "\" is null, must point to one");
        scene.vehicles.push_back({name, vehicle->def(), start, {}});
    }
    for (const auto& [name, ragdoll] : options.ragdolls) {
        if (!ragdoll) throw std::invalid_argument("ragdolls: \"" + name + "\" is null, must point to one");
        SceneRagdoll one;
        one.name = name;
        one.def = std::make_shared<const RagdollDef>(ragdoll->def());
        scene.ragdolls.push_back(std::move(one));
    }
    return scene;
}

RunningScene running(World& world, const ServeOptions& options) {
    RunningScene scene;
    scene.world = &world;
    for (const auto& one : options.vehicles) scene.vehicles.push_back(one.vehicle);
    for (const auto& one : options.ragdolls) scene.ragdolls.push_back(one.ragdoll);
    return scene;
}

}  // namespace

LiveProgram::LiveProgram(World& world, const ServeOptions& options)
    : options_(options),
      tuning_(sceneOf(world, options), sceneOf(world, options), running(world, options), options.tunables) {
    if (!(options.step > 0) || !std::isfinite(options.step)) {
        throw std::invalid_argument("step is " + std::to_string(options.step) + " s, must be above 0 and finite");
    }
    cast_.world = &world;
    cast_.step = options.step;
    cast_.name = options.name;
    cast_.description = options.description;
    for (const auto& one : options.vehicles) cast_.vehicles.push_back({one.name, one.vehicle, one.start});
    for (const auto& one : options.ragdolls) cast_.ragdolls.push_back({one.name, one.ragdoll});
    for (const auto& one : options.cloths) cast_.cloths.push_back({one.name, one.cloth, one.color});
    cast_.look = [this](BodyId body) {
        Look look;
        if (options_.nameOf) look.name = options_.nameOf(body);
        if (options_.colorOf) look.color = options_.colorOf(body);
        return look;
    };
    cast_.beforeStep = [this](const std::vector<bool>& driven) { beforeStep(driven); };
}

void LiveProgram::beforeStep(const std::vector<bool>& driven) {
    if (!options_.beforeStep) return;
    std::vector<VehicleInput> inputs;
    for (const auto& one : options_.vehicles) inputs.push_back(one.vehicle->input);
    options_.beforeStep(options_.step);
    for (std::size_t i = 0; i < driven.size(); ++i) {
        if (driven[i]) options_.vehicles[i].vehicle->input = inputs[i];
    }
}

}  // namespace ragtop::live
