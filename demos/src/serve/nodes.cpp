#include "nodes.h"

#include <algorithm>
#include <iterator>

#include "ragtop/surface_mesh.h"
#include "ragtop/world.h"

namespace ragtop::live {
namespace {

constexpr Color kTire = 0x2b2d31, kBall = 0x4a5058;

/// Tints that tell neighbours apart.
Color defaultColor(BodyId body, BodyType type) {
    static constexpr Color kTints[] = {0xd98c4a, 0xc9793b, 0xe0a060, 0xb86a35, 0xd0925c};
    if (type == BodyType::fixed) return 0xb3b5ab;
    if (type == BodyType::kinematic) return 0x5f86c0;
    return kTints[body.index % std::size(kTints)];
}

Json meshJson(const SurfaceMesh& mesh) {
    Json positions = Json::array(), indices = Json::array();
    for (const Vec3& v : mesh.vertices) {
        for (int i = 0; i < 3; ++i) positions.push_back(number(v[i]));
    }
    for (const std::uint32_t index : mesh.indices) indices.push_back(index);
    return {{"kind", "mesh"}, {"positions", std::move(positions)}, {"indices", std::move(indices)}};
}

struct GeometryJson {
    Json operator()(const Box& box) const { return {{"kind", "box"}, {"half", array(box.halfExtents)}}; }
    Json operator()(const Sphere& ball) const { return {{"kind", "sphere"}, {"radius", number(ball.radius)}}; }
    Json operator()(const Capsule& c) const {
        return {{"kind", "capsule"}, {"radius", number(c.radius)}, {"halfHeight", number(c.halfHeight)}};
    }
    template <class Surface>
    Json operator()(const Surface& surface) const {
        return meshJson(surfaceOf(surface));
    }
};

/// Equal for shapes that look the same; large ones share their data.
struct GeometryKey {
    std::string operator()(const ConvexHull& shape) const { return address(&shape.data()); }
    std::string operator()(const TriangleMesh& shape) const { return address(&shape.data()); }
    std::string operator()(const HeightField& shape) const { return address(&shape.data()); }
    template <class Small>
    std::string operator()(const Small& shape) const {
        return text(GeometryJson()(shape));
    }
    static std::string address(const void* data) { return std::to_string(reinterpret_cast<std::uintptr_t>(data)); }
};

/// A cylinder along x.
SurfaceMesh tireMesh(float radius, float width) {
    constexpr std::uint32_t kAround = 24;
    SurfaceMesh mesh;
    for (std::uint32_t i = 0; i < kAround; ++i) {
        const SinCos a = sinCos(2 * kPi * static_cast<float>(i) / static_cast<float>(kAround));
        for (const float x : {-0.5f * width, 0.5f * width})
            mesh.vertices.push_back({x, radius * a.cos, radius * a.sin});
    }
    const std::uint32_t inner = 2 * kAround;
    mesh.vertices.push_back({-0.5f * width, 0, 0});
    mesh.vertices.push_back({0.5f * width, 0, 0});
    for (std::uint32_t i = 0; i < kAround; ++i) {
        const std::uint32_t a = 2 * i, b = 2 * ((i + 1) % kAround);
        for (const std::uint32_t v : {a, b, a + 1, a + 1, b, b + 1, inner, b, a, inner + 1, a + 1, b + 1}) {
            mesh.indices.push_back(v);
        }
    }
    return mesh;
}

}  // namespace

const char* typeName(BodyType type) {
    return type == BodyType::fixed ? "static" : type == BodyType::kinematic ? "kinematic" : "dynamic";
}

Nodes::Nodes(const Cast& cast, const Hand& hand, const DVec3& origin) : cast_(cast), hand_(hand), origin_(origin) {
    for (const BodyId body : cast_.world->bodies()) {
        present_.push_back(body);
        presentNodes_.push_back(add(body));
    }
    addWheels();
    hide();
}

std::size_t Nodes::geometry(const Shape& shape) {
    const std::string key = std::visit(
        [](const auto& s) {
            if constexpr (std::is_same_v<std::remove_cvref_t<decltype(s)>, Compound>)
                return std::string();
            else
                return GeometryKey()(s);
        },
        shape);
    const auto [found, isNew] = geometryOf_.try_emplace(key, geometries_.size());
    if (isNew) {
        geometries_.push_back(std::visit(
            [](const auto& s) -> Json {
                if constexpr (std::is_same_v<std::remove_cvref_t<decltype(s)>, Compound>)
                    return nullptr;
                else
                    return GeometryJson()(s);
            },
            shape));
    }
    return found->second;
}

void Nodes::addPart(const Shape& shape, const Frame& frame, Json& parts) {
    parts.push_back(
        {{"geometry", geometry(shape)}, {"position", array(frame.position)}, {"rotation", array(frame.rotation)}});
}

std::uint32_t Nodes::add(BodyId body) {
    const World& world = *cast_.world;
    Node node;
    node.body = body;
    const BodyType type = world.type(body);
    node.type = typeName(type);
    const Look look = hand_.isBall(body) ? Look{"ball", kBall} : cast_.look ? cast_.look(body) : Look{};
    const auto number = static_cast<std::uint32_t>(known_.size());
    node.name = look.name.empty() ? "body " + std::to_string(number) : look.name;
    node.color = look.color.value_or(defaultColor(body, type));
    for (const ShapeId shape : world.shapes(body)) {
        if (!world.givesWay(shape)) addPart(world.geometry(shape), world.frame(shape), node.parts);
    }
    known_.push_back(std::move(node));
    numbers_[body] = number;
    return number;
}

void Nodes::addWheels() {
    for (std::size_t v = 0; v < cast_.vehicles.size(); ++v) {
        const VehicleDef& def = cast_.vehicles[v].vehicle->def();
        wheels_.emplace_back();
        for (std::size_t w = 0; w < def.wheels.size(); ++w) {
            Node node;
            node.vehicle = static_cast<int>(v);
            node.wheel = static_cast<int>(w);
            node.type = "wheel";
            node.color = kTire;
            node.name = cast_.vehicles[v].name + " " +
                        (def.wheels[w].name.empty() ? "wheel " + std::to_string(w) : def.wheels[w].name);
            const std::string key =
                "wheel " + text(number(def.wheels[w].radius)) + " " + text(number(def.wheels[w].width));
            const auto [found, isNew] = geometryOf_.try_emplace(key, geometries_.size());
            if (isNew) geometries_.push_back(meshJson(tireMesh(def.wheels[w].radius, def.wheels[w].width)));
            node.parts.push_back(
                {{"geometry", found->second}, {"position", array(Vec3{})}, {"rotation", array(Quat{})}});
            wheels_.back().push_back(static_cast<std::uint32_t>(known_.size()));
            known_.push_back(std::move(node));
        }
    }
}

/// What visuals are drawn for is not drawn itself.
void Nodes::hide() {
    for (const CastVisual& visual : cast_.visuals) {
        for (const auto& item : visual.nodes) {
            if (visual.kind == CastVisual::Kind::skin) {
                const BodyId body =
                    cast_.ragdolls[visual.index].ragdoll->bodies()[static_cast<std::size_t>(item.second)];
                known_[numbers_.at(body)].hidden = true;
            } else if (item.second < 0) {
                known_[numbers_.at(cast_.vehicles[visual.index].vehicle->chassis())].hidden = true;
            } else {
                known_[wheels_[visual.index][static_cast<std::size_t>(item.second)]].hidden = true;
            }
        }
    }
}

Json Nodes::refresh(std::uint64_t timeline) {
    const auto bodies = cast_.world->bodies();
    const bool same = std::equal(bodies.begin(), bodies.end(), present_.begin(), present_.end());
    if (timeline != timeline_) {
        std::erase_if(numbers_, [&](const auto& item) {
            return !std::binary_search(present_.begin(), present_.end(), item.first);
        });
        timeline_ = timeline;
    }
    if (same) return nullptr;
    const std::size_t firstGeometry = geometries_.size();
    std::vector<std::uint32_t> now;
    Json added = Json::array(), removed = Json::array(), fresh = Json::array();
    for (const BodyId body : bodies) {
        const auto known = numbers_.find(body);
        now.push_back(known != numbers_.end() ? known->second : add(body));
    }
    for (std::size_t i = 0; i < now.size(); ++i) {
        if (!std::binary_search(present_.begin(), present_.end(), bodies[i])) added.push_back(describe(now[i]));
    }
    for (std::size_t i = 0; i < present_.size(); ++i) {
        if (!cast_.world->isValid(present_[i])) removed.push_back(presentNodes_[i]);
    }
    for (std::size_t i = firstGeometry; i < geometries_.size(); ++i) fresh.push_back(geometries_[i]);
    present_.assign(bodies.begin(), bodies.end());
    presentNodes_ = std::move(now);
    return {{"type", "nodes"},
            {"added", std::move(added)},
            {"geometries", std::move(fresh)},
            {"removed", std::move(removed)}};
}

Pose Nodes::poseOf(const Node& node) const {
    if (node.wheel < 0) return cast_.world->pose(node.body);
    const Vehicle& car = *cast_.vehicles[static_cast<std::size_t>(node.vehicle)].vehicle;
    return car.telemetry().wheels[static_cast<std::size_t>(node.wheel)].pose;
}

Json Nodes::describe(std::uint32_t number) const {
    const Node& node = known_[number];
    Json json{{"node", number},      {"body", node.wheel < 0 ? Json(node.body.index) : Json(nullptr)},
              {"name", node.name},   {"type", node.type},
              {"color", node.color}, {"pose", array(poseOf(node), origin_)},
              {"parts", node.parts}};
    if (node.hidden) json["hidden"] = true;
    return json;
}

Json Nodes::describe() const {
    Json nodes = Json::array();
    for (const std::uint32_t node : presentNodes_) nodes.push_back(describe(node));
    for (const auto& car : wheels_) {
        for (const std::uint32_t node : car) nodes.push_back(describe(node));
    }
    return nodes;
}

Json Nodes::vehicles() const {
    Json vehicles = Json::array();
    for (std::size_t v = 0; v < cast_.vehicles.size(); ++v) {
        vehicles.push_back({{"name", cast_.vehicles[v].name},
                            {"chassis", numbers_.at(cast_.vehicles[v].vehicle->chassis())},
                            {"wheels", wheels_[v]}});
    }
    return vehicles;
}

Json Nodes::ragdolls() const {
    Json ragdolls = Json::array();
    for (const CastRagdoll& each : cast_.ragdolls) {
        const RagdollDef& def = each.ragdoll->def();
        std::vector<int> parents(def.parts.size(), -1);
        for (const RagdollJoint& joint : def.joints) parents[static_cast<std::size_t>(joint.child)] = joint.parent;
        Json parts = Json::array();
        for (std::size_t i = 0; i < def.parts.size(); ++i) {
            parts.push_back({{"node", numbers_.at(each.ragdoll->bodies()[i])},
                             {"name", def.parts[i].name},
                             {"parent", parents[i]}});
        }
        ragdolls.push_back({{"name", each.name}, {"parts", std::move(parts)}});
    }
    return ragdolls;
}

Json Nodes::visuals() const {
    Json visuals = Json::array();
    for (const CastVisual& visual : cast_.visuals) {
        const bool isSkin = visual.kind == CastVisual::Kind::skin;
        Json nodes = Json::object();
        for (const auto& [name, index] : visual.nodes) {
            const auto i = static_cast<std::size_t>(index);
            nodes[name] = isSkin      ? numbers_.at(cast_.ragdolls[visual.index].ragdoll->bodies()[i])
                          : index < 0 ? numbers_.at(cast_.vehicles[visual.index].vehicle->chassis())
                                      : wheels_[visual.index][i];
        }
        visuals.push_back(
            {{"url", "/visual/" + visual.file}, {"kind", isSkin ? "skin" : "car"}, {"nodes", std::move(nodes)}});
    }
    return visuals;
}

std::span<const NodePose> Nodes::poses() {
    poses_.clear();
    for (std::size_t i = 0; i < present_.size(); ++i)
        poses_.push_back({presentNodes_[i], cast_.world->pose(present_[i])});
    for (const auto& car : wheels_) {
        for (const std::uint32_t node : car) poses_.push_back({node, poseOf(known_[node])});
    }
    return poses_;
}

BodyId Nodes::body(std::uint32_t node) const {
    if (node >= known_.size() || known_[node].wheel >= 0) return {};
    return cast_.world->isValid(known_[node].body) ? known_[node].body : BodyId{};
}

std::optional<std::uint32_t> Nodes::node(BodyId body) const {
    const auto found = numbers_.find(body);
    return found == numbers_.end() ? std::nullopt : std::optional(found->second);
}

}  // namespace ragtop::live
