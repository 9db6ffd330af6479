#include <stdexcept>

#include "ragtop/driver.h"
#include "ragtop/scene.h"
#include "ragtop/world.h"

namespace ragtop {
namespace {

/// Names the thing that a world refused.
template <class Create>
void named(const char* kind, const std::string& name, std::size_t index, Create create) {
    try {
        create();
    } catch (const std::invalid_argument& error) {
        const std::string label = name.empty() ? std::to_string(index) : "\"" + name + "\"";
        throw AssetError(std::string(kind) + " " + label + " of the scene: " + error.what());
    }
}

}  // namespace

SceneInstance::SceneInstance(const Scene& scene, World& world) : world_(&world), roads_(scene.roads) {
    for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
        named("body", scene.bodies[i].name, i, [&] { bodies.push_back(world.create(scene.bodies[i].def)); });
    }
    const auto idOf = [&](int body) { return body < 0 ? BodyId{} : bodies[static_cast<std::size_t>(body)]; };
    for (std::size_t i = 0; i < scene.joints.size(); ++i) {
        const SceneJoint& joint = scene.joints[i];
        JointDef def = joint.def;
        std::visit(
            [&](auto& kind) {
                kind.bodies.a = idOf(joint.bodyA);
                kind.bodies.b = idOf(joint.bodyB);
            },
            def);
        named("joint", joint.name, i, [&] { joints.push_back(world.create(def)); });
    }
    for (std::size_t i = 0; i < scene.couplings.size(); ++i) {
        CouplingDef def = scene.couplings[i].def;
        for (std::size_t k = 0; k < scene.couplings[i].joints.size(); ++k)
            def.parts[k].joint = joints[scene.couplings[i].joints[k]];
        named("coupling", scene.couplings[i].name, i, [&] { couplings.push_back(world.create(def)); });
    }
    animated.reserve(scene.animated.size());
    for (std::size_t i = 0; i < scene.animated.size(); ++i) {
        AnimatedBodyDef def = scene.animated[i].def;
        def.body = idOf(scene.animated[i].body);
        def.carrier = idOf(scene.animated[i].carrier);
        named("animated", "", i, [&] { animated.emplace_back(world, def); });
    }
    vehicles.reserve(scene.vehicles.size());
    for (std::size_t i = 0; i < scene.vehicles.size(); ++i) {
        const SceneVehicle& vehicle = scene.vehicles[i];
        named("vehicle", vehicle.name, i, [&] { vehicles.emplace_back(world, vehicle.def, vehicle.placement); });
        scripts_.push_back(vehicle.script);
        drivers_.push_back(vehicle.driver);
        scripted.push_back(true);
    }
    ragdolls.reserve(scene.ragdolls.size());
    for (std::size_t i = 0; i < scene.ragdolls.size(); ++i) {
        const SceneRagdoll& ragdoll = scene.ragdolls[i];
        named("ragdoll", ragdoll.name, i,
              [&] { ragdolls.emplace_back(world, *ragdoll.def, ragdoll.placement, ragdoll.velocity); });
    }
}

void SceneInstance::drive(double time) {
    for (std::size_t i = 0; i < vehicles.size(); ++i) {
        if (!scripted[i]) continue;
        for (const DriverAction& action : scripts_[i]) {
            // Times of steps are sums of rounded numbers: half a microsecond early is in time.
            if (action.time <= time + 5e-7) vehicles[i].input = action.input;
        }
        if (!drivers_[i]) continue;
        const SceneRoad& road = roads_[drivers_[i]->road];
        vehicles[i].input =
            followLine({road.line, road.closed}, vehicles[i], world_->pose(vehicles[i].chassis()), drivers_[i]->speed);
    }
}

}  // namespace ragtop
