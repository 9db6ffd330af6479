#include <algorithm>
#include <stdexcept>

#include "ragtop/body_pose.h"
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

/// Times of steps are sums of rounded numbers: half a microsecond early is in time.
bool isInTime(double moment, double time) { return moment <= time + 5e-7; }

}  // namespace

SceneInstance::SceneInstance(const Scene& scene, World& world)
    : world_(&world), step_(scene.step), roads_(scene.roads) {
    for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
        named("body", scene.bodies[i].name, i, [&] { bodies.push_back(world.create(scene.bodies[i].def)); });
    }
    joints.resize(scene.joints.size());
    couplings.resize(scene.couplings.size());
    join(scene, false);
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
    for (std::size_t i = 0; i < scene.ragdolls.size(); ++i)
        named("ragdoll", scene.ragdolls[i].name, i, [&] { add(scene.ragdolls[i]); });
    for (std::size_t i = 0; i < scene.robots.size(); ++i) {
        const SceneRobot& robot = scene.robots[i];
        named("robot", robot.name, i,
              [&] { robots.push_back(makeRobot(world, *robot.robot, robot.placement, robot.options())); });
    }
    join(scene, true);
    cloths.reserve(scene.cloths.size());
    for (std::size_t i = 0; i < scene.cloths.size(); ++i)
        named("cloth", scene.cloths[i].name, i, [&] { add(scene.cloths[i]); });
}

BodyId SceneInstance::idOf(int body, const ScenePart& part) const {
    if (body >= 0) return bodies[static_cast<std::size_t>(body)];
    const auto index = static_cast<std::size_t>(part.index), one = static_cast<std::size_t>(part.part);
    switch (part.owner) {
        case ScenePart::Owner::ragdoll:
            return ragdolls[index].bodies()[one];
        case ScenePart::Owner::robot:
            return robots[index].bodies[one];
        case ScenePart::Owner::vehicle:
            return vehicles[index].chassis();
        case ScenePart::Owner::none:
            break;
    }
    return {};
}

void SceneInstance::join(const Scene& scene, bool ofParts) {
    const auto holdsPart = [&](std::size_t joint) { return scene.joints[joint].holdsPart(); };
    for (std::size_t i = 0; i < scene.joints.size(); ++i) {
        if (holdsPart(i) != ofParts) continue;
        JointDef def = scene.joints[i].def;
        std::visit(
            [&](auto& kind) {
                kind.bodies.a = idOf(scene.joints[i].bodyA, scene.joints[i].partA);
                kind.bodies.b = idOf(scene.joints[i].bodyB, scene.joints[i].partB);
            },
            def);
        named("joint", scene.joints[i].name, i, [&] { joints[i] = world_->create(def); });
    }
    for (std::size_t i = 0; i < scene.couplings.size(); ++i) {
        const std::vector<std::size_t>& of = scene.couplings[i].joints;
        if (std::any_of(of.begin(), of.end(), holdsPart) != ofParts) continue;
        CouplingDef def = scene.couplings[i].def;
        for (std::size_t k = 0; k < of.size(); ++k) def.parts[k].joint = joints[of[k]];
        named("coupling", scene.couplings[i].name, i, [&] { couplings[i] = world_->create(def); });
    }
}

void SceneInstance::add(const SceneRagdoll& ragdoll) {
    if (ragdoll.isPosed())
        ragdolls.emplace_back(*world_, *ragdoll.def, standing(BodyAxes(*ragdoll.def), ragdoll.placement, ragdoll.pose),
                              ragdoll.velocity);
    else
        ragdolls.emplace_back(*world_, *ragdoll.def, ragdoll.placement, ragdoll.velocity);
    puppets.push_back(ragdoll.puppet ? std::make_unique<Puppet>(*world_, ragdolls.back()) : nullptr);
    blows_.push_back(ragdoll.blows);
}

void SceneInstance::add(const SceneCloth& cloth) {
    ClothDef def = cloth.def;
    for (const SceneClothHold& hold : cloth.holds)
        def.attachments.push_back({hold.point, idOf(hold.body, hold.part), {}});
    cloths.emplace_back(*world_, def, cloth.placement);
    cloths.back().setWind(cloth.wind);
    cloths.back().push(cloth.velocity);
}

/// Blows between this step and the next.
void SceneInstance::strike(double time) {
    for (std::size_t i = 0; i < ragdolls.size(); ++i) {
        for (const SceneBlow& blow : blows_[i]) {
            if (!isInTime(blow.time, time) || isInTime(blow.time, time - step_)) continue;
            const BodyId part = ragdolls[i].bodies()[static_cast<std::size_t>(blow.part)];
            const DVec3 at = world_->centerOfMass(part);
            if (puppets[i])
                puppets[i]->strike(blow.part, blow.impulse, at);
            else
                world_->applyImpulse(part, blow.impulse, at);
        }
    }
}

void SceneInstance::drive(double time) {
    strike(time);
    for (const std::unique_ptr<Puppet>& puppet : puppets)
        if (puppet) puppet->step(step_);
    for (std::size_t i = 0; i < vehicles.size(); ++i) {
        if (!scripted[i]) continue;
        for (const DriverAction& action : scripts_[i]) {
            if (isInTime(action.time, time)) vehicles[i].input = action.input;
        }
        if (!drivers_[i]) continue;
        const SceneRoad& road = roads_[drivers_[i]->road];
        vehicles[i].input =
            followLine({road.line, road.closed}, vehicles[i], world_->pose(vehicles[i].chassis()), drivers_[i]->speed);
    }
}

}  // namespace ragtop
