#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "ragtop/math.h"
#include "ragtop/tunables.h"

/// What is read of a glTF file beside its looks, as it stands there: nodes with KHR_physics_rigid_bodies, and the
/// shapes of KHR_implicit_shapes [Khronos, drafts of 2024]. Units are m, kg, s, rad; members that are not named here
/// are passed over.
namespace ragtop {

enum class GltfDriveType : std::uint8_t { linear, angular };
constexpr std::array<std::string_view, 2> enumNames(GltfDriveType) { return {"linear", "angular"}; }
enum class GltfDriveMode : std::uint8_t { force, acceleration };
constexpr std::array<std::string_view, 2> enumNames(GltfDriveMode) { return {"force", "acceleration"}; }
enum class GltfCombine : std::uint8_t { average, minimum, maximum, multiply };
constexpr std::array<std::string_view, 4> enumNames(GltfCombine) {
    return {"average", "minimum", "maximum", "multiply"};
}
enum class GltfShapeType : std::uint8_t { sphere, box, capsule, cylinder, plane };
constexpr std::array<std::string_view, 5> enumNames(GltfShapeType) {
    return {"sphere", "box", "capsule", "cylinder", "plane"};
}

/// A bound of one, two or three axes together; absent ends do not bound, absent stiffness is a hard stop.
struct GltfLimit {
    std::optional<float> min{}, max{}, stiffness{};
    float damping = 0;
    std::vector<int> linearAxes{}, angularAxes{};
};
/// A damped spring along or about one axis.
struct GltfDrive {
    GltfDriveType type = GltfDriveType::angular;
    GltfDriveMode mode = GltfDriveMode::force;
    int axis = 0;
    std::optional<float> maxForce{};
    float positionTarget = 0, velocityTarget = 0, stiffness = 0, damping = 0;
};
struct GltfJoint {
    std::vector<GltfLimit> limits{};
    std::vector<GltfDrive> drives{};
};

struct GltfMaterial {
    float staticFriction = 0.6f, dynamicFriction = 0.6f, restitution = 0;
    GltfCombine frictionCombine = GltfCombine::average, restitutionCombine = GltfCombine::average;
};
struct GltfFilter {
    std::vector<std::string> collisionSystems{}, collideWithSystems{}, notCollideWithSystems{};
};

/// Centres and sizes are those of the extension: about the origin, round shapes along y.
struct GltfBall {
    float radius = 0.5f;
};
struct GltfBox {
    Vec3 size{1, 1, 1};
};
struct GltfRod {
    float height = 0.5f, radiusBottom = 0.25f, radiusTop = 0.25f;
};
struct GltfShape {
    GltfShapeType type = GltfShapeType::sphere;
    GltfBall sphere{};
    GltfBox box{};
    GltfRod capsule{}, cylinder{};
};

struct GltfMotion {
    bool isKinematic = false;
    std::optional<float> mass{};
    std::optional<Vec3> centerOfMass{}, inertiaDiagonal{}, linearVelocity{}, angularVelocity{};
    float gravityFactor = 1;
};
struct GltfGeometry {
    std::optional<int> shape{}, mesh{}, node{};
    bool convexHull = false;
};
struct GltfCollider {
    GltfGeometry geometry{};
    std::optional<int> physicsMaterial{}, collisionFilter{};
};
struct GltfNodeJoint {
    int connectedNode = -1, joint = -1;
    bool enableCollision = false;
};
struct GltfNodePhysics {
    std::optional<GltfMotion> motion{};
    std::optional<GltfCollider> collider{};
    std::optional<GltfNodeJoint> joint{};
};
struct GltfNodeExtensions {
    std::optional<GltfNodePhysics> physics{};
};
struct GltfNode {
    std::string name{};
    std::vector<int> children{};
    std::optional<int> mesh{};
    Vec3 translation{}, scale{1, 1, 1};
    Quat rotation{};
    std::optional<std::array<float, 16>> matrix{};
    GltfNodeExtensions extensions{};
};

struct GltfFilePhysics {
    std::vector<GltfMaterial> physicsMaterials{};
    std::vector<GltfFilter> collisionFilters{};
    std::vector<GltfJoint> physicsJoints{};
};
struct GltfFileShapes {
    std::vector<GltfShape> shapes{};
};
struct GltfFileExtensions {
    GltfFilePhysics physics{};
    GltfFileShapes shapes{};
};
struct GltfFile {
    std::vector<GltfNode> nodes{};
    GltfFileExtensions extensions{};
};

inline constexpr std::string_view kGltfPhysics = "KHR_physics_rigid_bodies", kGltfShapes = "KHR_implicit_shapes";

template <class Visitor, class Self>
void describe(Visitor& visit, Self& self, const GltfLimit*) {
    visit(Tunable{"min", "m or rad", -1e5, 1e5, "least distance or angle"}, self.min);
    visit(Tunable{"max", "m or rad", -1e5, 1e5, "greatest distance or angle"}, self.max);
    visit(Tunable{"stiffness", "N/m or N m/rad", 0, 1e12, "beyond the ends; absent: hard"}, self.stiffness);
    visit(Tunable{"damping", "N s/m or N m s/rad", 0, 1e12, "beyond the ends"}, self.damping);
    visit(Tunable{"linearAxes", "", 0, 2, "axes along which it bounds"}, self.linearAxes);
    visit(Tunable{"angularAxes", "", 0, 2, "axes about which it bounds"}, self.angularAxes);
}
template <class Visitor, class Self>
void describe(Visitor& visit, Self& self, const GltfDrive*) {
    visit(Tunable{.name = "type", .meaning = "along or about its axis"}, self.type);
    visit(Tunable{.name = "mode", .meaning = "force, or acceleration of the inertia that the joint moves"}, self.mode);
    visit(Tunable{"axis", "", 0, 2, "of the joint's frame"}, self.axis);
    visit(Tunable{"maxForce", "N or N m", 0, 3.5e38, "bound; absent: none"}, self.maxForce);
    visit(Tunable{"positionTarget", "m or rad", -1e5, 1e5, "to pull to"}, self.positionTarget);
    visit(Tunable{"velocityTarget", "m/s or rad/s", -1e5, 1e5, "to reach"}, self.velocityTarget);
    visit(Tunable{"stiffness", "N/m or N m/rad", 0, 1e12, "per displacement"}, self.stiffness);
    visit(Tunable{"damping", "N s/m or N m s/rad", 0, 1e12, "per speed"}, self.damping);
}
template <class Visitor, class Self>
void describe(Visitor& visit, Self& self, const GltfJoint*) {
    visit(Tunable{.name = "limits", .meaning = "what it holds"}, self.limits);
    visit(Tunable{.name = "drives", .meaning = "what moves it"}, self.drives);
}
template <class Visitor, class Self>
void describe(Visitor& visit, Self& self, const GltfMaterial*) {
    visit(Tunable{"staticFriction", "1", 0, 10, "coefficient at rest"}, self.staticFriction);
    visit(Tunable{"dynamicFriction", "1", 0, 10, "coefficient while sliding"}, self.dynamicFriction);
    visit(Tunable{"restitution", "1", 0, 1, "speed after over speed before an impact"}, self.restitution);
    visit(Tunable{.name = "frictionCombine", .meaning = "of two surfaces"}, self.frictionCombine);
    visit(Tunable{.name = "restitutionCombine", .meaning = "of two surfaces"}, self.restitutionCombine);
}
template <class Visitor, class Self>
void describe(Visitor& visit, Self& self, const GltfFilter*) {
    visit(Tunable{.name = "collisionSystems", .meaning = "what it is one of"}, self.collisionSystems);
    visit(Tunable{.name = "collideWithSystems", .meaning = "what alone it meets"}, self.collideWithSystems);
    visit(Tunable{.name = "notCollideWithSystems", .meaning = "what it does not meet"}, self.notCollideWithSystems);
}
template <class Visitor, class Self>
void describe(Visitor& visit, Self& self, const GltfBall*) {
    visit(Tunable{"radius", "m", 1e-4, 1e5, "of the ball"}, self.radius);
}
template <class Visitor, class Self>
void describe(Visitor& visit, Self& self, const GltfBox*) {
    visit(Tunable{"size", "m", 2e-4, 2e5, "along x, y, z"}, self.size);
}
template <class Visitor, class Self>
void describe(Visitor& visit, Self& self, const GltfRod*) {
    visit(Tunable{"height", "m", 0, 2e5, "between the centres of caps, or the ends"}, self.height);
    visit(Tunable{"radiusBottom", "m", 0, 1e5, "at −y"}, self.radiusBottom);
    visit(Tunable{"radiusTop", "m", 0, 1e5, "at +y"}, self.radiusTop);
}
template <class Visitor, class Self>
void describe(Visitor& visit, Self& self, const GltfShape*) {
    visit(Tunable{.name = "type"}, self.type);
    visit(Tunable{.name = "sphere"}, self.sphere);
    visit(Tunable{.name = "box"}, self.box);
    visit(Tunable{.name = "capsule"}, self.capsule);
    visit(Tunable{.name = "cylinder"}, self.cylinder);
}
template <class Visitor, class Self>
void describe(Visitor& visit, Self& self, const GltfMotion*) {
    visit(Tunable{.name = "isKinematic", .meaning = "nothing moves it"}, self.isKinematic);
    visit(Tunable{"mass", "kg", 0, 1e9, "absent: by volume; 0: infinite"}, self.mass);
    visit(Tunable{"centerOfMass", "m", -1e5, 1e5, "in the node"}, self.centerOfMass);
    visit(Tunable{"inertiaDiagonal", "kg m2", 0, 1e12, "principal moments"}, self.inertiaDiagonal);
    visit(Tunable{"linearVelocity", "m/s", -1e5, 1e5, "to begin with"}, self.linearVelocity);
    visit(Tunable{"angularVelocity", "rad/s", -1e5, 1e5, "to begin with"}, self.angularVelocity);
    visit(Tunable{"gravityFactor", "1", -1e5, 1e5, "times gravity"}, self.gravityFactor);
}
template <class Visitor, class Self>
void describe(Visitor& visit, Self& self, const GltfGeometry*) {
    visit(Tunable{"shape", "", 0, 1e9, "index of a shape"}, self.shape);
    visit(Tunable{"mesh", "", 0, 1e9, "index of a mesh"}, self.mesh);
    visit(Tunable{"node", "", 0, 1e9, "index of a node with a mesh"}, self.node);
    visit(Tunable{.name = "convexHull", .meaning = "its hull collides"}, self.convexHull);
}
template <class Visitor, class Self>
void describe(Visitor& visit, Self& self, const GltfCollider*) {
    visit(Tunable{.name = "geometry"}, self.geometry);
    visit(Tunable{"physicsMaterial", "", 0, 1e9, "index of a material"}, self.physicsMaterial);
    visit(Tunable{"collisionFilter", "", 0, 1e9, "index of a filter"}, self.collisionFilter);
}
template <class Visitor, class Self>
void describe(Visitor& visit, Self& self, const GltfNodeJoint*) {
    visit(Tunable{"connectedNode", "", 0, 1e9, "index of the node at the other end"}, self.connectedNode);
    visit(Tunable{"joint", "", 0, 1e9, "index of a joint"}, self.joint);
    visit(Tunable{.name = "enableCollision", .meaning = "do the two bodies collide?"}, self.enableCollision);
}
template <class Visitor, class Self>
void describe(Visitor& visit, Self& self, const GltfNodePhysics*) {
    visit(Tunable{.name = "motion"}, self.motion);
    visit(Tunable{.name = "collider"}, self.collider);
    visit(Tunable{.name = "joint"}, self.joint);
}
template <class Visitor, class Self>
void describe(Visitor& visit, Self& self, const GltfNodeExtensions*) {
    visit(Tunable{.name = kGltfPhysics}, self.physics);
}
template <class Visitor, class Self>
void describe(Visitor& visit, Self& self, const GltfNode*) {
    visit(Tunable{.name = "name"}, self.name);
    visit(Tunable{"children", "", 0, 1e9, "indices of nodes"}, self.children);
    visit(Tunable{"mesh", "", 0, 1e9, "index of a mesh"}, self.mesh);
    visit(Tunable{"translation", "m", -1e5, 1e5, "in its parent"}, self.translation);
    visit(Tunable{"scale", "1", -1e5, 1e5, "of what is in it"}, self.scale);
    visit(Tunable{.name = "rotation"}, self.rotation);
    visit(Tunable{"matrix", "", -1e5, 1e5, "in its parent, column by column"}, self.matrix);
    visit(Tunable{.name = "extensions"}, self.extensions);
}
template <class Visitor, class Self>
void describe(Visitor& visit, Self& self, const GltfFilePhysics*) {
    visit(Tunable{.name = "physicsMaterials"}, self.physicsMaterials);
    visit(Tunable{.name = "collisionFilters"}, self.collisionFilters);
    visit(Tunable{.name = "physicsJoints"}, self.physicsJoints);
}
template <class Visitor, class Self>
void describe(Visitor& visit, Self& self, const GltfFileShapes*) {
    visit(Tunable{.name = "shapes"}, self.shapes);
}
template <class Visitor, class Self>
void describe(Visitor& visit, Self& self, const GltfFileExtensions*) {
    visit(Tunable{.name = kGltfPhysics}, self.physics);
    visit(Tunable{.name = kGltfShapes}, self.shapes);
}
template <class Visitor, class Self>
void describe(Visitor& visit, Self& self, const GltfFile*) {
    visit(Tunable{.name = "nodes"}, self.nodes);
    visit(Tunable{.name = "extensions"}, self.extensions);
}

inline std::vector<const char*> requiredFields(const GltfDrive*) { return {"type", "mode", "axis"}; }
inline std::vector<const char*> requiredFields(const GltfShape*) { return {"type"}; }
inline std::vector<const char*> requiredFields(const GltfCollider*) { return {"geometry"}; }
inline std::vector<const char*> requiredFields(const GltfNodeJoint*) { return {"connectedNode", "joint"}; }

}  // namespace ragtop
