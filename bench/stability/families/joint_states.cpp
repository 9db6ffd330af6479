#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

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

/// Does a soft stop store energy? Its springs act at the beginning of a substep, so that what is stored in them and the
/// speed are of times half a substep apart: energies are compared while no stop is pressed, before and after.
bool isPressed(const Run& run, const SceneJoint& joint) {
    const auto beyond = [](const Range& range, double x) {
        return x < static_cast<double>(range.lower) || x > static_cast<double>(range.upper);
    };
    const auto frame = [&](int body, const Frame& local) {
        if (body == kWorld) return Pose{DVec3(local.position), local.rotation};
        const Pose pose = run.motion(body).pose;
        return Pose{pose.position + DVec3(rotate(pose.rotation, local.position)), pose.rotation * local.rotation};
    };
    const auto* turning = std::get_if<HingeDef>(&joint.def);
    const auto* sliding = std::get_if<SliderDef>(&joint.def);
    if (turning && turning->stop.stiffness > 0) {
        const Quat q = conjugate(frame(joint.bodyA, turning->bodies.frameA).rotation) *
                       frame(joint.bodyB, turning->bodies.frameB).rotation;
        const double angle = 2 * std::atan2(static_cast<double>(q.x), static_cast<double>(q.w));
        return beyond(*turning->limit, std::remainder(angle, 2 * std::numbers::pi));
    }
    if (sliding && sliding->stop.stiffness > 0) {
        const Pose a = frame(joint.bodyA, sliding->bodies.frameA), b = frame(joint.bodyB, sliding->bodies.frameB);
        const Vec3 gap = inverseRotate(a.rotation, relative(b.position, a.position));
        return beyond(*sliding->limit, static_cast<double>(gap.x));
    }
    return false;
}

/// Tells how many of so many joints gained more than 0.1 % in the 2 s after their first step, in which what does not
/// fit the joint is lost, and the most that any did.
struct Gains {
    double most = 0;
    int count = 0;

    void measure(Run& run, int bodiesPerJoint) {
        const std::vector<SceneJoint>& joints = run.scene().joints;
        const auto energy = [&](std::size_t joint) {
            double sum = 0;
            for (int i = 0; i < bodiesPerJoint; ++i)
                sum += energyOf(run.motion(bodiesPerJoint * static_cast<int>(joint) + i));
            return sum;
        };
        run.step();
        std::vector<double> start(joints.size(), -1);
        for (std::size_t i = 0; i < joints.size(); ++i)
            if (!isPressed(run, joints[i])) start[i] = energy(i);
        std::vector<bool> did(joints.size(), false);
        run.advance(2, [&] {
            for (std::size_t i = 0; i < joints.size(); ++i) {
                if (isPressed(run, joints[i])) continue;
                if (start[i] < 0) start[i] = energy(i);
                // What is at rest has nothing to compare with.
                const double gain = (energy(i) - start[i]) / std::max(start[i], 0.01);
                most = std::max(most, gain);
                if (gain <= 0.001 || did[i]) continue;
                ++count;
                did[i] = true;
            }
            return true;
        });
    }
};

void states(Trial& trial, const JointType& type, bool twoBodies, int count) {
    constexpr int kAtOnce = 400;
    Dice dice;
    Gains gains;
    for (int done = 0; done < count; done += kAtOnce) {
        Scene scene;
        scene.settings.gravity = {};
        for (int i = 0; i < std::min(kAtOnce, count - done); ++i)
            addJoint(scene, dice, type.draw(dice), {4.0 * i, 0, 0}, twoBodies);
        Run run = trial.start(scene, std::to_string(done));
        gains.measure(run, twoBodies ? 2 : 1);
    }
    trial.expectAtMost("energy gained", gains.most, 0.001, "1");
    trial.expectAtMost("joints that gain", gains.count, 0, "1");
}

}  // namespace

Family jointStates() {
    Family family{"joint_states", {}};
    const auto add = [&](const JointType& type, bool twoBodies, int count, Kind kind) {
        const std::string name =
            fmt::format("{} of {}, {}", count, type.name, twoBodies ? "two bodies" : "a body and the world");
        family.cases.push_back(
            {name, [&type, twoBodies, count](Trial& trial) { states(trial, type, twoBodies, count); }, kind});
    };
    // 42 kinds of joints, 24,000 states each: a million.
    for (const JointType& type : jointTypes())
        for (const bool two : {false, true}) {
            add(type, two, 200, Kind::oneStep);
            add(type, two, 24000, Kind::longer);
        }
    return family;
}

}  // namespace ragtop::stability
