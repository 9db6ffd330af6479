#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>
#include <vector>

#include "../families.h"
#include "../scenery.h"
#include "joint_kinds.h"

namespace ragtop::stability {
namespace {

/// A rod of 1 m on a hinge runs into its stop at 1 rad: it may neither pass it nor come back faster.
void stop(Trial& trial, float speed) {
    constexpr float kStop = 1;
    Scene scene;
    scene.settings.gravity = {};
    BodyDef def = solidBody(Box{{0.5f, 0.02f, 0.02f}}, {0.5, 0, 0}, 1, {});
    def.angularVelocity = {0, 0, speed};
    def.linearVelocity = {0, 0.5f * speed, 0};
    const int body = add(scene, def);
    addHinge(scene, kWorld, body, {}, {0, 0, 1}).limit = Range{-kStop, kStop};
    Run run = trial.start(scene);
    const double energy = run.energy();
    double angle = 0, beyond = 0, gained = -1, before = 0;
    run.advance(1, [&] {
        const DVec3 at = run.position(body);
        const double next = std::atan2(at.y, at.x);
        angle += std::remainder(next - before, 2 * std::numbers::pi);
        before = next;
        beyond = std::max(beyond, std::abs(angle) - static_cast<double>(kStop));
        gained = std::max(gained, run.energy() / energy - 1);
        return true;
    });
    trial.expectAtMost("overshoot", beyond, 0.01, "rad");
    trial.expectAtMost("energy gained", std::max(gained, 0.0), 0.001, "1");
}

constexpr float kFallStop = -1;  ///< rad
constexpr double kPerDegree = std::numbers::pi / 180;

/// A rod of 1 m and 1 kg falls from level on a stop at −1 rad. (A test of the core looks at each substep.)
void fall(Trial& trial, int rate) {
    trial.setStep(1.0 / rate);
    Scene scene;
    const int body = add(scene, solidBody(Box{{0.5f, 0.02f, 0.02f}}, {0.5, 0, 0}, 1, {}));
    addHinge(scene, kWorld, body, {}, {0, 0, 1}).limit = Range{kFallStop, 1};
    Run run = trial.start(scene);
    double lowest = 9, highest = 0;
    run.advance(2, [&] {
        const DVec3 at = run.position(body);
        const double angle = std::atan2(at.y, at.x), stop = static_cast<double>(kFallStop);
        lowest = std::min(lowest, angle - stop);
        if (lowest < 1e-3) highest = std::max(highest, angle - stop);
        return true;
    });
    trial.expectAtMost("overshoot", -lowest, 0.1 * kPerDegree, "rad");
    trial.expectAtMost("rebound", highest, 0.05 * kPerDegree, "rad");
}

/// The same with a stop that gives back half of the speed: the next apex is a quarter as high above the stop.
void rebound(Trial& trial, int rate) {
    trial.setStep(1.0 / rate);
    Scene scene;
    const int body = add(scene, solidBody(Box{{0.5f, 0.02f, 0.02f}}, {0.5, 0, 0}, 1, {}));
    HingeDef& hinge = addHinge(scene, kWorld, body, {}, {0, 0, 1});
    hinge.limit = Range{kFallStop, 1};
    hinge.stop.restitution = 0.5f;
    Run run = trial.start(scene);
    const double bottom = 0.5 * std::sin(static_cast<double>(kFallStop));
    double before = 0, apex = bottom;
    int strikes = 0;
    run.advance(2, [&] {
        const double speed = static_cast<double>(run.motion(body).w.z);
        if (before < 0 && speed > 0) ++strikes;
        before = speed;
        if (strikes == 1) apex = std::max(apex, run.height(body));
        return strikes < 2;
    });
    trial.expectNear("rebound speed over impact speed", std::sqrt((apex - bottom) / -bottom), 0.5, 0.025, "1");
}

/// A wheel of 0.1 kg m² at 4 rad/s runs into a soft stop of 3 Hz and leaves it as half a damped swing ends.
void soft(Trial& trial, int rate, double zeta) {
    trial.setStep(1.0 / rate);
    constexpr double kInertia = 0.1, kSpin = 4;
    const double omega = 2 * std::numbers::pi * 3, damped = omega * std::sqrt(1 - zeta * zeta);
    Scene scene;
    scene.settings.gravity = {};
    const float i = static_cast<float>(kInertia);
    BodyDef def = bodyWithMass(Sphere{0.2f}, {}, 2, {i, i, i}, {});
    def.angularVelocity = {0, 0, static_cast<float>(kSpin)};
    const int body = add(scene, def);
    HingeDef& hinge = addHinge(scene, kWorld, body, {}, {0, 0, 1});
    hinge.limit = Range{-10, 0.2f};
    hinge.stop.stiffness = static_cast<float>(kInertia * omega * omega);
    hinge.stop.damping = static_cast<float>(2 * zeta * kInertia * omega);
    Run run = trial.start(scene);
    run.advance(0.4);
    // A stop only pushes: it lets go where k x + c v is zero.
    const double lean = std::sqrt(1 - zeta * zeta);
    const double turn = zeta > 0 ? std::atan2(2 * zeta * lean, 2 * zeta * zeta - 1) : std::numbers::pi;
    const double exact =
        kSpin * std::exp(-zeta * omega * turn / damped) * (std::cos(turn) - zeta / lean * std::sin(turn));
    trial.expectNear("speed after", static_cast<double>(run.motion(body).w.z), exact, 0.02 * std::abs(exact), "rad/s");
}

/// All that a limited joint may be.
JointDef limitedJoint(Dice& dice, int kind) {
    const auto range = [&](float size) { return Range{-size * dice.between(0, 1), size * dice.between(0.02f, 1)}; };
    AxisDef turn, travel;
    turn.limit = range(8);
    travel.limit = range(1);
    BallDef ball;
    ball.twistLimit = range(3);
    HingeDef hinge;
    SliderDef slider;
    switch (kind) {
        case 0:
            ball.swingLimit = dice.between(0.1f, 3);
            return ball;
        case 1:
            ball.swingEllipse = SwingEllipse{dice.between(0.1f, 2), dice.between(0.1f, 2)};
            return ball;
        case 2:
            ball.swingPyramid = SwingPyramid{range(1.5f), range(1.5f)};
            return ball;
        case 3:
            ball.twistLimit.reset();
            ball.reach = anyReach(dice, [&] { return range(3); });
            return ball;
        case 4:
            hinge.limit = turn.limit;
            return hinge;
        case 5:
            slider.limit = travel.limit;
            return slider;
        case 6:
            return CylindricalDef{{}, turn, travel};
        case 7:
            return UniversalDef{{}, turn, turn};
        case 8:
            return PlaneDef{{}, travel, travel, turn};
        default:
            return ScrewDef{{}, dice.between(0.05f, 0.5f), turn};
    }
}

constexpr const char* kKinds[] = {"cone",   "ellipse",     "pyramid",   "polygon", "hinge",
                                  "slider", "cylindrical", "universal", "plane",   "screw"};

/// Joints thrown into their limits with up to 10 rad/s, from zero or from anywhere, beyond the limits too: none may
/// gain energy in the 2 s that follow the first step, in which what does not fit the joint is lost.
void states(Trial& trial, int kind, bool anywhere) {
    constexpr int kJoints = 400;
    constexpr float kMass = 1;
    const Vec3 moments{0.02f, 0.06f, 0.05f};
    Dice dice;
    Scene scene;
    scene.settings.gravity = {};
    for (int i = 0; i < kJoints; ++i) {
        const DVec3 place{4.0 * i, 0, 0};
        const auto vector = [&](float size) {
            return size * Vec3{dice.between(-1, 1), dice.between(-1, 1), dice.between(-1, 1)};
        };
        BodyDef def = bodyWithMass(Sphere{0.2f}, place, kMass, moments, {});
        def.shapes[0].filter.mask = 0;
        const Quat turned =
            normalized(Quat{dice.between(-1, 1), dice.between(-1, 1), dice.between(-1, 1), dice.between(-1, 1)});
        const Vec3 arm{-0.3f, 0, 0};
        if (anywhere) def.pose.rotation = turned;
        def.pose.position = place - DVec3(rotate(def.pose.rotation, arm));
        def.angularVelocity = vector(6);
        def.linearVelocity = cross(def.angularVelocity, -rotate(def.pose.rotation, arm));
        SceneJoint joint{"", kWorld, add(scene, def), limitedJoint(dice, kind)};
        std::visit(
            [&](auto& each) {
                each.bodies.frameA.position = toVec3(place);
                each.bodies.frameB.position = arm;
            },
            joint.def);
        scene.joints.push_back(joint);
    }
    Run run = trial.start(scene);
    const auto energyOf = [&](int body) {
        const BodyMotion motion = run.motion(body);
        const DVec3 v(motion.v);
        const Vec3 w = inverseRotate(motion.pose.rotation, motion.w);
        const double turning = static_cast<double>(dot(w, scale(moments, w)));
        return 0.5 * (static_cast<double>(kMass) * (v.x * v.x + v.y * v.y + v.z * v.z) + turning);
    };
    run.step();
    std::vector<double> start;
    for (int i = 0; i < kJoints; ++i) start.push_back(energyOf(i));
    double gained = 0;
    int gaining = 0;
    std::vector<bool> did(kJoints, false);
    run.advance(2, [&] {
        for (int i = 0; i < kJoints; ++i) {
            const auto at = static_cast<std::size_t>(i);
            // What is at rest has nothing to compare with.
            const double gain = (energyOf(i) - start[at]) / std::max(start[at], 0.01);
            gained = std::max(gained, gain);
            if (!(gain <= 0.001) && !did[at]) ++gaining, did[at] = true;
        }
        return true;
    });
    trial.expectAtMost("energy gained", gained, 0.001, "1");
    trial.expectAtMost("joints that gain", gaining, 0, "1");
}

}  // namespace

Family limits() {
    Family family{"limits", {}};
    for (const int speed : {20, 200})
        family.cases.push_back(
            {fmt::format("rod at {} rad/s", speed), [speed](Trial& trial) { stop(trial, static_cast<float>(speed)); }});
    for (const int rate : {30, 60, 120, 240}) {
        family.cases.push_back(
            {fmt::format("rod falls on its stop, {} Hz", rate), [rate](Trial& t) { fall(t, rate); }});
        family.cases.push_back(
            {fmt::format("stop with restitution, {} Hz", rate), [rate](Trial& t) { rebound(t, rate); }});
    }
    for (int kind = 0; kind < static_cast<int>(std::size(kKinds)); ++kind)
        family.cases.push_back(
            {fmt::format("400 states of {}", kKinds[kind]), [kind](Trial& trial) { states(trial, kind, false); }});
    for (int kind = 0; kind < 4; ++kind)
        family.cases.push_back(
            {fmt::format("400 states of {}, anywhere", kKinds[kind]), [kind](Trial& t) { states(t, kind, true); }});
    for (const double zeta : {0.0, 0.1, 0.3, 0.6})
        family.cases.push_back(
            {fmt::format("soft stop, damping ratio {}", zeta), [zeta](Trial& t) { soft(t, 60, zeta); }});
    return family;
}

}  // namespace ragtop::stability
