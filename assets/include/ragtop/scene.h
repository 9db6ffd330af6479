#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "ragtop/animated_body.h"
#include "ragtop/asset_error.h"
#include "ragtop/body.h"
#include "ragtop/body_pose.h"
#include "ragtop/cloth.h"
#include "ragtop/coupling.h"
#include "ragtop/debug_draw.h"
#include "ragtop/id.h"
#include "ragtop/joint.h"
#include "ragtop/puppet.h"
#include "ragtop/ragdoll.h"
#include "ragtop/robot.h"
#include "ragtop/settings.h"
#include "ragtop/vehicle.h"

/// A scene is a JSON file with comments: settings, materials, bodies, generators of many bodies, joints, vehicles with
/// a driver's script, ragdolls and puppets with the blows that they take, robots, cloths, and values that replace
/// others
/// ("tuning").
/// src/scene_file.h describes every field; assets/data/scenes has examples.
namespace ragtop {

class World;

struct SceneBody {
    std::string name{};
    BodyDef def{};
    bool masonry = false;    ///< part of a building, whose displacement is measured
    std::string material{};  ///< of the scene's materials; empty: none of them
    std::optional<Color> color{};
};

/// A body of something that is more than one, or a car.
struct ScenePart {
    enum class Owner { none, ragdoll, robot, vehicle } owner = Owner::none;
    int index = -1;  ///< of the scene's ragdolls, robots or vehicles
    int part = -1;   ///< of the parts of the ragdoll, or of the bodies of the robot
    explicit operator bool() const { return owner != Owner::none; }
};

struct SceneJoint {
    std::string name{};
    int bodyA = -1, bodyB = -1;  ///< indices of the scene's bodies; −1: a part, or the world
    JointDef def{};              ///< its bodies are null
    ScenePart partA{}, partB{};
    bool holdsPart() const { return partA || partB; }
};

struct SceneCoupling {
    std::string name{};
    std::vector<std::size_t> joints{};  ///< of the scene's, one for each part
    CouplingDef def{};                  ///< its joints are null
};

struct SceneAnimation {
    int body = -1, carrier = -1;  ///< indices of the scene's bodies; −1: the world
    AnimatedBodyDef def{};        ///< its bodies are null
};

/// From `time` on the driver does this.
struct DriverAction {
    double time = 0;  ///< s
    VehicleInput input{};
};

/// A driver who keeps to a road.
struct SceneDriver {
    std::size_t road = 0;  ///< of the scene's
    float speed = 0;       ///< m/s, where the road allows it
};

struct SceneVehicle {
    std::string name{};
    VehicleDef def{};
    VehiclePlacement placement{};
    std::vector<DriverAction> script{};  ///< by rising time
    std::optional<SceneDriver> driver{};
};

/// The centre line of a road; its surface is a body of the same name.
struct SceneRoad {
    std::string name{};
    bool closed = true;
    float width = 0;            ///< m
    std::vector<DVec3> line{};  ///< m, a point every two metres or so
};

/// An impulse on the centre of mass of a part, which leaves the muscles of a puppet weak near there (Puppet::strike).
struct SceneBlow {
    double time = 0;  ///< s
    int part = 0;
    Vec3 impulse{};  ///< N s
};

struct SceneRagdoll {
    std::string name{};
    std::shared_ptr<const RagdollDef> def{};  ///< shared by those made from one file
    Pose placement{};                         ///< of its model; of one in a pose, of the ground between its feet
    bool puppet = false;                      ///< stands at first, and falls and gets up as it is struck
    std::vector<PartAngles> pose{};           ///< empty: at rest, but for a puppet, which stands
    std::vector<SceneBlow> blows{};           ///< by rising time
    Vec3 velocity{};                          ///< m/s
    std::filesystem::path character{};        ///< the model it was made from; empty: none
    bool isPosed() const { return puppet || !pose.empty(); }
};

struct SceneRobot {
    std::string name{};
    std::shared_ptr<const Robot> robot{};  ///< shared by those of one entry
    Pose placement{};                      ///< of its root
    bool holding = false;                  ///< servos hold it as it begins; otherwise it is limp
    bool selfCollision = false;            ///< links that no joint joins collide with each other
    RobotOptions options() const { return {.selfCollision = selfCollision, .holding = holding}; }
};

/// A point of a cloth that goes where something else does.
struct SceneClothHold {
    int point = 0;
    int body = -1;  ///< of the scene's bodies; −1: a part, or the world
    ScenePart part{};
};

struct SceneCloth {
    std::string name{};
    ClothDef def{};  ///< without attachments
    Pose placement{};
    std::vector<SceneClothHold> holds{};
    Vec3 wind{}, velocity{};  ///< m/s
    std::optional<Color> color{};
};

/// From where to look at the beginning.
struct SceneCamera {
    DVec3 target{}, eye{};  ///< m
};

/// What a file says; no world yet.
struct Scene {
    std::string name{};
    std::string description{};  ///< one line
    WorldSettings settings{};
    double step = 1.0 / 60;  ///< s
    double duration = 10;    ///< s
    std::optional<SceneCamera> camera{};
    std::map<std::string, Material> materials{};
    std::vector<SceneBody> bodies{};
    std::vector<SceneJoint> joints{};
    std::vector<SceneCoupling> couplings{};
    std::vector<SceneAnimation> animated{};
    std::vector<SceneRoad> roads{};
    std::vector<SceneVehicle> vehicles{};
    std::vector<SceneRagdoll> ragdolls{};
    std::vector<SceneRobot> robots{};
    std::vector<SceneCloth> cloths{};
    std::vector<std::string> warnings{};
    std::vector<std::filesystem::path> files{};  ///< all that were read, but for meshes
};

/// A value that replaces the file's: a path like "settings.sleeping", the bare name of a setting of the world, or
/// "tuning." and a path of scene_tuning.h; and the value as JSON (or a string).
struct SceneOverride {
    std::string path;
    std::string value;
};

/// Throws AssetError: "file:line:column: /pointer is value, must be ...".
Scene loadScene(const std::filesystem::path& path, std::span<const SceneOverride> overrides = {});

/// Writes settings, bodies of one shape and joints whose frames agree, in full; what a scene was generated from,
/// vehicles, ragdolls, robots and cloths have no place in it. Throws AssetError when something cannot be written.
void saveScene(const Scene& scene, const std::filesystem::path& path);

/// The file of a scene that comes with the library, or the file of that path. Throws AssetError when there is none.
std::filesystem::path findScene(std::string_view nameOrPath);
/// Names of the scenes that come with the library, sorted; none where there is no dataFolder(), which tells why.
std::vector<std::string> shippedScenes();
/// The description in a scene file; empty where there is none or the file is not usable.
std::string sceneDescription(const std::filesystem::path& path);

/// A scene in a world. Bodies and joints belong to the world; vehicles, ragdolls, puppets and cloths live as long as
/// this, and the world must outlive it.
struct SceneInstance {
    /// Throws AssetError when the world refuses something.
    SceneInstance(const Scene& scene, World& world);

