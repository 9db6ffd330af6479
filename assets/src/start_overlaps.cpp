#include "ragtop/start_overlaps.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <variant>

#include "import_text.h"
#include "ragtop/world.h"
#include "surface_crossings.h"

namespace ragtop {
namespace {

constexpr float kLyingOn = 0.05f;  ///< share of the inner radius; numbers in files are rounded, and feet are round
constexpr double kInstant = 1e-6;  ///< s, in which nothing moves
constexpr float kFarDown = 1e5f;   ///< m, beyond all grounds
constexpr std::size_t kMostLines = 5;

enum class Kind { body, vehicle, ragdoll, robot };

const char* one(Kind kind) { return std::array{"body", "vehicle", "ragdoll", "robot"}[static_cast<std::size_t>(kind)]; }
const char* many(Kind kind) {
    return std::array{"bodies", "vehicles", "ragdolls", "robots"}[static_cast<std::size_t>(kind)];
}

/// A body, car, ragdoll or robot, and the deepest of what it begins in.
struct Thing {
    Kind kind;
    std::string name;
    float depth = 0;  ///< m
    std::string inside{};
};

/// Half of the smallest side.
struct InnerRadius {
    float operator()(const Sphere& s) const { return s.radius; }
    float operator()(const Capsule& s) const { return s.radius; }
    float operator()(const Box& s) const { return std::min({s.halfExtents.x, s.halfExtents.y, s.halfExtents.z}); }
    float operator()(const ConvexHull& s) const { return ofPoints(s.vertices()); }
    float operator()(const TriangleMesh& s) const { return ofPoints(s.vertices()); }
    float operator()(const HeightField&) const { return 0; }
    float operator()(const Compound&) const { return 0; }

    static float ofPoints(std::span<const Vec3> points) {
        Vec3 lower = points[0], upper = points[0];
        for (const Vec3& point : points) {
            lower = min(lower, point);
            upper = max(upper, point);
        }
        const Vec3 size = upper - lower;
        return 0.5f * std::min({size.x, size.y, size.z});
    }
};

/// A wheel as what it would touch.
ConvexHull discOf(const WheelDef& wheel) {
    constexpr int kCorners = 24;
    std::vector<Vec3> rim;
    for (int i = 0; i < kCorners; ++i) {
        const float angle = 2 * std::numbers::pi_v<float> * static_cast<float>(i) / kCorners;
        for (const float side : {-0.5f, 0.5f})
            rim.push_back({side * wheel.width, wheel.radius * std::cos(angle), wheel.radius * std::sin(angle)});
    }
    return ConvexHull(rim);
}

/// Overlaps are parted as slowly as can be.
WorldSettings still(WorldSettings settings) {
    settings.gravity = {};
    settings.substeps = 1;
    settings.pushOut = 0.001f;
    settings.solver = SolverChoice::iterative;
    return settings;
}

/// The scene in a world of its own, whose first contacts tell what overlaps.
class Survey {
public:
    explicit Survey(const Scene& scene) : world_(still(scene.settings)), instance_(scene, world_) {
        for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
            const BodyDef& def = scene.bodies[i].def;
            add(Kind::body, scene.bodies[i].name, i);
            own(instance_.bodies[i], def.shapes.empty() ? Filter{} : def.shapes[0].filter);
            solid_.push_back(!def.shapes.empty() && !def.shapes[0].sensor);
            if (def.type == BodyType::fixed && solid_.back()) fixed_.create(def);
        }
        for (std::size_t i = 0; i < scene.vehicles.size(); ++i) {
            add(Kind::vehicle, scene.vehicles[i].name, i);
            addVehicle(instance_.vehicles[i]);
        }
        for (std::size_t i = 0; i < scene.ragdolls.size(); ++i) {
            add(Kind::ragdoll, scene.ragdolls[i].name, i);
            for (const BodyId part : instance_.ragdolls[i].bodies()) own(part, {});
        }
        for (std::size_t i = 0; i < scene.robots.size(); ++i) {
            add(Kind::robot, scene.robots[i].name, i);
            for (const BodyId body : instance_.robots[i].bodies) own(body, {});
        }
    }

    std::vector<std::string> lines() {
        findContacts();
        findBelow();
        std::vector<std::string> lines;
        for (const Kind kind : {Kind::body, Kind::vehicle, Kind::ragdoll, Kind::robot}) tell(kind, lines);
        return lines;
    }

private:
    struct Owned {
        std::size_t thing;
        Filter filter;
    };

    void add(Kind kind, const std::string& name, std::size_t index) {
        things_.push_back({kind, name.empty() ? std::to_string(index) : "\"" + name + "\""});
    }
    void own(BodyId body, const Filter& filter) { owned_.emplace(body, Owned{things_.size() - 1, filter}); }

    /// Besides the bodywork the wheels, which their struts let rise to the bump stops.
    void addVehicle(const Vehicle& vehicle) {
        const Filter& filter = vehicle.def().chassis.filter;
        const Pose chassis = world_.pose(vehicle.chassis());
        own(vehicle.chassis(), filter);
        for (const WheelDef& wheel : vehicle.def().wheels) {
            const Vec3 hub = wheel.position + wheel.suspension.travelUp * normalized(wheel.suspension.axis);
            BodyDef disc;
            disc.pose = chassis * Frame{hub, {}};
            disc.shapes.push_back({.geometry = discOf(wheel), .filter = filter});
            own(world_.create(disc), filter);
        }
    }

    float innerRadius(ShapeId shape) const { return std::visit(InnerRadius{}, world_.geometry(shape)); }
    bool moves(BodyId body) const { return world_.type(body) == BodyType::dynamic; }

