#pragma once

#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "ragtop/asset_error.h"
#include "ragtop/body.h"
#include "ragtop/id.h"
#include "ragtop/joint.h"
#include "ragtop/ragdoll.h"
#include "ragtop/settings.h"
#include "ragtop/vehicle.h"

/// A scene is a JSON file with comments: settings, materials, bodies, generators of many bodies, joints, vehicles with
/// a driver's script, ragdolls. src/scene_file.h describes every field; assets/data/scenes has examples.
namespace ragtop {

class World;

struct SceneBody {
    std::string name{};
    BodyDef def{};
    bool masonry = false;  ///< part of a building, whose displacement is measured
};

struct SceneJoint {
    std::string name{};
    int bodyA = -1, bodyB = -1;  ///< indices of the scene's bodies; −1: the world
    JointDef def{};              ///< its bodies are null
};

/// From `time` on the driver does this.
struct DriverAction {
    double time = 0;  ///< s
    VehicleInput input{};
};

struct SceneVehicle {
    std::string name{};
    VehicleDef def{};
    VehiclePlacement placement{};
    std::vector<DriverAction> script{};  ///< by rising time
};

struct SceneRagdoll {
    std::string name{};
    std::shared_ptr<const RagdollDef> def{};  ///< shared by those made from one file
    Pose placement{};
    Vec3 velocity{};  ///< m/s
};

/// What a file says; no world yet.
struct Scene {
    std::string name{};
    WorldSettings settings{};
    double step = 1.0 / 60;  ///< s
    double duration = 10;    ///< s
    std::vector<SceneBody> bodies{};
    std::vector<SceneJoint> joints{};
    std::vector<SceneVehicle> vehicles{};
    std::vector<SceneRagdoll> ragdolls{};
    std::vector<std::string> warnings{};
};

/// A value that replaces the file's: a path like "settings.sleeping", or the bare name of a setting of the world, and
/// the value as JSON (or a string).
struct SceneOverride {
    std::string path;
    std::string value;
};

/// Throws AssetError: "file:line:column: /pointer is value, must be ...".
Scene loadScene(const std::filesystem::path& path, std::span<const SceneOverride> overrides = {});

/// The file of a scene that comes with the library, or the file of that path. Throws AssetError when there is none.
std::filesystem::path findScene(std::string_view nameOrPath);
/// Names of the scenes that come with the library, sorted.
std::vector<std::string> shippedScenes();

/// A scene in a world. Bodies and joints belong to the world; vehicles and ragdolls live as long as this, and the
/// world must outlive it.
struct SceneInstance {
    /// Throws AssetError when the world refuses something.
    SceneInstance(const Scene& scene, World& world);

    std::vector<BodyId> bodies;    ///< in the order of the scene
    std::vector<JointId> joints;   ///< in the order of the scene
    std::vector<Vehicle> vehicles;
    std::vector<Ragdoll> ragdolls;

    /// Gives each vehicle what its script says for the time, s; call it before each step. What it does depends on
    /// the time alone, so that a restored world goes on as before.
    void drive(double time);

private:
    std::vector<std::vector<DriverAction>> scripts_;
};

}  // namespace ragtop
