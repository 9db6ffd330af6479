#include <algorithm>
#include <map>
#include <set>
#include <string_view>
#include <utility>

#include "described_file.h"
#include "gltf/physics_document.h"
#include "gltf/physics_format.h"
#include "gltf/physics_joints.h"
#include "ragtop/asset_error.h"

namespace ragtop {

namespace {

std::string base64(std::span<const std::byte> bytes) {
    static constexpr std::string_view kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string text;
    for (std::size_t i = 0; i < bytes.size(); i += 3) {
        std::uint32_t three = 0;
        for (std::size_t k = 0; k < 3; ++k)
            three = three << 8 | (i + k < bytes.size() ? std::to_integer<std::uint32_t>(bytes[i + k]) : 0);
        for (std::size_t k = 0; k < 4; ++k) text += i + k > bytes.size() ? '=' : kDigits[three >> (18 - 6 * k) & 63];
    }
    return text;
}

/// Writes without what is as it is by default.
template <class T>
Json said(const T& value) {
    Json object = writeValue(value);
    const Json usual = writeValue(T{});
    for (auto it = object.begin(); it != object.end();)
        it = usual.contains(it.key()) && usual[it.key()] == *it ? object.erase(it) : std::next(it);
    return object;
}

class PhysicsWriter {
public:
    PhysicsWriter(const RagdollDef& def, const std::string& file) : def_(def), file_(file) {}

    Json write() {
        addBones();
        for (std::size_t i = 0; i < def_.parts.size(); ++i) addPart(i, parts_[i].get<std::size_t>());
        for (const RagdollJoint& joint : def_.joints) addJoint(joint);
        finish();
        addExtras(gltf_, def_, file_, [&](int mesh) { return hulls_[static_cast<std::size_t>(mesh)]; });
        return std::move(gltf_);
    }

private:
    Json& nodes() { return gltf_["nodes"]; }

    std::size_t addNode(const Frame& frame, const std::string& name) {
        Json node = Json::object();
        if (!name.empty()) node["name"] = name;
        if (frame.position != Vec3{}) node["translation"] = writeValue(frame.position);
        if (frame.rotation != Quat{}) node["rotation"] = writeValue(frame.rotation);
        nodes().push_back(std::move(node));
        return nodes().size() - 1;
    }
    std::size_t addChild(std::size_t parent, const Frame& frame, const std::string& name) {
        const std::size_t node = addNode(frame, name);
        nodes()[parent]["children"].push_back(node);
        return node;
    }
    Json& physics(std::size_t node) { return nodes()[node]["extensions"][std::string(kGltfPhysics)]; }

    /// Parts stand in the scene, so that any program moves them alike; other bones below the part that carries them.
    void addBones() {
        std::vector<int> partOf(def_.bones.size(), -1);
        for (std::size_t i = 0; i < def_.parts.size(); ++i)
            if (std::exchange(partOf[static_cast<std::size_t>(def_.parts[i].bone)], static_cast<int>(i)) >= 0)
                throw AssetError(file_, "",
                                 "is not written: part '" + def_.parts[i].name +
                                     "' has the bone of another part, must have its own");
        std::vector<std::size_t> nodeOf(def_.parts.size());
        for (std::size_t i = 0; i < def_.parts.size(); ++i)
            nodeOf[i] = addNode(def_.parts[i].bind, def_.bones[static_cast<std::size_t>(def_.parts[i].bone)].name);
        for (std::size_t i = 0; i < def_.bones.size(); ++i) {
            const RagdollBone& bone = def_.bones[i];
            if (partOf[i] >= 0) {
                bones_.push_back(nodeOf[static_cast<std::size_t>(partOf[i])]);
                continue;
            }
            const std::size_t node = addChild(nodeOf[static_cast<std::size_t>(bone.part)], bone.inPart, bone.name);
            nodes()[node]["extras"]["ragtop"]["bone"] = Json::object();
            bones_.push_back(node);
        }
        for (const std::size_t node : nodeOf) parts_.push_back(node);
    }

    /// The place of a value in a list of the file, which has each once.
    std::size_t listed(Json& list, Json value) {
        const auto found = std::find(list.begin(), list.end(), value);
        const auto place = static_cast<std::size_t>(found - list.begin());
        if (found == list.end()) list.push_back(std::move(value));
        return place;
    }

    /// Parts that pass through others are systems of their own.
    Json filterOf(int part) const {
        if (!def_.selfCollision)
            return {{"collisionSystems", {def_.parts[0].name}}, {"notCollideWithSystems", {def_.parts[0].name}}};
        const auto system = [](int one) { return "part " + std::to_string(one); };
        Json apart = Json::array();
        for (const RagdollPair& pair : def_.ignored) {
            if (pair.first == part) apart.push_back(system(pair.second));
            if (pair.second == part) apart.push_back(system(pair.first));
        }
        if (apart.empty()) return {};
        return {{"collisionSystems", {system(part)}}, {"notCollideWithSystems", std::move(apart)}};
    }

    void addPart(std::size_t index, std::size_t node) {
        const RagdollPart& part = def_.parts[index];
        physics(node)["motion"] = {{"mass", writeValue(part.mass)}};
        const std::size_t place = part.frame == Frame{} ? node : addChild(node, part.frame, "");
        Json collider{{"geometry", geometryOf(part.shape)},
                      {"physicsMaterial", listed(materials_, materialOf(part.material))}};
        if (Json filter = filterOf(static_cast<int>(index)); !filter.is_null())
            collider["collisionFilter"] = listed(filters_, std::move(filter));
        physics(place)["collider"] = std::move(collider);
    }

