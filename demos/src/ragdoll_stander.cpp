#include "ragdoll_stander.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace ragtop::demos {
namespace {

constexpr double kStill = 60, kAfter = 6;              ///< s
constexpr float kShare = 0.8f, kSteppingShare = 1.5f;  ///< of what a body without a step can take
constexpr float kSlope = 5 * kPi / 180;
constexpr float kAcceleration = 1;  ///< m/s²
constexpr float kLoad = 5;          ///< kg
constexpr double kSway = 0.005;     ///< m
constexpr double kFallen = 0.75;    ///< of the height of who stands

Pose floorAt(const Quat& tilt, const DVec3& top) { return {top + rotate(tilt, {0, -1, 0}), tilt}; }

/// About the level axis that lifts the side to which `uphill` points.
Quat tiltTo(const Vec3& uphill, float angle) { return rotationAbout(cross(uphill, {0, 1, 0}), angle); }

/// Runs, and tells how many of them stood to the end.
class Standing {
public:
    void add(bool stood, const std::string& run) {
        ++runs_;
        stood_ += stood ? 1 : 0;
        if (!stood) fell_ += (fell_.empty() ? "fell: " : ", ") + run;
    }
    RagdollFigure tell(const char* name) const {
        return {"balance", name, runs_ > 0 ? static_cast<double>(stood_) / runs_ : 0, 1, true, fell_};
    }

private:
    int runs_ = 0, stood_ = 0;
    std::string fell_;
};

Vec3 eighth(int index) {
    const SinCos angle = sinCos(0.25f * kPi * static_cast<float>(index));
    return {angle.sin, 0, angle.cos};
}

struct Trial {
    const RagdollDef& def;
    double dt;

    void run(RagdollStander& stander, double seconds) const {
        const auto steps = static_cast<int>(std::lround(seconds / dt));
        for (int i = 0; i < steps && stander.stands(); ++i) stander.step(dt);
    }
    /// m, between the extremes of the centre of mass in the last ten of sixty seconds, minus those in the ten before
    /// them.
    RagdollFigure still() const {
        RagdollStander stander(def);
        run(stander, kStill - 20);
        double spread[2] = {};
        for (double& each : spread) {
            double lower[2] = {1e9, 1e9}, upper[2] = {-1e9, -1e9};
            for (int i = 0; i < std::lround(10 / dt) && stander.stands(); ++i) {
                stander.step(dt);
                const DVec3 c = stander.dynamics().centerOfMass();
                lower[0] = std::min(lower[0], c.x), upper[0] = std::max(upper[0], c.x);
                lower[1] = std::min(lower[1], c.z), upper[1] = std::max(upper[1], c.z);
            }
            each = std::max(upper[0] - lower[0], upper[1] - lower[1]);
        }
        const double sway = stander.stands() ? spread[1] : std::numeric_limits<double>::infinity();
        return {
            "balance", "sway_after_50_s_m", sway, kSway, false, fmt::format("{:.4f} m in the 10 s before", spread[0])};
    }
    bool pushed(const Vec3& direction, float share) const {
        RagdollStander stander(def);
        run(stander, kSettled);
        stander.push(direction, share * stander.most(direction));
        run(stander, kAfter);
        return stander.stands();
    }
    /// The floor tilts within two seconds.
    bool tilted(const Vec3& uphill) const {
        RagdollStander stander(def);
        run(stander, kSettled);
        const auto steps = static_cast<int>(std::lround(2 / dt));
        for (int i = 1; i <= steps && stander.stands(); ++i) {
            const float angle = kSlope * static_cast<float>(i) / static_cast<float>(steps);
            stander.moveFloor(floorAt(tiltTo(uphill, angle), {}), dt);
            stander.step(dt);
        }
        run(stander, 10);
        return stander.stands();
    }
    bool accelerated(const Vec3& direction) const {
        RagdollStander stander(def);
        run(stander, kSettled);
        const auto steps = static_cast<int>(std::lround(10 / dt));
        for (int i = 1; i <= steps && stander.stands(); ++i) {
            const double time = i * dt;
            const double way = 0.5 * static_cast<double>(kAcceleration) * time * time;
            stander.moveFloor(floorAt({}, way * DVec3(direction)), dt);
            stander.step(dt);
        }
        return stander.stands();
    }
    bool loaded() const {
        RagdollStander stander(def);
        run(stander, kSettled);
        stander.load(kLoad);
        run(stander, 20);
        return stander.stands();
    }
};

}  // namespace

