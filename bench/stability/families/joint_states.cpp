#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "../extremes.h"
#include "../families.h"
#include "joint_kinds.h"

namespace ragtop::stability {
namespace {
namespace joint_states_cases {

/// Kinetic energy of a body whose moments are along its axes.
double energyOf(const Quat& rotation, const Vec3& linear, const Vec3& angular) {
    const DVec3 v(linear);
    const Vec3 w = inverseRotate(rotation, angular);
    return 0.5 * (static_cast<double>(kJointedMass) * (v.x * v.x + v.y * v.y + v.z * v.z) +
                  static_cast<double>(dot(w, scale(kJointedMoments, w))));
}

double beyond(const std::optional<Range>& range, double x) {
    if (!range) return 0;
    const double lower = static_cast<double>(range->lower), upper = static_cast<double>(range->upper);
    return x < lower ? lower - x : larger(x - upper, 0.0);
}

/// How B's joint frame lies in A's.
struct Between {
    Vec3 offset;
    Quat rotation;

    double twist() const {
        const double angle = 2 * std::atan2(static_cast<double>(rotation.x), static_cast<double>(rotation.w));
        return std::remainder(angle, 2 * std::numbers::pi);
    }
    double swing() const {
        return 2 *
               static_cast<double>(std::atan2(std::hypot(rotation.y, rotation.z), std::hypot(rotation.x, rotation.w)));
    }
};

/// What a joint has stored in soft stops, J; 0 within its range.
double stored(const HingeDef& hinge, const Between& between) {
    const double x = beyond(hinge.limit, between.twist());
    return 0.5 * static_cast<double>(hinge.stop.stiffness) * x * x;
}
double stored(const SliderDef& slider, const Between& between) {
    const double x = beyond(slider.limit, static_cast<double>(between.offset.x));
    return 0.5 * static_cast<double>(slider.stop.stiffness) * x * x;
}
/// What a twist is beyond its range counts by the cosine of half the swing, with which it fades at half a turn.
double stored(const BallDef& ball, const Between& between) {
    const double twist = std::cos(between.swing() / 2) * beyond(ball.twistLimit, between.twist());
    const double swing = ball.swingLimit ? beyond(Range{0, *ball.swingLimit}, between.swing()) : 0;
    return 0.5 * static_cast<double>(ball.stop.stiffness) * (twist * twist + swing * swing);
}
/// Other joints have hard stops here.
double stored(const auto&, const Between&) { return 0; }

template <class PoseOf>
double stored(const SceneJoint& joint, PoseOf&& poseOf) {
    const auto frame = [&](int body, const Frame& local) { return (body == kWorld ? Pose{} : poseOf(body)) * local; };
    return std::visit(
        [&](const auto& def) {
            const Pose a = frame(joint.bodyA, def.bodies.frameA), b = frame(joint.bodyB, def.bodies.frameB);
            return stored(def, {inverseTransformPoint(a, b.position), conjugate(a.rotation) * b.rotation});
        },
        joint.def);
}

bool hasSoftStops(const SceneJoint& joint) {
    return std::visit(
        [](const auto& def) {
            if constexpr (requires { def.stop.stiffness; }) return def.stop.stiffness > 0;
            return false;
        },
        joint.def);
}

/// Takes from the velocities of a scene what its joints do not allow: what is left of them after a moment, without soft
/// stops, which would act in it.
void fitVelocities(Trial& trial, Scene& scene) {
    constexpr double kMoment = 1e-6;  ///< s
    Scene bare = scene;
    for (SceneJoint& joint : bare.joints)
        if (hasSoftStops(joint))
            std::visit(
                [](auto& def) {
                    if constexpr (requires { def.limit.reset(); }) def.limit.reset();
                    if constexpr (requires { def.swingLimit.reset(); }) def.swingLimit.reset();
                    if constexpr (requires { def.twistLimit.reset(); }) def.twistLimit.reset();
                },
                joint.def);
    Trial brief({"", "", &trial.engine(), kMoment, {}});
    Run run = brief.start(bare);
    run.step();
    for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
        const BodyMotion motion = run.motion(static_cast<int>(i));
        scene.bodies[i].def.linearVelocity = motion.v;
        scene.bodies[i].def.angularVelocity = motion.w;
    }
}

/// How many of so many joints gained more than 0.1 % in 2 s of what their bodies and stops began with, and the most
/// that any did: while no stop is pressed, and at any time.
struct Gains {
    double most = 0, mostPressed = 0;
    int count = 0;
    bool anySoft = false;

