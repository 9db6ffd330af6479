#include "ragdoll_trial.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "ragdoll_levels.h"
#include "ragdoll_stander.h"
#include "ragdoll_watch.h"
#include "ragtop/asset_error.h"

namespace ragtop::demos {
namespace {

constexpr double kHeight = 1;      ///< m, of the lowest point of what is dropped
constexpr double kSettleTime = 5;  ///< s
constexpr double kAsleepShare = 0.95;
constexpr double kRestingSpeed = 0.005;                             ///< m/s
constexpr double kHangTime = 30, kShakeTime = 10, kFlightTime = 5;  ///< s
constexpr double kEnergyShare = 1e-3;  ///< of weight times size, or of the work of the hand
constexpr double kGrip = 0.01;         ///< friction torque of a hold over weight times size
constexpr double kMomentumShare = 1e-5;
constexpr double kPathError = 1e-3;  ///< m
constexpr float kSpin = 5;           ///< rad/s, of each part in flight, at most

double norm(const DVec3& a) { return std::sqrt(a.x * a.x + a.y * a.y + a.z * a.z); }

int stepsIn(double seconds, const RagdollTrialOptions& options) {
    return static_cast<int>(std::lround(seconds * options.hz));
}

/// Turned by `turn`, its lowest point kHeight above the ground.
Pose above(const RagdollSubject& subject, const Quat& turn) {
    const RagdollStage stage(subject, {{}, turn});
    if (!std::isfinite(stage.lowestPoint()))
        throw AssetError(subject.name + ": has no shapes, must have some to fall on the ground with");
    return {{0, kHeight - stage.lowestPoint(), 0}, turn};
}

/// Runs until all is asleep or kSettleTime is over.
struct Settling {
    bool asleep = false;
    double speed = 0;  ///< m/s, before it fell asleep or at the end

    Settling(RagdollStage& stage, const RagdollTrialOptions& options, WholenessWatch* whole, OverlapWatch* overlap,
             const std::string& run) {
        RestWatch rest(options.hz);
        for (int i = 0; i < stepsIn(kSettleTime, options) && !asleep; ++i) {
            stage.world.step(1 / options.hz);
            if (whole) whole->observe(stage, run);
            if (overlap) overlap->observe(stage, run);
            asleep = stage.asleep();
            if (!asleep) rest.observe(stage);
        }
        speed = rest.speed();
    }
};

/// The share of runs that fell asleep, how whole all stayed and how quiet they were.
class SettlingFigures {
public:
    explicit SettlingFigures(const RagdollSubject& subject) : overlap(subject) {}

    WholenessWatch whole;
    OverlapWatch overlap;