    std::vector<BodyId> bodies;         ///< in the order of the scene
    std::vector<JointId> joints;        ///< in the order of the scene
    std::vector<CouplingId> couplings;  ///< in the order of the scene
    std::vector<AnimatedBody> animated;
    std::vector<Vehicle> vehicles;
    std::vector<Ragdoll> ragdolls;
    std::vector<std::unique_ptr<Puppet>> puppets;  ///< one for each ragdoll; null: it is limp
    std::vector<RobotIds> robots;                  ///< in the order of the scene
    std::vector<Cloth> cloths;                     ///< in the order of the scene
    std::vector<bool> scripted;  ///< false for a vehicle that somebody else drives: script and driver are passed over

    /// Gives each vehicle what its script says for the time, s, or its driver for the place, strikes ragdolls and has
    /// puppets decide what to do in a step of the scene's length; call it before each step. What it does depends on
    /// the time and the world alone, so that a restored world goes on as before.
    void drive(double time);

private:
    BodyId idOf(int body, const ScenePart& part = {}) const;
    /// Joints and couplings of parts, or those of bodies alone.
    void join(const Scene& scene, bool ofParts);
    void add(const SceneRagdoll& ragdoll);
    void add(const SceneCloth& cloth);
    void strike(double time);

    World* world_;
    double step_;                                ///< s
    std::vector<std::vector<SceneBlow>> blows_;  ///< by ragdoll
    std::vector<SceneRoad> roads_;
    std::vector<std::vector<DriverAction>> scripts_;
    std::vector<std::optional<SceneDriver>> drivers_;
};

}  // namespace ragtop
