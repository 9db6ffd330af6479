#include "gltf/springs.h"

#include <optional>
#include <utility>

#include "described_file.h"

namespace ragtop {
namespace {

constexpr std::string_view kVrmSprings = "VRMC_springBone";

struct VrmJoint {
    int node = -1;
    float hitRadius = 0, stiffness = 1, gravityPower = 0, dragForce = 0.5f;
    Vec3 gravityDir{0, -1, 0};
};
struct VrmSpring {
    std::vector<VrmJoint> joints{};
    std::vector<int> colliderGroups{};
    std::optional<int> center{};
};
struct VrmRound {
    Vec3 offset{}, tail{};
    float radius = 0;
};
struct VrmShape {
    std::optional<VrmRound> sphere{}, capsule{};
};
struct VrmCollider {
    int node = -1;
    VrmShape shape{};
};
struct VrmGroup {
    std::vector<int> colliders{};
};
struct VrmFile {
    std::vector<VrmSpring> springs{};
    std::vector<VrmCollider> colliders{};
    std::vector<VrmGroup> colliderGroups{};
};
struct VrmExtensions {
    std::optional<VrmFile> springs{};
};
struct VrmGltf {
    VrmExtensions extensions{};
};

template <class Visitor, class Self>
void describe(Visitor& visit, Self& self, const VrmJoint*) {
    visit(Tunable{"node", "", 0, 1e9, "index of a node"}, self.node);
    visit(Tunable{"hitRadius", "m", 0, 1e3, "of the ball at the next joint"}, self.hitRadius);
    visit(Tunable{"stiffness", "m/s", 0, 1e5, "pull to rest"}, self.stiffness);
    visit(Tunable{"gravityPower", "m/s", 0, 1e5, "pull along gravityDir"}, self.gravityPower);
    visit(Tunable{"gravityDir", "1", -1e5, 1e5, "direction of that"}, self.gravityDir);
    visit(Tunable{"dragForce", "1", 0, 1, "share of its motion lost in a frame"}, self.dragForce);
}
template <class Visitor, class Self>
void describe(Visitor& visit, Self& self, const VrmSpring*) {
    visit(Tunable{.name = "joints", .meaning = "from the root to the tip"}, self.joints);
    visit(Tunable{"colliderGroups", "", 0, 1e9, "indices of groups"}, self.colliderGroups);
    visit(Tunable{"center", "", 0, 1e9, "index of a node"}, self.center);
}
template <class Visitor, class Self>
void describe(Visitor& visit, Self& self, const VrmRound*) {
    visit(Tunable{"offset", "m", -1e5, 1e5, "in its node"}, self.offset);
    visit(Tunable{"tail", "m", -1e5, 1e5, "other end of a capsule"}, self.tail);
    visit(Tunable{"radius", "m", 0, 1e5, "of it"}, self.radius);
}
template <class Visitor, class Self>
void describe(Visitor& visit, Self& self, const VrmShape*) {
    visit(Tunable{.name = "sphere"}, self.sphere);
    visit(Tunable{.name = "capsule"}, self.capsule);
}
template <class Visitor, class Self>
void describe(Visitor& visit, Self& self, const VrmCollider*) {
    visit(Tunable{"node", "", 0, 1e9, "index of a node"}, self.node);
    visit(Tunable{.name = "shape"}, self.shape);
}
template <class Visitor, class Self>
void describe(Visitor& visit, Self& self, const VrmGroup*) {
    visit(Tunable{"colliders", "", 0, 1e9, "indices of colliders"}, self.colliders);
}
template <class Visitor, class Self>
void describe(Visitor& visit, Self& self, const VrmFile*) {
    visit(Tunable{.name = "springs"}, self.springs);
    visit(Tunable{.name = "colliders"}, self.colliders);
    visit(Tunable{.name = "colliderGroups"}, self.colliderGroups);
}
template <class Visitor, class Self>
void describe(Visitor& visit, Self& self, const VrmExtensions*) {
    visit(Tunable{.name = kVrmSprings}, self.springs);
}
template <class Visitor, class Self>
void describe(Visitor& visit, Self& self, const VrmGltf*) {
    visit(Tunable{.name = "extensions"}, self.extensions);
}
std::vector<const char*> requiredFields(const VrmJoint*) { return {"node"}; }
std::vector<const char*> requiredFields(const VrmCollider*) { return {"node", "shape"}; }

void requireNode(const JsonValue& at, std::size_t nodes) {
    const auto node = at.json().get<std::size_t>();
    if (node >= nodes) at.fail("is " + std::to_string(node) + ", must be one of " + std::to_string(nodes) + " nodes");
}

void addSpring(const VrmSpring& spring, const JsonValue& at, std::size_t nodes, ImportedSprings& to) {
    for (std::size_t i = 0; i < spring.joints.size(); ++i) requireNode(at.at("joints").at(i).at("node"), nodes);
    // The last joint is where the one before it ends, and no bone that swings.
    for (std::size_t i = 0; i + 1 < spring.joints.size(); ++i) {
        const VrmJoint& joint = spring.joints[i];
        to.bones.push_back({joint.node, spring.joints[i + 1].node, joint.stiffness, joint.gravityPower, joint.dragForce,
                            joint.hitRadius, joint.gravityDir, spring.center ? 1 : 0});
    }
}

void addCollider(const VrmCollider& collider, const JsonValue& at, std::size_t nodes, ImportedSprings& to) {
    requireNode(at.at("node"), nodes);
    if (collider.shape.sphere.has_value() == collider.shape.capsule.has_value())
        at.at("shape").fail("has not one of sphere and capsule, must have");
    const VrmRound& round = collider.shape.sphere ? *collider.shape.sphere : *collider.shape.capsule;
    to.colliders.push_back(
        {collider.node, round.offset, collider.shape.sphere ? round.offset : round.tail, round.radius});
}

}  // namespace

ImportedSprings readGltfSprings(const JsonDocument& gltf) {
    ImportedSprings springs;
    const JsonValue json(gltf);
    const auto file = readOpenDocument<VrmGltf>(gltf);
    if (!file.extensions.springs) return springs;
    const std::size_t nodes = json.has("nodes") ? json.at("nodes").size() : 0;
    const VrmFile& vrm = *file.extensions.springs;
    const JsonValue at = json.at("extensions").at(std::string(kVrmSprings));
    for (std::size_t i = 0; i < vrm.springs.size(); ++i)
        addSpring(vrm.springs[i], at.at("springs").at(i), nodes, springs);
    for (std::size_t i = 0; i < vrm.colliders.size(); ++i)
        addCollider(vrm.colliders[i], at.at("colliders").at(i), nodes, springs);
    for (const VrmSpring& spring : vrm.springs)
        springs.grouped = springs.grouped || spring.colliderGroups != vrm.springs.front().colliderGroups;
    return springs;
}

}  // namespace ragtop
