#include "meddle.h"

#include <algorithm>
#include <cmath>

#include "laws.h"

namespace ragtop::laws {
namespace {

constexpr double kStep = 1.0 / 60;
constexpr int kMeddled = 300, kSettling = 60, kWatched = 300;  ///< steps: meddled with, left alone, and looked at
constexpr float kFastest = 300;  ///< m/s; nothing is pushed to more than 20, nor falls for longer than a few seconds
constexpr double kGap = 0.05;    ///< m, as of the law

class Meddler {
public:
    Meddler(const Drawn& drawn, std::uint64_t seed)
        : isWatched_(!isDriven(drawn) && drawn.scene.vehicles.empty() && !hasSprings(drawn.scene)),
          dice_(seed),
          world_(settingsOf(drawn)),
          instance_(drawn.scene, world_) {
        for (const BodyId body : instance_.bodies)
            if (world_.type(body) == BodyType::dynamic) bodies_.push_back(body);
        joints_ = instance_.joints;
    }

    std::vector<std::string> run() {
        for (int i = 0; i < kMeddled; ++i) {
            if (dice_.below(12) == 0) act();
            const double exponent = static_cast<double>(dice_.between(0, 1));
            if (!step(std::pow(16.0, exponent) / 240)) return broken_;
        }
        for (const BodyId body : bodies_) {
            world_.setGravityScale(body, 1);
            world_.setEnabled(body, true);
            world_.setType(body, BodyType::dynamic);
        }
        for (int i = 0; i < kSettling; ++i)
            if (!step(kStep)) return broken_;
        watch();
        return broken_;
    }

private:
    static WorldSettings settingsOf(const Drawn& drawn) {
        WorldSettings settings;
        settings.gravity = drawn.scene.settings.gravity;
        return settings;
    }
    /// What these hold is not counted.
    static bool hasSprings(const Scene& scene) {
        return std::ranges::any_of(scene.joints, [](const SceneJoint& joint) {
            const auto* ball = std::get_if<BallDef>(&joint.def);
            return ball != nullptr && ball->spring;
        });
    }
    BodyId anyBody() { return bodies_[dice_.below(static_cast<std::uint32_t>(bodies_.size()))]; }
    Vec3 anyWay(float length) {
        return length * normalized(Vec3{dice_.between(-1, 1), dice_.between(-1, 1), dice_.between(-1, 1)}, {0, 1, 0});
    }

    void act() {
        if (bodies_.size() < 2) return;
        const BodyId body = anyBody();
        if (!world_.isEnabled(body)) return world_.setEnabled(body, true);
        if (world_.type(body) != BodyType::dynamic) return world_.setType(body, BodyType::dynamic);
        switch (dice_.below(14)) {
            case 0:
                return create();
            case 1:
                std::erase(bodies_, body);
                return world_.destroy(body);
            case 2:
                return separate();
            case 3:
                return world_.setPose(body,
                                      {world_.pose(body).position + DVec3{anyWay(1)}, world_.pose(body).rotation});
            case 4:
                return world_.applyImpulse(body, world_.mass(body).mass * anyWay(dice_.between(1, 20)),
                                           world_.centerOfMass(body));
            case 5:
                return world_.setVelocity(body, anyWay(dice_.between(0, 10)), anyWay(dice_.between(0, 20)));
            case 6:
                return reweigh(body);
            case 7:
                return join(body, anyBody());
            case 8:
                return goBack();
            case 9:
                return world_.sleep(body);
            case 10:  // what goes on for ever may pull at others without a bound
                world_.setType(body, BodyType::kinematic);
                return world_.setVelocity(body, {}, {});
            case 11:
                return world_.setType(body, BodyType::fixed);
            case 12:
                return world_.setEnabled(body, false);
            default:
                return world_.setGravityScale(body, dice_.below(3) == 0 ? 0.0f : 1.0f);
        }
    }
    void create() {
        BodyDef def;
        def.shapes.push_back(
            {.geometry = Box{{dice_.between(0.1f, 0.5f), dice_.between(0.1f, 0.5f), dice_.between(0.1f, 0.5f)}}});
        def.pose = {world_.pose(anyBody()).position + DVec3{anyWay(1)}, dice_.rotation()};
        bodies_.push_back(world_.create(def));
    }
    void separate() {
        if (joints_.empty()) return;
        const std::size_t at = dice_.below(static_cast<std::uint32_t>(joints_.size()));
        if (world_.isValid(joints_[at])) world_.destroy(joints_[at]);
        joints_.erase(joints_.begin() + static_cast<std::ptrdiff_t>(at));
    }
    void reweigh(BodyId body) {
        MassProperties mass = world_.mass(body);
        const float times = std::pow(10.0f, dice_.between(-2, 2));
        mass.mass *= times;
        mass.inertia = {times * mass.inertia.cx, times * mass.inertia.cy, times * mass.inertia.cz};
        // Nobody makes a pebble of a mountain by chance for long.
        if (mass.mass > 1e-2f && mass.mass < 1e6f) world_.setMass(body, mass);
    }
    void join(BodyId a, BodyId b) {
        if (a == b || world_.type(b) != BodyType::dynamic) return;
        const DVec3 point = 0.5 * (world_.pose(a).position + world_.pose(b).position);
        const auto frame = [&](BodyId body) {
            const Pose pose = world_.pose(body);
            return Frame{inverseRotate(pose.rotation, toVec3(point - pose.position)), conjugate(pose.rotation)};
        };
        const JointBodies joined{
            .a = a, .b = b, .frameA = frame(a), .frameB = frame(b), .collide = dice_.below(2) == 0};
        joints_.push_back(dice_.below(2) == 0 ? world_.create(BallDef{.bodies = joined})
                                              : world_.create(HingeDef{.bodies = joined}));
    }
    void goBack() {
        std::vector<std::byte> kept(world_.saveSize());
        kept.resize(world_.save(kept));
        const std::uint64_t hash = world_.hash();
        for (int i = 0; i < 3; ++i) world_.step(kStep);
        world_.restore(kept);
        if (world_.hash() != hash) breaks("restored");
    }

