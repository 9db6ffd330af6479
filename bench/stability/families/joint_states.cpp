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

/// Kinetic energy of a body whose moments are along its axes.
double energyOf(const BodyMotion& motion) {
    const DVec3 v(motion.v);
    const Vec3 w = inverseRotate(motion.pose.rotation, motion.w);
    return 0.5 * (static_cast<double>(kJointedMass) * (v.x * v.x + v.y * v.y + v.z * v.z) +
                  static_cast<double>(dot(w, scale(kJointedMoments, w))));
}

/// How far beyond a soft stop a joint is, m or rad; 0 within its range or without one. Springs act at the beginning of
/// a substep, so that what is stored in them and the speed are of times half a substep apart: energies are compared
/// while no stop is pressed.
struct SoftStop {
    double beyond = 0, stiffness = 0;

    double energy() const { return 0.5 * stiffness * beyond * beyond; }
};
template <class PoseOf>
SoftStop softStop(const SceneJoint& joint, PoseOf&& poseOf) {
    const auto beyond = [](const Range& range, double x) {
        const double lower = static_cast<double>(range.lower), upper = static_cast<double>(range.upper);
        return x < lower ? lower - x : larger(x - upper, 0.0);
    };
    const auto frame = [&](int body, const Frame& local) {
        if (body == kWorld) return Pose{DVec3(local.position), local.rotation};
        const Pose pose = poseOf(body);
        return Pose{pose.position + DVec3(rotate(pose.rotation, local.position)), pose.rotation * local.rotation};
    };
    const auto* turning = std::get_if<HingeDef>(&joint.def);
    const auto* sliding = std::get_if<SliderDef>(&joint.def);
    if (turning && turning->stop.stiffness > 0) {
        const Quat q = conjugate(frame(joint.bodyA, turning->bodies.frameA).rotation) *
                       frame(joint.bodyB, turning->bodies.frameB).rotation;
        const double angle = 2 * std::atan2(static_cast<double>(q.x), static_cast<double>(q.w));
        return {beyond(*turning->limit, std::remainder(angle, 2 * std::numbers::pi)),
                static_cast<double>(turning->stop.stiffness)};
    }
    if (sliding && sliding->stop.stiffness > 0) {
        const Pose a = frame(joint.bodyA, sliding->bodies.frameA), b = frame(joint.bodyB, sliding->bodies.frameB);
        const Vec3 gap = inverseRotate(a.rotation, relative(b.position, a.position));
        return {beyond(*sliding->limit, static_cast<double>(gap.x)), static_cast<double>(sliding->stop.stiffness)};
    }
    return {};
}
bool isPressed(const Run& run, const SceneJoint& joint) {
    return softStop(joint, [&](int body) { return run.motion(body).pose; }).beyond > 0;
}

double energyOf(const Run& run, std::size_t joint, int bodiesPerJoint) {
    double sum = 0;
    for (int i = 0; i < bodiesPerJoint; ++i) sum += energyOf(run.motion(bodiesPerJoint * static_cast<int>(joint) + i));
    return sum;
}

/// What joints begin with: what their stops store, and what is left of the energy of their bodies once velocities that
/// do not fit them are lost, which the first step without soft stops tells.
std::vector<double> startEnergies(Trial& trial, Scene scene, int bodiesPerJoint) {
    std::vector<double> energies;
    for (SceneJoint& joint : scene.joints) {
        energies.push_back(
            softStop(joint, [&](int body) { return scene.bodies[static_cast<std::size_t>(body)].def.pose; }).energy());
        std::visit(
            [](auto& each) {
                if constexpr (requires {
                                  each.stop.stiffness;
                                  each.limit.reset();
                              })
                    if (each.stop.stiffness > 0) each.limit.reset();
            },
            joint.def);
    }
    Run run = trial.start(scene, "start");
    run.step();
    for (std::size_t i = 0; i < energies.size(); ++i) energies[i] += energyOf(run, i, bodiesPerJoint);
    return energies;
}

/// Tells how many of so many joints gained more than 0.1 % in 2 s, and the most that any did.
struct Gains {
    double most = 0;
    int count = 0;

    void measure(Run& run, const std::vector<double>& start, int bodiesPerJoint) {
        const std::vector<SceneJoint>& joints = run.scene().joints;
        std::vector<bool> did(joints.size(), false);
        run.advance(2, [&] {
            for (std::size_t i = 0; i < joints.size(); ++i) {
                if (isPressed(run, joints[i])) continue;
                // What is at rest has nothing to compare with.
                const double gain = (energyOf(run, i, bodiesPerJoint) - start[i]) / larger(start[i], 0.01);
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
        const int bodies = twoBodies ? 2 : 1;
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
            const std::vector<double> start = startEnergies(trial, scene, bodies);
            Run run = trial.start(scene, std::to_string(done));
            gains.measure(run, start, bodies);
        }
        trial.expectAtMost("energy gained", gains.most, 0.001, "1");
        trial.expectAtMost("joints that gain", gains.count, 0, "1");
    }
};

}  // namespace

Family jointStates() {
    Family family{"joint_states", {}};
    const auto add = [&](const States& states, Kind kind) {
        family.cases.push_back({states.name(), [states](Trial& trial) { states.run(trial); }, kind});
    };
    // 68 kinds of states, 15,000 each: a million.
    for (const JointType& type : jointTypes())
        for (const bool two : {false, true})
            for (const bool anywhere : {false, true}) {
                if (anywhere && !type.anywhere) continue;
                add({&type, two, anywhere, 200}, Kind::oneStep);
                add({&type, two, anywhere, 15000}, Kind::longer);
            }
    return family;
}

}  // namespace ragtop::stability
