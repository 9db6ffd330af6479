#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "constraints/stored_energy.h"
#include "joint_rig.h"
#include "ragtop/world.h"
#include "world_support.h"

namespace ragtop::test {
namespace {

/// A body that turns into a soft stop: k = 200 N m/rad, 0.02 kg m², ω = 100 rad/s, which is 0.4 rad per substep. It is
/// let go where k x + c v = 0, after Ω t = atan2(2 ζ √(1 − ζ²), 2 ζ² − 1), wherever in a substep it is met and left.
TEST(SoftStop, GivesBackTheSpeedOfItsSpringAndNeverMore) {
    constexpr double kSpeed = 6, kOmega = 100;
    for (const double ratio : {0.0, 0.1, 0.4}) {
        const double lean = std::sqrt(1 - ratio * ratio);
        const double turn = ratio > 0 ? std::atan2(2 * ratio * lean, 2 * ratio * ratio - 1) : std::numbers::pi;
        const double exact =
            -kSpeed * std::exp(-ratio * turn / lean) * (std::cos(turn) - ratio / lean * std::sin(turn));
        for (int phase = 0; phase < 16; ++phase) {
            Rig rig;
            rig.gravity = {};
            RigBody body = box(1, {0.1f, 0.1f, 0.1f}, {});
            body.inertia = {0.02f, 0.02f, 0.02f};
            body.w = {-static_cast<float>(kSpeed), 0, 0};
            HingeDef hinge;
            // A substep is 25 mrad long.
            hinge.limit = Range{-0.2f - 0.0016f * static_cast<float>(phase), 2};
            hinge.stop.stiffness = 200;
            hinge.stop.damping = static_cast<float>(2 * ratio * kOmega * 0.02);
            rig.join(0, rig.add(body), hinge);
            rig.run(0.15);
            EXPECT_NEAR(static_cast<double>(rig.bodies[1].w.x), exact, 1e-4 * kSpeed) << ratio << ", phase " << phase;
        }
    }
}

/// Damped springs x'' = −ω² x − 2ζω x' at both ends of a free range, followed by leaps of half a μs, half a kick on
/// both sides of each way: an end is met up to a leap late.
struct Rattle {
    static constexpr double kLeap = 5e-7;

    double omega, ratio, end, x, v;

    double force() const {
        const double beyond = x > end ? x - end : x < -end ? x + end : 0.0;
        const double push = -omega * (omega * beyond + 2 * ratio * v);
        return beyond > 0 ? std::min(push, 0.0) : beyond < 0 ? std::max(push, 0.0) : 0.0;
    }
    void follow(double time) {
        for (double t = 0; t < time - 0.5 * kLeap; t += kLeap) {
            v += 0.5 * kLeap * force();
            x += kLeap * v;
            v += 0.5 * kLeap * force();
        }
    }
};

/// What needs less than a substep from one stop to the other is in both within one, and is at all times where it should
/// be.
TEST(SoftStop, LeadsIntoTheOtherWithinASubstep) {
    constexpr double kSpeed = 60, kOmega = 100, kEnd = 0.05;  // a substep is 0.25 rad long
    for (const double ratio : {0.0, 0.02}) {
        Rig rig;
        rig.gravity = {};
        RigBody body = box(1, {0.1f, 0.1f, 0.1f}, {});
        body.inertia = {0.02f, 0.02f, 0.02f};
        body.w = {static_cast<float>(kSpeed), 0, 0};
        HingeDef hinge;
        hinge.limit = Range{-static_cast<float>(kEnd), static_cast<float>(kEnd)};
        hinge.stop.stiffness = 200;
        hinge.stop.damping = static_cast<float>(2 * ratio * kOmega * 0.02);
        rig.join(0, rig.add(body), hinge);
        Rattle exact{kOmega, ratio, kEnd, 0, kSpeed};
        for (int step = 0; step < 60; ++step) {
            rig.step();
            exact.follow(1.0 / 60);
            EXPECT_NEAR(static_cast<double>(rig.state().coordinate), exact.x, 1e-3 * kSpeed / kOmega)
                << ratio << ", step " << step;
        }
    }
}

struct RattlingPair {
    static constexpr float kMoments[] = {0.02f, 0.06f, 0.05f};