    void breaks(const std::string& law) {
        if (std::ranges::find(broken_, law) == broken_.end()) broken_.push_back(law);
    }
    /// False where the world has fallen to pieces, after which nothing else means anything.
    bool step(double dt) {
        world_.step(dt);
        std::erase_if(joints_, [&](JointId joint) { return !world_.isValid(joint); });
        if (!world_.validate().empty()) breaks("valid");
        for (const BodyId body : bodies_)
            if (!(length(world_.linearVelocity(body)) <= kFastest)) breaks("in range");
        return broken_.empty();
    }
    double energy() const {
        double sum = 0;
        for (const BodyId body : bodies_) {
            const MassProperties mass = world_.mass(body);
            const Vec3 v = world_.linearVelocity(body),
                       w = inverseRotate(world_.pose(body).rotation, world_.angularVelocity(body));
            sum += 0.5 * static_cast<double>(mass.mass * lengthSquared(v) + dot(w, mass.inertia * w)) -
                   static_cast<double>(mass.mass) * dot(DVec3{world_.settings().gravity}, world_.centerOfMass(body));
        }
        return sum;
    }
    double deepestOverlap() const {
        float deepest = 0;
        world_.forEachContact([&](const Contact& contact) {
            for (int i = 0; i < contact.pointCount; ++i) deepest = std::max(deepest, -contact.points[i].separation);
        });
        return static_cast<double>(deepest);
    }
    void watch() {
        double mass = 0;
        for (const BodyId body : bodies_) mass += static_cast<double>(world_.mass(body).mass);
        // What a scene at rest may gain: all of its weight is lifted by a tenth of a metre, and by as much as what was
        // put into each other overlaps, which is pushed apart.
        const double gravity = static_cast<double>(length(world_.settings().gravity));
        const double start = energy(), room = 0.01 * std::abs(start) + (0.1 + deepestOverlap()) * mass * gravity;
        for (int i = 0; i < kWatched; ++i) {
            if (!step(kStep)) return;
            for (const JointId joint : joints_)
                if (!(static_cast<double>(world_.state(joint).gap) <= kGap)) breaks("gap");
            if (isWatched_ && !(energy() <= start + room)) breaks("energy");
        }
    }

    bool isWatched_;
    Dice dice_;
    World world_;
    SceneInstance instance_;
    std::vector<BodyId> bodies_;
    std::vector<JointId> joints_;
    std::vector<std::string> broken_;
};

}  // namespace

std::vector<std::string> meddle(const Drawn& drawn, std::uint64_t seed) { return Meddler(drawn, seed).run(); }

}  // namespace ragtop::laws
