#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "describe_json.h"
#include "ragtop/body.h"
#include "ragtop/body_pose.h"
#include "ragtop/ragdoll.h"
#include "ragtop/scene.h"
#include "ragtop/settings.h"
#include "ragtop/vehicle.h"
#include "role_names.h"
#include "scene_cloth_file.h"

/// The structs that a scene file is read into, before they are expanded into a Scene.
namespace ragtop {

inline const std::vector<std::string>& enumNames(BodyType) {
    static const std::vector<std::string> names{"fixed", "kinematic", "dynamic"};
    return names;
}

struct BodyInFile {
    std::string name, material, color;
    BodyType type = BodyType::dynamic;
    std::optional<Shape> shape;
    PlaceInFile place;
    float density = 1000;
    bool masonry = false, sensor = false;
    Filter filter;
    BodyDef def;  ///< what its description covers
};
template <class Visitor, class Self>
void describe(Visitor& visit, Self& self, const BodyInFile*) {
    visit(Tunable{.name = "name"}, self.name);
    visit(Tunable{.name = "type", .meaning = "how it moves"}, self.type);
    visit(Tunable{.name = "shape"}, self.shape);
    describe(visit, self.place, static_cast<const PlaceInFile*>(nullptr));
    visit(Tunable{"density", "kg/m³", 1e-3, 1e6, "mass over volume"}, self.density);
    visit(Tunable{.name = "material", .meaning = "name of one of the materials"}, self.material);
    visit(Tunable{.name = "color", .meaning = "\"#rrggbb\"; absent: by what it is"}, self.color);
    visit(Tunable{.name = "masonry", .meaning = "part of a building, whose displacement is measured"}, self.masonry);
    visit(Tunable{.name = "sensor", .meaning = "reports overlaps, feels nothing"}, self.sensor);
    visit(Tunable{.name = "filter", .meaning = "who collides with whom"}, self.filter);
    describe(visit, self.def, static_cast<const BodyDef*>(nullptr));
}
inline Names requiredFields(const BodyInFile*) { return {"shape"}; }

/// Many bodies in a grid: count along x, y, z, at distances of `spacing`, in the axes of the world.
struct GridInFile {
    std::array<unsigned, 3> count{1, 1, 1};
    Vec3 spacing{1, 1, 1};
    float scatter = 0;
    bool tumble = false;
    unsigned seed = 1;
    std::size_t size() const { return std::size_t{count[0]} * count[1] * count[2]; }
};
template <class Visitor, class Self>
void describe(Visitor& visit, Self& self, const GridInFile*) {
    visit(Tunable{"count", "", 1, 10000, "how many along x, y and z"}, self.count);
    visit(Tunable{"spacing", "m", -1e5, 1e5, "distance of neighbours along x, y and z"}, self.spacing);
    visit(Tunable{"scatter", "m", 0, 1e5, "largest random offset along each axis"}, self.scatter);
    visit(Tunable{.name = "tumble", .meaning = "turned at random"}, self.tumble);
    visit(Tunable{"seed", "", 0, 4294967295.0, "other seeds give other random numbers"}, self.seed);
}

struct RepeatInFile {
    BodyInFile body;
    GridInFile grid;
};
template <class Visitor, class Self>
void describe(Visitor& visit, Self& self, const RepeatInFile*) {
    visit(Tunable{.name = "body", .meaning = "what is repeated"}, self.body);
    describe(visit, self.grid, static_cast<const GridInFile*>(nullptr));
}
inline Names requiredFields(const RepeatInFile*) { return {"body", "count"}; }

/// Boxes laid in courses: walls and houses in running bond.
struct BricksInFile {
    std::string name, material, color;
    PlaceInFile place;
    Vec3 size{0.4f, 0.2f, 0.2f};
    float gap = 0.002f;
    unsigned courses = 10, bricks = 10;
    float density = 1100;
    bool masonry = true;
};
template <class Visitor, class Self>
void describe(Visitor& visit, Self& self, const BricksInFile*) {
    visit(Tunable{.name = "name"}, self.name);
    describe(visit, self.place, static_cast<const PlaceInFile*>(nullptr));
    visit(Tunable{"size", "m", 1e-4, 1e4, "of a brick: length, height, thickness"}, self.size);
    visit(Tunable{"gap", "m", 0, 1, "between bricks of a course"}, self.gap);
    visit(Tunable{"courses", "", 1, 1000, "layers of bricks"}, self.courses);
    visit(Tunable{"bricks", "", 1, 1000, "bricks in a course of a wall"}, self.bricks);
    visit(Tunable{"density", "kg/m³", 1e-3, 1e6, "mass over volume"}, self.density);
    visit(Tunable{.name = "material", .meaning = "name of one of the materials"}, self.material);
    visit(Tunable{.name = "color", .meaning = "\"#rrggbb\"; absent: by what it is"}, self.color);
    visit(Tunable{.name = "masonry", .meaning = "part of a building, whose displacement is measured"}, self.masonry);
}

struct TowerInFile {
    std::string name, material, color;
    PlaceInFile place;
    Vec3 size{1, 1, 1};
    unsigned count = 10;
    float scatter = 0;
    unsigned seed = 1;
    float density = 1000;
};
template <class Visitor, class Self>
void describe(Visitor& visit, Self& self, const TowerInFile*) {
    visit(Tunable{.name = "name"}, self.name);
    describe(visit, self.place, static_cast<const PlaceInFile*>(nullptr));
    visit(Tunable{"size", "m", 1e-4, 1e4, "of a box along x, y, z"}, self.size);
    visit(Tunable{"count", "", 1, 10000, "boxes on top of each other"}, self.count);
    visit(Tunable{"scatter", "m", 0, 1e4, "largest random offset along x and z"}, self.scatter);
    visit(Tunable{"seed", "", 0, 4294967295.0, "other seeds give other random numbers"}, self.seed);
    visit(Tunable{"density", "kg/m³", 1e-3, 1e6, "mass over volume"}, self.density);
    visit(Tunable{.name = "material", .meaning = "name of one of the materials"}, self.material);
    visit(Tunable{.name = "color", .meaning = "\"#rrggbb\"; absent: by what it is"}, self.color);
}

/// Fixed boxes; the first step is at the place, the others rise along +z of it.
struct StairsInFile {
    std::string name, material, color;
    PlaceInFile place;
    unsigned steps = 10;
    float rise = 0.18f, tread = 0.3f, width = 2;
};
template <class Visitor, class Self>
void describe(Visitor& visit, Self& self, const StairsInFile*) {
    visit(Tunable{.name = "name"}, self.name);
    describe(visit, self.place, static_cast<const PlaceInFile*>(nullptr));
    visit(Tunable{"steps", "", 1, 1000, "how many"}, self.steps);
    visit(Tunable{"rise", "m", 1e-3, 100, "height of a step"}, self.rise);
    visit(Tunable{"tread", "m", 1e-3, 100, "depth of a step"}, self.tread);
    visit(Tunable{"width", "m", 1e-3, 1e4, "of the stairs, along x"}, self.width);
    visit(Tunable{.name = "material", .meaning = "name of one of the materials"}, self.material);
    visit(Tunable{.name = "color", .meaning = "\"#rrggbb\"; absent: by what it is"}, self.color);
}

/// A smooth ribbon through points, on an embankment.
struct RoadInFile {
    std::string name, material, color;
    std::vector<DVec3> points;
    bool closed = true;
    float width = 8, slope = 0.5f, foot = 0;
};
template <class Visitor, class Self>
void describe(Visitor& visit, Self& self, const RoadInFile*) {
    visit(Tunable{.name = "name"}, self.name);
    visit(Tunable{"points", "m", -1e9, 1e9, "of the centre line, in the direction of travel"}, self.points);
    visit(Tunable{.name = "closed", .meaning = "its end is its beginning"}, self.closed);
    visit(Tunable{"width", "m", 0.1, 1000, "from edge to edge"}, self.width);
    visit(Tunable{"slope", "1", 0.01, 100, "rise over run of the embankment on both sides"}, self.slope);
    visit(Tunable{"foot", "m", -1e9, 1e9, "height at which the embankment ends"}, self.foot);
    visit(Tunable{.name = "material", .meaning = "name of one of the materials"}, self.material);
    visit(Tunable{.name = "color", .meaning = "\"#rrggbb\"; absent: by what it is"}, self.color);
}
inline Names requiredFields(const RoadInFile*) { return {"points"}; }

struct SceneJointInFile {
    std::string name, a, b;
    DVec3 anchor;
    std::optional<DVec3> anchorB;
    Vec3 axis{1, 0, 0};
    bool collide = false;
    std::optional<float> breakForce, breakTorque;
};
template <class Visitor, class Self>
void describe(Visitor& visit, Self& self, const SceneJointInFile*) {
    visit(Tunable{.name = "name"}, self.name);
    visit(Tunable{.name = "a", .meaning = "a body, a vehicle, \"ragdoll/part\" or \"robot/link\"; absent: the world"},
          self.a);
    visit(Tunable{.name = "b", .meaning = "a body, a vehicle, \"ragdoll/part\" or \"robot/link\"; absent: the world"},
          self.b);
    visit(Tunable{"anchor", "m", -1e9, 1e9, "where it is, in the world"}, self.anchor);
    visit(Tunable{"anchorB", "m", -1e9, 1e9, "its other end, of a distance joint"}, self.anchorB);
    visit(Tunable{"axis", "1", -1e5, 1e5, "hinge, slide or twist axis, in the world"}, self.axis);
    visit(Tunable{.name = "collide", .meaning = "do the two bodies collide with each other?"}, self.collide);
    visit(Tunable{"breakForce", "N", 1e-6, 1e12, "force beyond which it breaks"}, self.breakForce);
    visit(Tunable{"breakTorque", "N m", 1e-6, 1e12, "torque beyond which it breaks"}, self.breakTorque);
}
inline Names requiredFields(const SceneJointInFile*) { return {"anchor"}; }

struct CoupledInFile {
    std::string joint;
    int coordinate = 0;
    float ratio = 1;
};
template <class Visitor, class Self>
void describe(Visitor& visit, Self& self, const CoupledInFile*) {
    visit(Tunable{.name = "joint", .meaning = "name of a joint of the scene"}, self.joint);
    visit(Tunable{"coordinate", "", 0, 5, "which of its coordinates"}, self.coordinate);
    visit(Tunable{"ratio", "", -1e6, 1e6, "how often it counts in the sum"}, self.ratio);
}
inline Names requiredFields(const CoupledInFile*) { return {"joint"}; }

struct CouplingInFile {
    std::string name;
    std::vector<CoupledInFile> parts;
    AxisDef sum;
};
template <class Visitor, class Self>
void describe(Visitor& visit, Self& self, const CouplingInFile*) {
    visit(Tunable{.name = "name"}, self.name);
    visit(Tunable{.name = "parts", .meaning = "1 to 4 coordinates, which are added"}, self.parts);
    visit(Tunable{.name = "sum", .meaning = "what acts along the sum; a limit with equal ends makes gears"}, self.sum);
}
inline Names requiredFields(const CouplingInFile*) { return {"parts"}; }

struct KeyInFile {
    double time = 0;
    DVec3 position{};
    Quat rotation{};
};
template <class Visitor, class Self>
void describe(Visitor& visit, Self& self, const KeyInFile*) {
    visit(Tunable{"time", "s", 0, 1e6, "of the animation's clock"}, self.time);
    visit(Tunable{"position", "m", -1e9, 1e9, "of the body, in its carrier"}, self.position);
    visit(Tunable{"rotation", "", 0, 0, "how it is turned"}, self.rotation);
}
inline Names requiredFields(const KeyInFile*) { return {"time", "position"}; }

struct AnimatedInFile {
    std::string body, carrier;
    std::vector<KeyInFile> keys;
    AnimatedBodyDef def;  ///< what its description covers
};
template <class Visitor, class Self>
void describe(Visitor& visit, Self& self, const AnimatedInFile*) {
    visit(Tunable{.name = "body", .meaning = "name of a dynamic body"}, self.body);
    visit(Tunable{.name = "carrier", .meaning = "body that the keys are relative to; absent: the world"}, self.carrier);
    visit(Tunable{.name = "keys", .meaning = "where it is when; it eases from one to the next"}, self.keys);
    visit(Tunable{.name = "loops", .meaning = "from the last key on with the first"}, self.def.loops);
    visit(Tunable{"maxForce", "N", 1e-6, 1e12, "its budget, beyond what its own motion takes"}, self.def.maxForce);
    visit(Tunable{"maxTorque", "N m", 1e-6, 1e12, "likewise"}, self.def.maxTorque);
    visit(Tunable{.name = "whenBlocked", .meaning = "what it does when that is not enough"}, self.def.whenBlocked);
    visit(Tunable{"patience", "s", 0, 1e6, "for which it is blocked until it yields or breaks"}, self.def.patience);
}
inline Names requiredFields(const AnimatedInFile*) { return {"body", "keys"}; }

struct ActionInFile {
    double time = 0;
    VehicleInput input;
};
template <class Visitor, class Self>
void describe(Visitor& visit, Self& self, const ActionInFile*) {
    visit(Tunable{"time", "s", 0, 1e6, "from when on"}, self.time);
    visit(Tunable{"throttle", "1", 0, 1, "pedal"}, self.input.throttle);
    visit(Tunable{"brake", "1", 0, 1, "pedal"}, self.input.brake);
    visit(Tunable{"steer", "1", -1, 1, "−1 full left to 1 full right"}, self.input.steer);
    visit(Tunable{"handbrake", "1", 0, 1, "lever"}, self.input.handbrake);
    visit(Tunable{"clutch", "1", 0, 1, "pedal; 0 is automatic"}, self.input.clutch);
    visit(Tunable{"gear", "", -1, 20, "−1 reverse, 0 neutral; absent: the gearbox decides"}, self.input.gear);
}

struct DriverInFile {
    std::string road;
    float speed = 15;
};
template <class Visitor, class Self>
void describe(Visitor& visit, Self& self, const DriverInFile*) {
    visit(Tunable{.name = "road", .meaning = "name of one of the roads"}, self.road);
    visit(Tunable{"speed", "m/s", 0, 200, "where the road allows it"}, self.speed);
}
inline Names requiredFields(const DriverInFile*) { return {"road"}; }

struct VehicleInFile {
    std::string name, file;
    VehiclePlacement placement;
    std::vector<ActionInFile> script;
    std::optional<DriverInFile> driver;
};
template <class Visitor, class Self>
void describe(Visitor& visit, Self& self, const VehicleInFile*) {
    visit(Tunable{.name = "name"}, self.name);
    visit(Tunable{.name = "file", .meaning = "its definition"}, self.file);
    visit(Tunable{"position", "m", -1e9, 1e9, "of the chassis"}, self.placement.position);
    visit(Tunable{"heading", "rad", -kWholeTurn, kWholeTurn, "turn about y; 0 looks along +z"}, self.placement.heading);
    visit(Tunable{"speed", "m/s", -200, 200, "forward, wheels rolling"}, self.placement.speed);
    visit(Tunable{.name = "script", .meaning = "what the driver does, by rising time"}, self.script);
    visit(Tunable{.name = "driver", .meaning = "follows a road, instead of a script"}, self.driver);
}
inline Names requiredFields(const VehicleInFile*) { return {"file"}; }

struct BlowInFile {
    double time = 0;
    std::string part;
    Vec3 impulse;
};
template <class Visitor, class Self>
void describe(Visitor& visit, Self& self, const BlowInFile*) {
    visit(Tunable{"time", "s", 0, 1e6, "when it comes"}, self.time);
    visit(Tunable{.name = "part", .meaning = "of the ragdoll, by its name"}, self.part);
    visit(Tunable{"impulse", "N s", -1e6, 1e6, "on the centre of mass of the part"}, self.impulse);
}
inline Names requiredFields(const BlowInFile*) { return {"time", "part", "impulse"}; }

struct RagdollInScene {
    std::string name, file, character;
    RagdollOptions options;
    PlaceInFile place;
    bool standing = false, puppet = false, optional = false;
    std::vector<PartAngles> pose;
    std::vector<BlowInFile> blows;
    Vec3 velocity;
    GridInFile grid;
};
template <class Visitor, class Self>
void describe(Visitor& visit, Self& self, const RagdollInScene*) {
    visit(Tunable{.name = "name"}, self.name);
    visit(Tunable{.name = "file", .meaning = "a ragdoll definition"}, self.file);
    visit(Tunable{.name = "character", .meaning = "a rigged character to make one from"}, self.character);
    visit(Tunable{.name = "options", .meaning = "how it is made from the character"}, self.options);
    describe(visit, self.place, static_cast<const PlaceInFile*>(nullptr));
    visit(Tunable{.name = "standing", .meaning = "its lowest point, not its origin, is at the height of its position"},
          self.standing);
    visit(Tunable{.name = "puppet", .meaning = "stands with its feet at its position, falls when struck, gets up"},
          self.puppet);
    visit(Tunable{.name = "pose", .meaning = "turned joints of who stands with the feet at its position"}, self.pose);
    visit(Tunable{.name = "blows", .meaning = "what strikes it when, by rising time"}, self.blows);
    visit(Tunable{"velocity", "m/s", -1000, 1000, "of all parts at the start"}, self.velocity);
    visit(Tunable{.name = "optional", .meaning = "left out, with a warning, where its file is not there"},
          self.optional);
    describe(visit, self.grid, static_cast<const GridInFile*>(nullptr));
}

struct RobotInScene {
    std::string name, file;
    PlaceInFile place;
    bool standing = false, holding = false, selfCollision = false, optional = false;
    GridInFile grid;
};
template <class Visitor, class Self>
void describe(Visitor& visit, Self& self, const RobotInScene*) {
    visit(Tunable{.name = "name"}, self.name);
    visit(Tunable{.name = "file", .meaning = "its description: URDF, MJCF or cooked"}, self.file);
    describe(visit, self.place, static_cast<const PlaceInFile*>(nullptr));
    visit(Tunable{.name = "standing", .meaning = "its lowest point, not its root, is at the height of its position"},
          self.standing);
    visit(Tunable{.name = "holding", .meaning = "servos hold its joints where they begin; false: it is limp"},
          self.holding);
    visit(Tunable{.name = "selfCollision", .meaning = "links that no joint joins collide with each other"},
          self.selfCollision);
    visit(Tunable{.name = "optional", .meaning = "left out, with a warning, where its file is not there"},
          self.optional);
    describe(visit, self.grid, static_cast<const GridInFile*>(nullptr));
}
inline Names requiredFields(const RobotInScene*) { return {"file"}; }

struct CameraInFile {
    SceneCamera camera;
};
template <class Visitor, class Self>
void describe(Visitor& visit, Self& self, const CameraInFile*) {
    visit(Tunable{"target", "m", -1e9, 1e9, "what is looked at"}, self.camera.target);
    visit(Tunable{"eye", "m", -1e9, 1e9, "from where"}, self.camera.eye);
}
inline Names requiredFields(const CameraInFile*) { return {"target", "eye"}; }

struct SceneInFile {
    std::string description;
    std::optional<CameraInFile> camera;
    WorldSettings settings;
    double step = 1.0 / 60, duration = 10;
    std::vector<std::string> include;
    std::map<std::string, Material> materials;
    std::vector<BodyInFile> bodies;
    std::vector<RepeatInFile> repeat;
    std::vector<BricksInFile> walls, houses;
    std::vector<TowerInFile> towers;
    std::vector<StairsInFile> stairs;
    std::vector<RoadInFile> roads;
    std::vector<SceneJointInFile> joints;
    std::vector<CouplingInFile> couplings;
    std::vector<AnimatedInFile> animated;
    std::vector<VehicleInFile> vehicles;
    std::vector<RagdollInScene> ragdolls;
    std::vector<RobotInScene> robots;
    std::vector<ClothInScene> cloths;
};
template <class Visitor, class Self>
void describe(Visitor& visit, Self& self, const SceneInFile*) {
    visit(Tunable{.name = "description", .meaning = "in one line"}, self.description);
    visit(Tunable{.name = "camera", .meaning = "from where to look at the beginning"}, self.camera);
    visit(Tunable{.name = "settings", .meaning = "of the world"}, self.settings);
    visit(Tunable{"step", "s", 1e-5, 1, "length of a step"}, self.step);
    visit(Tunable{"duration", "s", 0, 1e6, "how long a run lasts"}, self.duration);
    visit(Tunable{.name = "include", .meaning = "scenes whose contents come first; their settings are not used"},
          self.include);
    visit(Tunable{.name = "materials", .meaning = "surfaces by name"}, self.materials);
    visit(Tunable{.name = "bodies"}, self.bodies);
    visit(Tunable{.name = "repeat", .meaning = "one body many times, in a grid"}, self.repeat);
    visit(Tunable{.name = "walls", .meaning = "straight walls in running bond"}, self.walls);
    visit(Tunable{.name = "houses", .meaning = "four walls whose corners interlock"}, self.houses);
    visit(Tunable{.name = "towers", .meaning = "boxes on top of each other"}, self.towers);
    visit(Tunable{.name = "stairs"}, self.stairs);
    visit(Tunable{.name = "roads", .meaning = "surfaces along a line"}, self.roads);
    visit(Tunable{.name = "joints"}, self.joints);
    visit(Tunable{.name = "couplings", .meaning = "of joints: gears, racks, pulleys, tendons"}, self.couplings);
    visit(Tunable{.name = "animated", .meaning = "bodies that follow an animation with a force budget"}, self.animated);
    visit(Tunable{.name = "vehicles"}, self.vehicles);
    visit(Tunable{.name = "ragdolls"}, self.ragdolls);
    visit(Tunable{.name = "robots"}, self.robots);
    visit(Tunable{.name = "cloths", .meaning = "sheets, ropes and straps"}, self.cloths);
}

}  // namespace ragtop