    World world;
    BodyId bodies[2];
    JointId joint;

    RattlingPair(float speed, const Range& range) : world(withoutGravity()) {
        for (int i = 0; i < 2; ++i) {
            const float side = i == 0 ? -1.0f : 1.0f;
            BodyDef def;
            def.pose.position = {0.3 * static_cast<double>(side), 0, 0};
            def.shapes.push_back({.geometry = Sphere{0.1f}});
            def.shapes[0].filter.mask = 0;
            def.mass = MassProperties{1, {}, {{kMoments[0], 0, 0}, {0, kMoments[1], 0}, {0, 0, kMoments[2]}}};
            def.angularVelocity = {side * speed, 2, 1};
            def.linearVelocity = cross(Vec3{0, 2, 1}, Vec3{side * 0.3f, 0, 0});
            bodies[i] = world.create(def);
        }
        HingeDef hinge;
        hinge.bodies = {bodies[0], bodies[1], {{0.3f, 0, 0}, {}}, {{-0.3f, 0, 0}, {}}};
        hinge.limit = range;
        hinge.stop.stiffness = 200;
        joint = world.create(JointDef(hinge));
    }
    double energy() const {
        double sum = 0;
        for (const BodyId id : bodies) {
            const Vec3 v = world.linearVelocity(id);
            const Vec3 w = inverseRotate(world.pose(id).rotation, world.angularVelocity(id));
            sum += 0.5 * static_cast<double>(dot(v, v) + kMoments[0] * w.x * w.x + kMoments[1] * w.y * w.y +
                                             kMoments[2] * w.z * w.z);
        }
        return sum;
    }
};

/// Two bodies that rattle between soft stops on their hinge, k = 200 N m/rad and 8,000 substeps of what turning adds:
/// springs without damping give back what they took, a hundred times over, also where bodies come from one stop into
/// the other within a substep. Compared while no stop is pressed.
TEST(SoftStop, TwoBodiesThatRattleKeepTheirEnergy) {
    struct Case {
        float speed;
        Range range;
    };
    for (const Case& each : {Case{8, {-0.3f, 0.5f}}, Case{30, {-0.1f, 0.1f}}}) {
        RattlingPair pair(each.speed, each.range);
        double start = 0;
        int seen = 0;
        for (int step = 0; step < 600; ++step) {
            pair.world.step(1.0f / 60);
            if (pair.world.state(pair.joint).limitMargin < 0) continue;
            if (++seen == 1) start = pair.energy();
            EXPECT_NEAR(pair.energy() / start, 1, 1e-3) << each.speed << ", step " << step;
        }
        EXPECT_GT(seen, 60) << each.speed;
    }
}

/// A wheel on its axle, on the world or on another wheel that gets the opposite torque, which pushes no centre of mass.
struct TurnedWheel {
    static constexpr float kMoment = 0.02f, kTorque = 0.1f, kStiffness = 2;
    static constexpr double kSubstep = 1.0 / 240;

    World world;
    BodyId wheel, other;
    JointId joint;
    bool pair;