    void add(const Settling& settled, const std::string& run) {
        ++runs_;
        asleep_ += settled.asleep ? 1 : 0;
        if (!settled.asleep) awake_ += (awake_.empty() ? "awake: " : ", ") + run;
        speed_.add(settled.speed, run);
    }
    std::vector<RagdollFigure> tell(std::string_view test) const {
        std::vector<RagdollFigure> figures;
        const double share = runs_ > 0 ? static_cast<double>(asleep_) / runs_ : 0;
        figures.push_back({std::string(test), "asleep_within_5_s_share", share, kAsleepShare, true, awake_});
        whole.tell(test, figures);
        overlap.tell(test, figures);
        figures.push_back(
            {std::string(test), "resting_speed_rms_m_s", speed_.value(), kRestingSpeed, false, speed_.where()});
        return figures;
    }

private:
    int runs_ = 0, asleep_ = 0;
    std::string awake_;
    Worst speed_;
};

std::vector<RagdollFigure> drop(const RagdollSubject& subject, const RagdollTrialOptions& options) {
    SettlingFigures figures(subject);
    for (int seed = 1; seed <= options.seeds; ++seed) {
        std::mt19937 random(static_cast<unsigned>(seed));
        RagdollStage stage(subject, above(subject, anyRotation(random)));
        stage.addGround();
        const std::string run = fmt::format("seed {}", seed);
        figures.add(Settling(stage, options, &figures.whole, &figures.overlap, run), run);
    }
    return figures.tell("drop");
}

std::vector<RagdollFigure> push(const RagdollSubject& subject, const RagdollTrialOptions& options) {
    SettlingFigures figures(subject);
    for (int seed = 1; seed <= options.seeds; ++seed) {
        std::mt19937 random(static_cast<unsigned>(seed));
        RagdollStage stage(subject, above(subject, anyRotation(random)));
        stage.addGround();
        const std::string run = fmt::format("seed {}", seed);
        const Settling dropped(stage, options, nullptr, nullptr, run);
        const SinCos way = sinCos(kPi * anyNumber(random));
        const BodyId chest = stage.bodies[stage.chest()];
        stage.world.applyImpulse(chest, options.push * Vec3{way.cos, 0, way.sin}, stage.world.centerOfMass(chest));
        figures.add(Settling(stage, options, &figures.whole, &figures.overlap, run), run);
    }
    return figures.tell("push");
}

/// What energies are compared with, J: weight times size.
double scaleOf(const RagdollStage& stage, const DVec3& hand) {
    return stage.mass() * static_cast<double>(length(stage.world.settings().gravity)) * stage.reach(hand);
}

/// Holds a body by the centre of its mass, at a point of the world or of a hand that moves. The grip resists turning
/// somewhat: what hung on a bearing without friction would swing for good.
JointId hold(RagdollStage& stage, std::size_t body, BodyId hand) {
    const DVec3 center = stage.world.centerOfMass(stage.bodies[body]);
    BallDef ball;
    ball.bodies.a = hand;
    ball.friction = static_cast<float>(kGrip * scaleOf(stage, center));
    if (hand.isNull()) ball.bodies.frameA.position = toVec3(center);
    ball.bodies.b = stage.bodies[body];
    ball.bodies.frameB.position = inverseTransformPoint(stage.world.pose(stage.bodies[body]), center);
    return stage.world.create(ball);
}

std::vector<RagdollFigure> hang(const RagdollSubject& subject, const RagdollTrialOptions& options) {
    WholenessWatch whole;
    Worst gain, speed;
    for (const std::size_t limb : RagdollStage(subject, {}).holds()) {
        RagdollStage stage(subject, {});
        const std::string run = "by " + stage.names[limb];
        const DVec3 hand = stage.world.centerOfMass(stage.bodies[limb]);
        const double scale = scaleOf(stage, hand), start = stage.world.energy();
        hold(stage, limb, {});
        RestWatch rest(options.hz);
        for (int i = 0; i < stepsIn(kHangTime, options); ++i) {
            stage.world.step(1 / options.hz);
            whole.observe(stage, run);
            rest.observe(stage);
            gain.add((stage.world.energy() - start) / scale, fmt::format("{} at {:.2f} s", run, stage.world.time()));
        }
        speed.add(rest.speed(), run);
    }
    std::vector<RagdollFigure> figures;
    whole.tell("hang", figures);
    figures.push_back(
        {"hang", "energy_gain_max_ratio", std::max(gain.value(), 0.0), kEnergyShare, false, gain.where()});
    figures.push_back({"hang", "speed_rms_after_30_s_m_s", speed.value(), kRestingSpeed, false, speed.where()});
    return figures;
}

/// Where the hand is: the first second it swings up from nothing.
double handHeight(double time, const RagdollTrialOptions& options) {
    const double begun = std::min(time, 1.0), share = begun * begun * (3 - 2 * begun);
    return share * static_cast<double>(options.stroke) *
           std::sin(2 * M_PI * static_cast<double>(options.shakeRate) * time);
}

/// The energy of what only gravity and a hand act on, beyond what the hand gave it. The hand's mean force over a step
/// is what changed the momentum beside gravity, and its speed is constant within a step.
class HandBalance {
public:
    explicit HandBalance(const RagdollStage& stage)
        : mass_(stage.mass()), start_(stage.world.energy()), momentum_(stage.momentum()) {}