    void measure(Run& run, int bodiesPerJoint) {
        const Scene& scene = run.scene();
        const std::vector<SceneJoint>& joints = scene.joints;
        std::vector<double> start(joints.size(), 0.0);
        for (std::size_t i = 0; i < joints.size(); ++i) {
            start[i] = stored(joints[i], [&](int b) { return scene.bodies[static_cast<std::size_t>(b)].def.pose; });
            for (int body = 0; body < bodiesPerJoint; ++body) {
                const BodyDef& def =
                    scene.bodies[i * static_cast<std::size_t>(bodiesPerJoint) + static_cast<std::size_t>(body)].def;
                start[i] += energyOf(def.pose.rotation, def.linearVelocity, def.angularVelocity);
            }
            anySoft |= hasSoftStops(joints[i]);
        }
        std::vector<bool> did(joints.size(), false);
        run.advance(2, [&] {
            for (std::size_t i = 0; i < joints.size(); ++i) {
                const double inStops = stored(joints[i], [&](int body) { return run.motion(body).pose; });
                double energy = inStops;
                for (int body = 0; body < bodiesPerJoint; ++body) {
                    const BodyMotion motion = run.motion(bodiesPerJoint * static_cast<int>(i) + body);
                    energy += energyOf(motion.pose.rotation, motion.v, motion.w);
                }
                // What is at rest has nothing to compare with.
                const double gain = (energy - start[i]) / larger(start[i], 0.01);
                mostPressed = larger(mostPressed, gain);
                if (inStops > 0) continue;
                most = larger(most, gain);
                if (gain <= 0.001 || did[i]) continue;
                ++count;
                did[i] = true;
            }
            return true;
        });
    }
};

/// Within their limits, or anywhere that the joint without them would be.
struct States {
    const JointType* type;
    bool twoBodies, anywhere;
    int count;

    std::string name() const {
        return fmt::format("{} of {}{}, {}", count, type->name, anywhere ? " anywhere" : "",
                           twoBodies ? "two bodies" : "a body and the world");
    }
    void run(Trial& trial) const {
        constexpr int kAtOnce = 400;
        Dice dice;
        Gains gains;
        for (int done = 0; done < count; done += kAtOnce) {
            Scene scene;
            scene.settings.gravity = {};
            for (int i = 0; i < std::min(kAtOnce, count - done); ++i) {
                Drawn drawn = type->draw(dice);
                if (anywhere) {
                    const Place place = type->anywhere(dice);
                    drawn.rotation = place.rotation, drawn.offset = place.offset;
                }
                addJoint(scene, dice, drawn, {4.0 * i, 0, 0}, twoBodies);
            }
            fitVelocities(trial, scene);
            Run run = trial.start(scene, std::to_string(done));
            gains.measure(run, twoBodies ? 2 : 1);
        }
        trial.expectAtMost("energy gained", gains.most, 0.001, "1");
        trial.expectAtMost("joints that gain", gains.count, 0, "1");
        if (gains.anySoft) trial.expectAtMost("energy gained, in pressed stops too", gains.mostPressed, 0.001, "1");
    }
};

}  // namespace joint_states_cases
}  // namespace

Family jointStates() {
    using namespace joint_states_cases;
    Family family{"joint_states", {}};
    const auto add = [&](const States& states, Kind kind) {
        family.cases.push_back({states.name(), [states](Trial& trial) { states.run(trial); }, kind});
    };
    // 72 kinds of states, 15,000 each: a million.
    for (const JointType& type : jointTypes())
        for (const bool two : {false, true})
            for (const bool anywhere : {false, true}) {
                if (anywhere && !type.anywhere) continue;
                add({&type, two, anywhere, 200}, Kind::oneStep);
                add({&type, two, anywhere, 15000}, Kind::longer);
            }
    addTorqueCases(family);
    addTurnCases(family);
    return family;
}

}  // namespace ragtop::stability