    explicit TurnedWheel(bool twoWheels, float stiffness = kStiffness) : pair(twoWheels) {
        world.setSettings(withoutGravity());
        if (pair) other = add(-0.3, 1.5f);
        wheel = add(0.3, pair ? -1.5f : -3.0f);
        HingeDef hinge;
        hinge.bodies = {other, wheel, {{pair ? 0.3f : 0.0f, 0, 0}, {}}, {{-0.3f, 0, 0}, {}}};
        hinge.limit = Range{-0.2f, 1000};
        hinge.stop.stiffness = stiffness;
        joint = world.create(JointDef(hinge));
    }
    BodyId add(double x, float spin) {
        BodyDef def;
        def.pose.position = {x, 0, 0};
        def.shapes.push_back({.geometry = Sphere{0.1f}});
        def.shapes[0].filter.mask = 0;
        def.mass = MassProperties{1, {}, {{kMoment, 0, 0}, {0, kMoment, 0}, {0, 0, kMoment}}};
        def.angularVelocity = {spin, 0, 0};
        return world.create(def);
    }
    double angle() const { return static_cast<double>(world.state(joint).coordinate); }
    /// Of B against A.
    double speed() const {
        const float a = pair ? world.angularVelocity(other).x : 0.0f;
        return static_cast<double>(world.angularVelocity(wheel).x - a);
    }
    double moment() const { return static_cast<double>(kMoment) * (pair ? 0.5 : 1.0); }
    double energy() const {
        const double beyond = std::min(angle() + static_cast<double>(0.2f), 0.0);
        return 0.5 * moment() * speed() * speed() + 0.5 * static_cast<double>(kStiffness) * beyond * beyond;
    }
    void step(bool pushed) {
        if (pushed) {
            world.applyTorque(wheel, {kTorque, 0, 0});
            if (pair) world.applyTorque(other, {-kTorque, 0, 0});
        }
        world.step(1.0f / 60);
    }
};

/// A torque τ on a wheel that turns into its soft stop and out again gives  W = ∫ τ dθ,  which the wheel keeps: for as
/// long as it acts, only while the stop is pressed, or only from when it was left. Substeps take τ at once and turn
/// with the speed after it, so that ½ h Δω of Δθ does not count. Free of the stop, ω grows by τ t/I.
TEST(SoftStop, AWheelKeepsWhatATorqueGaveIt) {
    constexpr int kSteps = 120;
    enum Pushed { kAlways, kPressed, kAfter };
    for (const bool pair : {false, true}) {
        for (const Pushed when : {kAlways, kPressed, kAfter}) {
            TurnedWheel wheel(pair);
            const double start = wheel.energy(), torque = static_cast<double>(TurnedWheel::kTorque);
            double given = 0;
            int pressed = 0, left = 0;
            for (int i = 0; i < kSteps; ++i) {
                const double angle = wheel.angle(), speed = wheel.speed();
                const bool presses = angle < static_cast<double>(-0.2f);
                if (presses) ++pressed;
                const bool free = !presses && pressed > 0;
                const bool pushed = when == kAlways || (when == kPressed ? presses : free);
                wheel.step(pushed);
                const double gained = wheel.speed() - speed;
                if (pushed) given += torque * (wheel.angle() - angle - 0.5 * TurnedWheel::kSubstep * gained);
                if (!free) continue;
                ++left;
                // The stop is met and left within substeps, of which the torque has acted for the whole.
                const double part = torque * TurnedWheel::kSubstep * std::fabs(wheel.speed());
                EXPECT_NEAR(wheel.energy(), start + given, part + 1e-3 * start) << pair << when << ", step " << i;
                const double exact = pushed ? torque / wheel.moment() / 60 : 0.0;
                EXPECT_NEAR(gained, exact, 2e-6 * std::fabs(speed)) << pair << when << ", step " << i;
            }
            EXPECT_GT(pressed, 10) << pair << when;
            EXPECT_GT(left, 40) << pair << when;
        }
    }
}

/// Between steps what is pressed has the place and the speed of one time:  x = −(v/ω) sin ωt,  ẋ = −v cos ωt  from when
/// the stop is met. A substep is up to 0.6 rad of ωt.
TEST(SoftStop, HasTheSpeedOfItsPlaceWhilePressed) {
    for (const bool pair : {false, true})
        for (const float stiffness : {2.0f, 50.0f, 200.0f}) {
            TurnedWheel wheel(pair, stiffness);
            const double met = static_cast<double>(0.2f) / 3,
                         omega = std::sqrt(static_cast<double>(stiffness) / wheel.moment());
            int pressed = 0;
            for (int i = 1; i <= 30; ++i) {
                wheel.step(false);
                const double turn = omega * (i / 60.0 - met);
                if (turn < 0 || turn > std::numbers::pi) continue;
                ++pressed;
                EXPECT_NEAR(wheel.angle() + static_cast<double>(0.2f), -3 / omega * std::sin(turn), 3e-4 / omega)
                    << pair << stiffness << i;
                EXPECT_NEAR(wheel.speed(), -3 * std::cos(turn), 1e-3) << pair << ", " << stiffness << ", step " << i;
            }
            EXPECT_GE(pressed, 1) << pair << ", " << stiffness;
        }
}

/// A beam that its weight and a load on it press into a damped stop comes to rest: no force that holds another one is a
/// speed.
TEST(SoftStop, AtRestUnderALoadHasNoSpeed) {
    World world;
    WorldSettings settings;
    settings.sleeping = false;
    world.setSettings(settings);
    BodyDef def;
    def.shapes.push_back(shapeDef(Box{{0.5f, 0.05f, 0.2f}}));
    def.mass = MassProperties{2, {}, {{0.03f, 0, 0}, {0, 0.2f, 0}, {0, 0, 0.17f}}};
    const BodyId beam = world.create(def);
    def.shapes[0] = shapeDef(Box{{0.1f, 0.1f, 0.1f}});
    def.mass.reset();
    def.pose.position = {0.3, 0.15, 0};
    const BodyId load = world.create(def);
    const Quat across = rotationAbout({0, 1, 0}, -kPi / 2);
    HingeDef hinge;
    hinge.bodies = {{}, beam, {{-0.5f, 0, 0}, across}, {{-0.5f, 0, 0}, across}};
    hinge.limit = Range{-0.001f, 0.001f};
    hinge.stop = {0, 3000, 100};
    const JointId joint = world.create(JointDef(hinge));
    for (int step = 0; step < 300; ++step) world.step(1.0f / 60);
    EXPECT_LT(world.state(joint).limitMargin, -0.02f);  // (2 · 0.5 + 8 · 0.8) m · 9.81 N/3000 N m
    for (const BodyId body : {beam, load}) {
        EXPECT_LT(length(world.linearVelocity(body)), 1e-5f);
        EXPECT_LT(length(world.angularVelocity(body)), 1e-5f);
    }
}

/// Two bodies s apart that slide between soft stops while a torque τ turns them, a substep per step. About their common
/// centre
///   L = (2 I + μ s²) Ω = τ t,  and  ∫ τ Ω dt  is what the torque gives.
struct TurnedSlide {
    static constexpr double kMoment = 0.02, kMass = 1, kApart = 0.6, kTorque = 0.3, kStiffness = 200, kStep = 1.0 / 240;

