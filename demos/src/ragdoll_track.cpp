#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

#include "ragdoll_stander.h"
#include "ragdoll_watch.h"
#include "ragtop/asset_error.h"
#include "ragtop/pose.h"
#include "ragtop/tracker.h"

namespace ragtop::demos {
namespace {

constexpr double kTime = 10, kBegun = 0.5;  ///< s; after which it is measured
constexpr float kFrequency = 12;            ///< Hz, of muscles that follow closely
constexpr double kErrorBound = 3;           ///< degrees
constexpr double kUpright = 0.7;            ///< of the height of the root in the clip
constexpr double kDegrees = 180 / M_PI;

const Clip* clipOf(const RagdollSubject& subject, const std::string& name) {
    if (subject.clips.empty()) return nullptr;
    for (const Clip& clip : subject.clips) {
        std::string lower = clip.name;
        std::transform(lower.begin(), lower.end(), lower.begin(), [](unsigned char c) { return std::tolower(c); });
        if (name.empty() ? lower.find("walk") != std::string::npos : clip.name == name) return &clip;
    }
    if (!name.empty()) throw AssetError(subject.name + ": has no clip " + name);
    return &subject.clips.front();
}

/// A clip over and over, walking on from where it ended, with the lowest sole of all of it on the ground.
class Walk {
public:
    Walk(const RagdollSubject& subject, const Clip& clip) : subject_(subject), clip_(clip) {
        const Pose first = rootAt(0), last = rootAt(clip.seconds);
        stride_ = last.position - first.position;
        stride_.y = 0;
    }
    /// Raised so that nothing of it is ever below the ground.
    void standOn(double dt) {
        double lowest = std::numeric_limits<double>::infinity();
        for (double time = 0; time < static_cast<double>(clip_.seconds); time += dt) {
            RagdollStage stage(subject_, {});
            const auto& def = std::get<RagdollDef>(subject_.def);
            const std::vector<Pose> bones = at(time);
            for (std::size_t i = 0; i < stage.bodies.size(); ++i)
                stage.world.setPose(stage.bodies[i], bones[static_cast<std::size_t>(def.parts[i].bone)]);
            lowest = std::min(lowest, stage.lowestPoint());
            for (const BeyondLimit& each : stage.ragdoll->beyondLimits())
                beyond_.add(kDegrees * static_cast<double>(each.by),
                            stage.jointNames[static_cast<std::size_t>(each.joint)]);
        }
        raised_ = -lowest;
    }
    /// Degrees, by which the clip passes limits at most.
    const Worst& beyond() const { return beyond_; }
    std::vector<Pose> at(double time) const {
        const double length = static_cast<double>(clip_.seconds);
        const double rounds = length > 0 ? std::floor(time / length) : 0;
        LocalPose pose = restPose(subject_.skeleton, {});
        const DVec3 place = rounds * stride_ + DVec3{0, raised_, 0};
        sample(clip_, static_cast<float>(time - rounds * length), pose, {place, {}});
        return writePose(subject_.skeleton, pose);
    }

private:
    Pose rootAt(float time) const {
        LocalPose pose = restPose(subject_.skeleton, {});
        sample(clip_, time, pose);
        return pose.root;
    }
    const RagdollSubject& subject_;
    const Clip& clip_;
    DVec3 stride_;
    double raised_ = 0;
    Worst beyond_;
};

struct Tracked {
    Worst error;                      ///< degrees RMS, of the joint that is farthest from what it can take of the clip
    double mean = 0;                  ///< degrees RMS, of all joints
    double force = 0, mostForce = 0;  ///< N, RMS and most
    double torque = 0;                ///< N m, RMS
    double upright = 0;               ///< s, until the root is too low
};

Tracked follow(const RagdollDef& def, const Walk& walk, const TrackerOptions& help, double dt) {
    World world;
    world.create(StaticBody{.shape = Box{{1000, 1, 1000}}, .position = {0, -1, 0}, .material = {.friction = 0.8f}});
    Ragdoll body(world, def, walk.at(-dt), walk.at(0), dt);
    MuscleProfile profile = muscleProfile("rigid");
    profile.frequency = kFrequency;
    Muscles muscles(world, body, profile);
    Tracker tracker(world, body, muscles, help);
    tracker.follow(walk.at(-dt), dt);
    tracker.follow(walk.at(0), dt);
    std::vector<double> squares(def.joints.size());
    Tracked result;
    int counted = 0;
    bool upright = true;
    for (int i = 0; i < std::lround(kTime / dt); ++i) {
        const std::vector<Pose> wanted = walk.at((i + 1) * dt);
        tracker.follow(wanted, dt);
        muscles.step(dt);
        world.step(dt);
        const double root = world.pose(body.bodies()[0]).position.y;
        upright = upright && root > kUpright * wanted[static_cast<std::size_t>(def.parts[0].bone)].position.y;
        if (upright) result.upright = (i + 1) * dt;
        if (i * dt < kBegun) continue;
        ++counted;
        for (std::size_t j = 0; j < def.joints.size(); ++j) {
            const double off = kDegrees * static_cast<double>(muscles.error(static_cast<int>(j)));
            squares[j] += off * off;
        }
        const auto force = static_cast<double>(length(tracker.assistance().linear)),
                   torque = static_cast<double>(length(tracker.assistance().angular));
        result.force += force * force;
        result.torque += torque * torque;
        result.mostForce = std::max(result.mostForce, force);
    }
    for (std::size_t j = 0; j < squares.size(); ++j) {
        const double error = std::sqrt(squares[j] / counted);
        result.error.add(error, def.parts[static_cast<std::size_t>(def.joints[j].child)].name);
        result.mean += squares[j];
    }
    result.mean = std::sqrt(result.mean / counted / static_cast<double>(squares.size()));
    result.force = std::sqrt(result.force / counted);
    result.torque = std::sqrt(result.torque / counted);
    return result;
}

}  // namespace

std::vector<RagdollFigure> track(const RagdollSubject& subject, const RagdollTrialOptions& options) {
    const auto* made = std::get_if<RagdollDef>(&subject.def);
    const Clip* clip = clipOf(subject, options.clip);
    if (!made || !clip) return {};
    // Animations pass through the shapes of their own bodies.
    RagdollDef def = *made;
    def.selfCollision = false;
    Walk walk(subject, *clip);
    walk.standOn(1 / options.hz);
    const double dt = 1 / options.hz;
    const Tracked helped = follow(def, walk, {}, dt), alone = follow(def, walk, {.force = 0, .torque = 0}, dt);
    const std::string name = fmt::format("clip {}", clip->name);
    double mass = 0;
    for (const RagdollPart& part : def.parts) mass += static_cast<double>(part.mass);
    return {{"track", "error_rms_max_deg", helped.error.value(), kErrorBound, false,
             fmt::format("{}, {}", helped.error.where(), name)},
            {"track", "error_rms_mean_deg", helped.mean, kErrorBound, false, name},
            {"track", "clip_beyond_limits_max_deg", walk.beyond().value(), 180, false, walk.beyond().where()},
            {"track", "upright_s", helped.upright, kTime, true, name},
            {"track", "assistance_force_max_n", helped.mostForce, 1.001 * 9.81 * mass, false,
             fmt::format("{:.0f} N RMS, weight {:.0f} N", helped.force, 9.81 * mass)},
            {"track", "assistance_torque_rms_n_m", helped.torque, 9.81 * mass, false, ""},
            {"track", "upright_without_assistance_s", alone.upright, 0, true,
             fmt::format("{:.1f} degrees RMS", alone.mean)}};
}

}  // namespace ragtop::demos