RagdollStander::RagdollStander(const RagdollDef& def, float slope, const Vec3& uphill)
    : axes_(def),
      floor_(world_.create(BodyDef{.type = BodyType::kinematic,
                                   .shapes = {{.geometry = Box{{1000, 1, 1000}}, .material = {.friction = 0.8f}}},
                                   .pose = floorAt(tiltTo(uphill, slope), {})})),
      body_(world_, def, standing(axes_, {{}, tiltTo(uphill, slope)})),
      muscles_(world_, body_),
      balance_(world_, body_, muscles_),
      dynamics_(world_, body_),
      upright_(dynamics_.centerOfMass().y) {}

const RagdollDef* RagdollStander::standerOf(const RagdollSubject& subject) {
    const auto* def = std::get_if<RagdollDef>(&subject.def);
    if (!def) return nullptr;
    try {
        RagdollStander stander(*def);
    } catch (const std::invalid_argument&) {
        return nullptr;
    }
    return def;
}

void RagdollStander::step(double dt, Brace* brace, bool balancing) {
    if (balancing) balance_.step(dt);
    if (brace) brace->step();
    muscles_.step(dt);
    world_.step(dt);
    world_.setVelocity(floor_, {}, {});
    dynamics_.look();
}

void RagdollStander::moveFloor(const Pose& target, double dt) { world_.moveTo(floor_, target, dt); }

void RagdollStander::push(const Vec3& direction, float size) {
    const Vec3 gained = (size / dynamics_.mass()) * direction;
    for (const BodyId part : body_.bodies())
        world_.setVelocity(part, world_.linearVelocity(part) + gained, world_.angularVelocity(part));
}

void RagdollStander::load(float mass) {
    int hand = axes_.find(BodyRole::hand, BodySide::left);
    if (hand < 0) hand = axes_.find(BodyRole::forearm, BodySide::left);
    if (hand < 0) return;
    const BodyId holder = body_.bodies()[static_cast<std::size_t>(hand)];
    const float radius = std::cbrt(mass / (4.19f * 7800));
    const Pose place{world_.centerOfMass(holder), world_.pose(holder).rotation};
    DynamicBody ball{.shape = Sphere{radius}, .density = 7800, .position = place.position, .rotation = place.rotation};
    ball.filter.mask = 0;
    const BodyId held = world_.create(ball);
    world_.create(FixedDef{.bodies = {.a = holder,
                                      .b = held,
                                      .frameA = {inverseTransformPoint(world_.pose(holder), place.position), {}}}});
}

float RagdollStander::most(const Vec3& direction) const {
    const float gravity = length(world_.settings().gravity);
    return dynamics_.mass() * balance_.reach(direction) * std::sqrt(gravity / static_cast<float>(height()));
}

bool RagdollStander::stands() const { return height() > kFallen * upright_; }

/// Pushes in any direction, as many as seeds; eight of them are those of the compass.
std::vector<RagdollFigure> balance(const RagdollSubject& subject, const RagdollTrialOptions& options) {
    const RagdollDef* def = RagdollStander::standerOf(subject);
    if (!def) return {};
    const Trial trial{*def, 1 / options.hz};
    std::vector<RagdollFigure> figures{trial.still()};
    Standing pushes, steps, slopes, floors, loads;
    for (int i = 0; i < 8; ++i) {
        pushes.add(trial.pushed(eighth(i), kShare), fmt::format("{} degrees", 45 * i));
        steps.add(trial.pushed(eighth(i), kSteppingShare), fmt::format("{} degrees", 45 * i));
    }
    for (int seed = 1; seed <= options.seeds; ++seed) {
        std::mt19937 random(static_cast<unsigned>(seed));
        const SinCos way = sinCos(kPi * anyNumber(random));
        pushes.add(trial.pushed({way.sin, 0, way.cos}, kShare), fmt::format("seed {}", seed));
        steps.add(trial.pushed({way.sin, 0, way.cos}, kSteppingShare), fmt::format("seed {}", seed));
    }
    for (int i = 0; i < 8; ++i) {
        slopes.add(trial.tilted(eighth(i)), fmt::format("{} degrees", 45 * i));
        floors.add(trial.accelerated(eighth(i)), fmt::format("{} degrees", 45 * i));
    }
    loads.add(trial.loaded(), "left hand");
    for (const auto& [runs, name] :
         {std::pair{&pushes, "stands_pushed_by_0.8_share"}, std::pair{&steps, "stands_pushed_by_1.5_share"},
          std::pair{&slopes, "stands_on_5_deg_share"}, std::pair{&floors, "stands_on_1_m_s2_share"},
          std::pair{&loads, "stands_with_5_kg_share"}})
        figures.push_back(runs->tell(name));
    return figures;
}

}  // namespace ragtop::demos