    void findContacts() {
        std::map<BodyId, Pose> before;
        for (const auto& item : owned_) before[item.first] = world_.pose(item.first);
        world_.step(kInstant);
        world_.forEachContact([&](const Contact& contact) {
            const auto a = owned_.find(contact.bodyA), b = owned_.find(contact.bodyB);
            if (a == owned_.end() || b == owned_.end() || a->second.thing == b->second.thing) return;
            float depth = 0;
            for (int i = 0; i < contact.pointCount; ++i) {
                const DVec3& point = contact.points[i].point;
                const Vec3 parted = movedSince(before[b->first], b->first, point) -
                                    movedSince(before[a->first], a->first, point);
                depth = std::max(depth, dot(contact.normal, parted) - contact.points[i].separation);
            }
            if (isDeep(contact, depth)) noteOverlap(a->first, b->first, depth);
        });
    }

    /// How far the point of a body went that is at `point` now.
    Vec3 movedSince(const Pose& before, BodyId body, const DVec3& point) const {
        return relative(point, transformPoint(before, inverseTransformPoint(world_.pose(body), point)));
    }

    bool isDeep(const Contact& contact, float depth) const {
        float size = std::numeric_limits<float>::infinity();
        if (moves(contact.bodyA)) size = innerRadius(contact.shapeA);
        if (moves(contact.bodyB)) size = std::min(size, innerRadius(contact.shapeB));
        return depth > kLyingOn * size;
    }

    /// The one that moves is in the other, the later one in the earlier.
    void noteOverlap(BodyId a, BodyId b, float depth) {
        const std::size_t thingA = owned_.at(a).thing, thingB = owned_.at(b).thing;
        const bool isA = moves(a) && (!moves(b) || thingA > thingB);
        note(isA ? thingA : thingB, depth, isA ? thingB : thingA);
    }

    void note(std::size_t thing, float depth, std::size_t inside) {
        if (depth <= things_[thing].depth) return;
        things_[thing].depth = depth;
        things_[thing].inside = fmt::format("{} {}", one(things_[inside].kind), things_[inside].name);
    }

    /// Surfaces collide on their front alone, and have no inside for contacts.
    void findBelow() {
        for (const auto& [ground, owner] : owned_) {
            if (world_.type(ground) != BodyType::fixed || !isSolid(owner)) continue;
            SurfaceCrossings surfaces;
            bool isField = false;
            for (const ShapeId shape : world_.shapes(ground)) {
                const Shape& geometry = world_.geometry(shape);
                const bool field = std::holds_alternative<HeightField>(geometry);
                if (field || std::holds_alternative<TriangleMesh>(geometry))
                    surfaces.add(geometry, world_.pose(ground) * world_.frame(shape));
                isField = isField || field;
            }
            for (const auto& [body, other] : owned_) {
                if (!moves(body) || !isSolid(other) || !mayTouch(body, other.filter, ground, owner.filter)) continue;
                const DVec3 center = world_.centerOfMass(body);
                const auto behind = surfaces.behind(center);
                const bool isInside = isField || behind.between || behind.depth < innerRadius(body);
                if (isInside || !hasFloor(center)) note(other.thing, behind.depth, owner.thing);
            }
        }
    }

    float innerRadius(BodyId body) const {
        float largest = 0;
        for (const ShapeId shape : world_.shapes(body)) largest = std::max(largest, innerRadius(shape));
        return largest;
    }

    /// A sheet well above and a floor below: a roof.
    bool hasFloor(const DVec3& point) const {
        const Hit hit = fixed_.castRay({point, {0, -kFarDown, 0}});
        return static_cast<bool>(hit);
    }

    bool isSolid(const Owned& owned) const { return owned.thing >= solid_.size() || solid_[owned.thing]; }

    bool mayTouch(BodyId body, const Filter& filter, BodyId ground, const Filter& grounds) const {
        const bool sameGroup = filter.group != 0 && filter.group == grounds.group;
        const bool masksAgree = (filter.category & grounds.mask) != 0 && (grounds.category & filter.mask) != 0;
        if (sameGroup ? filter.group < 0 : !masksAgree) return false;
        const auto keepsApart = [&](JointId joint) {
            const auto& ends =
                std::visit([](const auto& kind) -> const JointBodies& { return kind.bodies; }, world_.def(joint));
            return !ends.collide && (ends.a == ground || ends.b == ground);
        };
        const auto joints = world_.jointsOf(body);
        return std::none_of(joints.begin(), joints.end(), keepsApart);
    }

    void tell(Kind kind, std::vector<std::string>& lines) const {
        std::vector<const Thing*> sunk;
        for (const Thing& thing : things_)
            if (thing.kind == kind && thing.depth > 0) sunk.push_back(&thing);
        std::sort(sunk.begin(), sunk.end(),
                  [](const Thing* a, const Thing* b) { return a->depth != b->depth ? a->depth > b->depth : a < b; });
        std::vector<std::string> texts;
        for (const Thing* thing : sunk)
            texts.push_back(fmt::format("{} {} begins about {:.2g} m inside of {}", one(kind), thing->name,
                                        thing->depth, thing->inside));
        texts = counted(texts);
        const std::size_t told = std::min(texts.size(), kMostLines);
        lines.insert(lines.end(), texts.begin(), texts.begin() + static_cast<std::ptrdiff_t>(told));
        if (texts.size() > told)
            lines.push_back(fmt::format("{} {} in all begin inside of others", sunk.size(), many(kind)));
    }

    World world_, fixed_;
    SceneInstance instance_;
    std::vector<Thing> things_;
    std::vector<bool> solid_;  ///< of the scene's bodies, which come first
    std::map<BodyId, Owned> owned_;
};

}  // namespace

std::vector<std::string> startOverlaps(const Scene& scene) { return Survey(scene).lines(); }

}  // namespace ragtop