    World world{withoutGravity()};
    BodyId first, second;
    JointId joint;

    TurnedSlide() {
        WorldSettings settings = withoutGravity();
        settings.substeps = 1;
        world.setSettings(settings);
        first = add(-1);
        second = add(1);
        SliderDef slider;
        slider.bodies = {first, second, {{0.3f, 0, 0}, {}}, {{-0.3f, 0, 0}, {}}};
        slider.limit = Range{-0.2f, 0.2f};
        slider.stop.stiffness = static_cast<float>(kStiffness);
        joint = world.create(JointDef(slider));
    }
    BodyId add(float side) {
        constexpr auto kI = static_cast<float>(kMoment);
        BodyDef def;
        def.pose.position = {0.5 * kApart * static_cast<double>(side), 0, 0};
        def.shapes.push_back({.geometry = Sphere{0.1f}});
        def.shapes[0].filter.mask = 0;
        def.mass = MassProperties{static_cast<float>(kMass), {}, {{kI, 0, 0}, {0, kI, 0}, {0, 0, kI}}};
        def.linearVelocity = {-side, 0, 0};
        return world.create(def);
    }
    bool isPressed() const { return world.state(joint).limitMargin < 0; }
    double spin() const { return static_cast<double>(world.angularVelocity(first).y); }
    double momentum() const {
        const double s = kApart + static_cast<double>(world.state(joint).coordinate);
        return (2 * kMoment + 0.5 * kMass * s * s) * spin();
    }
    double energy() const {
        double sum = 0;
        for (const BodyId id : {first, second}) {
            const Vec3 v = world.linearVelocity(id), w = world.angularVelocity(id);
            sum += 0.5 * (kMass * static_cast<double>(dot(v, v)) + kMoment * static_cast<double>(dot(w, w)));
        }
        return sum;
    }
};

/// While the torque acts nothing is settled, and its work is known as well as the turn is linear within a step; once it
/// acts no more, what the slide has is kept.
TEST(SoftStop, ASlideKeepsWhatATorqueGaveIt) {
    constexpr int kPushed = 720, kSteps = 1200;
    TurnedSlide slide;
    double due = slide.energy(), kept = 0;
    int times = 0;
    bool wasPressed = false;
    for (int i = 1; i <= kSteps; ++i) {
        const bool pushed = i <= kPushed;
        const double spin = slide.spin();
        if (pushed) slide.world.applyTorque(slide.first, {0, static_cast<float>(TurnedSlide::kTorque), 0});
        slide.world.step(static_cast<float>(TurnedSlide::kStep));
        if (pushed) due += TurnedSlide::kTorque * TurnedSlide::kStep * 0.5 * (spin + slide.spin());
        EXPECT_NEAR(slide.momentum(), TurnedSlide::kTorque * TurnedSlide::kStep * std::min(i, kPushed), 5e-4) << i;
        const bool presses = slide.isPressed();
        if (presses && !wasPressed) ++times;
        wasPressed = presses;
        if (presses) continue;
        const double energy = slide.energy();
        EXPECT_NEAR(energy / due, 1, 2e-3) << i;
        if (pushed) continue;
        if (!(kept > 0)) kept = energy;
        EXPECT_NEAR(energy / kept, 1, 1e-4) << i;
    }
    EXPECT_GT(times, 10);
}

/// A stop that stores ½ k m² of its margin m pushes with −k m ∇m: what turns B by ε about e changes m by ε a · e, a the
/// axis of its row. A twist stop's margin is c times the twist beyond it, c the cosine of half the swing, so that it
/// pushes across the twist too. Beyond what float shows, central differences are off by ε²/6 of a third derivative.
TEST(SoftStop, ATwistStopPushesAlongTheSlopeOfItsMargin) {
    constexpr float kTurn = 0.02f;
    constexpr double kRounding = 1e-6 / static_cast<double>(kTurn), kThird = 4;
    for (const float swing : {0.3f, 1.2f, 2.2f}) {
        for (const float twist : {-0.9f, 0.2f, 1.1f}) {
            Rig rig;
            RigBody body = box(1, {0.1f, 0.1f, 0.1f}, {});
            const Quat start = rotationAbout({0, 0.6f, 0.8f}, swing) * rotationAbout({1, 0, 0}, twist);
            BallDef ball;
            ball.twistLimit = Range{-0.4f, 0.5f};
            ball.stop.stiffness = 200;
            JointSim& joint = rig.join(0, rig.add(body), ball);
            const auto placed = [&](const Quat& rotation) {
                rig.bodies[1].rotation = rotation;
                rig.begin();
                placeJoint(joint, rig.atStep(joint), rig.states(), rig.inertia());
                return joint.ball;
            };
            const BallRows here = placed(start);
            const auto least = static_cast<double>(std::min(here.twistLower.margin, here.twistUpper.margin));
            const double stored = least < 0 ? 100 * least * least : 0;
            EXPECT_NEAR(storedEnergy(joint, rig.atStep(joint)), stored, 1e-5 * stored) << swing << ", " << twist;
            for (const Vec3& e : {Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}}) {
                const BallRows after = placed(rotationAbout(e, kTurn) * start);
                const BallRows before = placed(rotationAbout(e, -kTurn) * start);
                const auto slope = [](const StopSide& to, const StopSide& from) {
                    return static_cast<double>((to.margin - from.margin) / (2 * kTurn));
                };
                const double bound = kRounding + kThird * static_cast<double>(kTurn * kTurn) / 6;
                EXPECT_NEAR(static_cast<double>(dot(here.lowerTwistAxis(), e)),
                            slope(after.twistLower, before.twistLower), bound);
                EXPECT_NEAR(static_cast<double>(dot(here.upperTwistAxis(), e)),
                            slope(after.twistUpper, before.twistUpper), bound);
            }
        }
    }
}

/// A pendulum that swings against soft stops: its weight is a steady force, and what it gives and takes is no stop's.
/// Its highest energy in each second, of a substep's error in time like its lowest, stays.
TEST(SoftStop, APendulumKeepsItsEnergyUnderItsWeight) {
    constexpr float kGravity = 9.81f, kReach = 0.3f, kMoment = 0.02f;
    World world;
    WorldSettings settings;
    settings.gravity = {0, -kGravity, 0};
    world.setSettings(settings);
    BodyDef def;
    def.pose.position = {0, static_cast<double>(-kReach), 0};
    def.shapes.push_back({.geometry = Sphere{0.1f}});
    def.mass = MassProperties{1, {}, {{kMoment, 0, 0}, {0, kMoment, 0}, {0, 0, kMoment}}};
    def.angularVelocity = {5, 0, 0};
    def.linearVelocity = {0, 0, -5 * kReach};
    const BodyId body = world.create(def);
    HingeDef hinge;
    hinge.bodies = {{}, body, {}, {{0, kReach, 0}, {}}};
    hinge.limit = Range{-0.3f, 0.5f};
    hinge.stop.stiffness = 200;
    const JointId joint = world.create(JointDef(hinge));
    const auto highest = [&] {
        double most = 0;
        for (int step = 0; step < 60; ++step) {
            world.step(1.0f / 60);
            if (world.state(joint).limitMargin < 0) continue;
            const Vec3 v = world.linearVelocity(body), w = world.angularVelocity(body);
            const double height = world.pose(body).position.y + static_cast<double>(kReach);
            most = std::max(most, 0.5 * static_cast<double>(dot(v, v) + kMoment * dot(w, w)) +
                                      static_cast<double>(kGravity) * height);
        }
        return most;
    };
    const double first = highest();
    for (int second = 1; second < 20; ++second) EXPECT_NEAR(highest() / first, 1, 0.02) << second;
}

/// The angular momentum about the axle, divided by the mass of 1 kg, after a ball met what hangs on a hinge, far from
/// its stops.
double momentumAfterABall(float stiffness) {
    constexpr float kReach = 0.3f, kMoment = 0.02f, kBall = 0.004f;
    WorldSettings settings = withoutGravity();
    settings.solver = SolverChoice::iterative;
    World world(settings);
    BodyDef def;
    def.shapes.push_back({.geometry = Sphere{0.1f}});
    def.pose.position = {0, static_cast<double>(-kReach), -1};
    def.mass = MassProperties{1, {}, {{kBall, 0, 0}, {0, kBall, 0}, {0, 0, kBall}}};
    def.linearVelocity = {0, 0, 3};
    const BodyId ball = world.create(def);
    def.pose.position.z = 0;
    def.mass = MassProperties{1, {}, {{kMoment, 0, 0}, {0, kMoment, 0}, {0, 0, kMoment}}};
    def.linearVelocity = {};
    const BodyId bob = world.create(def);
    HingeDef hinge;
    hinge.bodies = {{}, bob, {}, {{0, kReach, 0}, {}}};
    hinge.limit = Range{-3, 3};
    hinge.stop.stiffness = stiffness;
    const JointId joint = world.create(JointDef(hinge));
    const auto momentum = [&] {
        const DVec3 x = world.pose(ball).position;
        const Vec3 v = world.linearVelocity(ball);
        return x.y * static_cast<double>(v.z) - x.z * static_cast<double>(v.y) +
               static_cast<double>(kBall * world.angularVelocity(ball).x) +
               static_cast<double>((kMoment + kReach * kReach) * world.angularVelocity(bob).x);
    };
    for (int step = 0; step < 40; ++step) world.step(1.0f / 60);
    EXPECT_LT(world.angularVelocity(bob).x, -3);
    EXPECT_GT(world.state(joint).limitMargin, 0);
    return momentum();
}

/// Stops that nothing has touched take nothing of what a ball gives, however soft they are: contacts close to 1e-3.
TEST(SoftStop, WhatABallGivesIsKept) {
    constexpr double kStart = -0.9;
    const double soft = momentumAfterABall(200), hard = momentumAfterABall(0);
    EXPECT_NEAR(soft, kStart, 1e-3);
    EXPECT_NEAR(soft, hard, 1e-5);
}

}  // namespace
}  // namespace ragtop::test