    void add(const RagdollStage& stage, double rise, double dt) {
        const DVec3 momentum = stage.momentum();
        const double force = (momentum.y - momentum_.y) / dt - mass_ * stage.world.settings().gravity.y;
        momentum_ = momentum;
        given_ += force * rise;
        moved_ += std::abs(force * rise);
        gain_ = std::max(gain_, stage.world.energy() - start_ - given_);
    }
    /// The largest gain over all that the hand gave and took.
    double ratio() const { return gain_ / moved_; }

private:
    double mass_, start_, given_ = 0, moved_ = 0, gain_ = 0;
    DVec3 momentum_;
};

std::vector<RagdollFigure> shake(const RagdollSubject& subject, const RagdollTrialOptions& options) {
    WholenessWatch whole;
    Worst gain;
    for (const std::size_t limb : RagdollStage(subject, {}).holds()) {
        RagdollStage stage(subject, {});
        const std::string run = "by " + stage.names[limb];
        BodyDef handDef;
        handDef.type = BodyType::kinematic;
        handDef.pose.position = stage.world.centerOfMass(stage.bodies[limb]);
        const BodyId hand = stage.world.create(handDef);
        hold(stage, limb, hand);
        HandBalance balance(stage);
        const double dt = 1 / options.hz;
        for (int i = 0; i < stepsIn(kShakeTime, options); ++i) {
            Pose target = handDef.pose;
            target.position.y += handHeight((i + 1) * dt, options);
            stage.world.moveTo(hand, target, dt);
            stage.world.step(dt);
            whole.observe(stage, run);
            balance.add(stage, handHeight((i + 1) * dt, options) - handHeight(i * dt, options), dt);
        }
        gain.add(balance.ratio(), run);
    }
    std::vector<RagdollFigure> figures;
    whole.tell("shake", figures);
    figures.push_back({"shake", "energy_gain_max_ratio", gain.value(), kEnergyShare, false, gain.where()});
    return figures;
}

/// Thrown with every part spinning its own way, so that all joints move; measured from the end of the first step, when
/// the parts are joined again.
std::vector<RagdollFigure> flight(const RagdollSubject& subject, const RagdollTrialOptions& options) {
    WholenessWatch whole;
    Worst momentum, path;
    for (int seed = 1; seed <= options.seeds; ++seed) {
        std::mt19937 random(static_cast<unsigned>(seed));
        RagdollStage stage(subject, {{}, anyRotation(random)});
        for (const BodyId body : stage.bodies) {
            const float x = anyNumber(random), y = anyNumber(random), z = anyNumber(random);
            stage.world.setVelocity(body, {1, 5, 0}, kSpin * Vec3{x, y, z});
        }
        stage.world.step(1 / options.hz);
        const DVec3 center = stage.centerOfMass(), spin = stage.angularMomentum();
        const DVec3 speed = (1 / stage.mass()) * stage.momentum(), gravity(stage.world.settings().gravity);
        const double begin = stage.world.time();
        for (int i = 1; i < stepsIn(kFlightTime, options); ++i) {
            stage.world.step(1 / options.hz);
            const std::string run = fmt::format("seed {}", seed);
            whole.observe(stage, run);
            const double t = stage.world.time() - begin;
            const DVec3 expected = center + t * speed + (0.5 * t * t) * gravity;
            const std::string where = fmt::format("{} at {:.2f} s", run, stage.world.time());
            momentum.add(norm(stage.angularMomentum() - spin) / norm(spin), where);
            path.add(norm(stage.centerOfMass() - expected), where);
        }
    }
    std::vector<RagdollFigure> figures;
    whole.tell("flight", figures);
    figures.push_back(
        {"flight", "angular_momentum_change_max_ratio", momentum.value(), kMomentumShare, false, momentum.where()});
    figures.push_back({"flight", "path_error_max_m", path.value(), kPathError, false, path.where()});
    return figures;
}

}  // namespace

const std::vector<RagdollTest>& ragdollTests() {
    static const std::vector<RagdollTest> tests{
        {"drop", "from 1 m in any rotation", drop},
        {"push", "on the chest as it lies", push},
        {"hang", "by each hand and foot, 30 s", hang},
        {"shake", "up and down by each hand and foot, 10 s", shake},
        {"flight", "thrown with moving joints, 5 s", flight},
        {"balance", "a human on its own feet: still, pushed, on slopes, on what accelerates, with a load", balance},
        {"brace", "pushed so that it falls, 64 ways", brace},
        {"getup", "gets up from how it lies after a drop", getUp},
        {"track", "follows a clip, 10 s", track},
        {"lod", "thrown, and changed from level to level of detail", levels},
    };
    return tests;
}

}  // namespace ragtop::demos