    Json geometryOf(const Shape& shape) {
        if (const auto* ball = std::get_if<Sphere>(&shape)) {
            return {{"shape", listed(shapes_, {{"type", "sphere"}, {"sphere", writeValue(*ball)}})}};
        } else if (const auto* box = std::get_if<Box>(&shape)) {
            return {{"shape", listed(shapes_, {{"type", "box"}, {"box", writeValue(GltfBox{2 * box->halfExtents})}})}};
        } else if (const auto* capsule = std::get_if<Capsule>(&shape)) {
            const GltfRod rod{2 * capsule->halfHeight, capsule->radius, capsule->radius};
            return {{"shape", listed(shapes_, {{"type", "capsule"}, {"capsule", writeValue(rod)}})}};
        }
        const auto vertices = std::get<ConvexHull>(shape).vertices();
        hulls_.emplace_back(vertices.begin(), vertices.end());
        return {{"mesh", hulls_.size() - 1}, {"convexHull", true}};
    }

    static Json materialOf(const Material& material) {
        const auto ruleOf = [](CombineRule rule) {
            return rule == CombineRule::minimum   ? GltfCombine::minimum
                   : rule == CombineRule::maximum ? GltfCombine::maximum
                   : rule == CombineRule::product ? GltfCombine::multiply
                                                  : GltfCombine::average;
        };
        return writeValue(GltfMaterial{material.friction, material.friction * material.slidingShare,
                                       material.restitution, ruleOf(material.frictionRule),
                                       ruleOf(material.restitutionRule)});
    }

    void addJoint(const RagdollJoint& joint) {
        const JointBodies& bodies =
            std::visit([](const auto& kind) -> const JointBodies& { return kind.bodies; }, joint.joint);
        const auto node = [&](int part) { return parts_[static_cast<std::size_t>(part)].get<std::size_t>(); };
        const std::size_t from = addChild(node(joint.parent), bodies.frameA, "");
        const std::size_t to = addChild(node(joint.child), bodies.frameB, "");
        const GltfJoint said = gltfFromJoint(joint.joint);
        Json written{{"limits", Json::array()}, {"drives", Json::array()}};
        for (const GltfLimit& limit : said.limits) written["limits"].push_back(ragtop::said(limit));
        for (const GltfDrive& drive : said.drives) {
            written["drives"].push_back(ragtop::said(drive));
            Json& last = written["drives"].back();
            last["type"] = writeValue(drive.type), last["mode"] = writeValue(drive.mode), last["axis"] = drive.axis;
        }
        Json& at = physics(from)["joint"];
        at = {{"connectedNode", to}, {"joint", listed(kinds_, std::move(written))}};
        if (bodies.collide) at["enableCollision"] = true;
        joints_.push_back(from);
    }

    /// The corners of hulls are meshes of points, in one buffer within the file.
    void addHulls() {
        std::vector<std::byte> bytes;
        for (const std::vector<Vec3>& hull : hulls_) {
            const std::span<const std::byte> raw = std::as_bytes(std::span(hull));
            const std::size_t place = gltf_["bufferViews"].size();
            gltf_["bufferViews"].push_back({{"buffer", 0}, {"byteOffset", bytes.size()}, {"byteLength", raw.size()}});
            bytes.insert(bytes.end(), raw.begin(), raw.end());
            Vec3 lower = hull.front(), upper = lower;
            for (const Vec3& v : hull) lower = min(lower, v), upper = max(upper, v);
            gltf_["accessors"].push_back({{"bufferView", place},
                                          {"componentType", 5126},
                                          {"count", hull.size()},
                                          {"type", "VEC3"},
                                          {"min", writeValue(lower)},
                                          {"max", writeValue(upper)}});
            gltf_["meshes"].push_back({{"primitives", {{{"attributes", {{"POSITION", place}}}, {"mode", 0}}}}});
        }
        if (bytes.empty()) return;
        gltf_["buffers"] = {
            {{"byteLength", bytes.size()}, {"uri", "data:application/octet-stream;base64," + base64(bytes)}}};
    }

    void finish() {
        gltf_["scenes"] = {{{"nodes", parts_}}};
        gltf_["scene"] = 0;
        addHulls();
        Json& root = gltf_["extensions"];
        Json& physics = root[std::string(kGltfPhysics)] = Json::object();
        for (const auto& [name, list] :
             {std::pair{"physicsMaterials", &materials_}, {"collisionFilters", &filters_}, {"physicsJoints", &kinds_}})
            if (!list->empty()) physics[name] = *list;
        gltf_["extensionsUsed"] = {kGltfPhysics};
        if (!shapes_.empty()) {
            root[std::string(kGltfShapes)] = {{"shapes", shapes_}};
            gltf_["extensionsUsed"].push_back(kGltfShapes);
        }
        gltf_["extras"]["ragtop"] = {{"parts", parts_}, {"joints", joints_}, {"bones", bones_}};
    }

    const RagdollDef& def_;
    const std::string& file_;
    Json gltf_{{"asset", {{"version", "2.0"}, {"generator", "ragtop"}}}, {"nodes", Json::array()}};
    Json parts_ = Json::array(), joints_ = Json::array(), bones_ = Json::array();  ///< their nodes
    Json materials_ = Json::array(), filters_ = Json::array(), shapes_ = Json::array(), kinds_ = Json::array();
    std::vector<std::vector<Vec3>> hulls_;
};

}  // namespace

Json gltfOf(const RagdollDef& def, const std::string& file) { return PhysicsWriter(def, file).write(); }

}  // namespace ragtop
