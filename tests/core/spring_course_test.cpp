#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

#include "constraints/spring_lead.h"
#include "world_support.h"

// Springs against x'' + 2 ζ ω x' + ω² x = f at the time that is reported: places and speeds.
namespace ragtop::test {
namespace {

using Complex = std::complex<double>;

struct State {
    double x, v;
};

struct Oscillator {
    double omega, zeta, load;

    /// By the roots of the characteristic equation, or by the limit where they are one.
    State after(const State& from, double t) const {
        const double rest = load / (omega * omega), x = from.x - rest, decay = zeta * omega;
        if (zeta == 1) {
            const double rate = from.v + decay * x, left = std::exp(-decay * t);
            return {left * (x + rate * t) + rest, left * (rate - decay * (x + rate * t))};
        }
        const Complex root = std::sqrt(Complex(zeta * zeta - 1));
        const Complex r1 = omega * (-zeta + root), r2 = omega * (-zeta - root), a = (from.v - r2 * x) / (r1 - r2);
        const Complex first = a * std::exp(r1 * t), second = (x - a) * std::exp(r2 * t);
        return {(first + second).real() + rest, (r1 * first + r2 * second).real()};
    }
    double scale(const State& start) const {
        return std::max({std::abs(start.x), std::abs(start.v) / omega, std::abs(load) / (omega * omega)});
    }
};

enum class Sprung { slider, distance, hinge, ball };
constexpr bool turns(Sprung kind) { return kind == Sprung::hinge || kind == Sprung::ball; }

/// One body on the world, or two that share the motion, along x or about it.
class SprungBodies {
public:
    SprungBodies(Sprung kind, bool two, const Oscillator& law, const State& start, SolverChoice solver) : kind_(kind) {
        WorldSettings settings;
        settings.gravity = {static_cast<float>(law.load), 0, 0};
        settings.solver = solver;
        world.setSettings(settings);
        const double share = two ? 0.5 : 1.0, moved = share * (turns(kind) ? kMoment : kMass);
        if (two) first_ = add({0, -0.5 * start.v});
        second_ = add({start.x + (kind == Sprung::distance ? kRest : 0), share * start.v});
        const Spring spring{static_cast<float>(moved * law.omega * law.omega),
                            static_cast<float>(2 * moved * law.zeta * law.omega)};
        const JointBodies bodies{first_, second_};
        if (kind == Sprung::slider) joint_ = world.create(JointDef(SliderDef{.bodies = bodies, .spring = spring}));
        if (kind == Sprung::hinge) joint_ = world.create(JointDef(HingeDef{.bodies = bodies, .spring = spring}));
        if (kind == Sprung::ball) joint_ = world.create(JointDef(BallDef{.bodies = bodies, .spring = spring}));
        if (kind == Sprung::distance)
            joint_ = world.create(
                JointDef(DistanceDef{.bodies = bodies, .spring = spring, .rest = static_cast<float>(kRest)}));
    }
    State state() const {
        if (turns(kind_))
            return {static_cast<double>(world.state(joint_).coordinate), of(world, &World::angularVelocity)};
        const double first = first_.isNull() ? 0.0 : world.pose(first_).position.x;
        return {world.pose(second_).position.x - first - (kind_ == Sprung::distance ? kRest : 0),
                of(world, &World::linearVelocity)};
    }
    void keepAwake() {
        WorldSettings settings = world.settings();
        settings.sleeping = false;
        world.setSettings(settings);
    }
    /// Of the second body.
    void displace(const State& to) {
        world.setPose(second_, Pose{{to.x, 0, 0}, {}});
        world.setVelocity(second_, {static_cast<float>(to.v), 0, 0}, {});
    }

    World world;

private:
    static constexpr double kMass = 2, kMoment = 0.1, kRest = 1;

    double of(const World& from, Vec3 (World::*velocity)(BodyId) const) const {
        const float before = first_.isNull() ? 0.0f : (from.*velocity)(first_).x;
        return static_cast<double>((from.*velocity)(second_).x - before);
    }
    BodyId add(const State& at) {
        constexpr auto kI = static_cast<float>(kMoment);
        const auto x = static_cast<float>(at.x), v = static_cast<float>(at.v);
        BodyDef def;
        def.shapes.push_back(shapeDef(Sphere{0.2f}));
        def.shapes[0].filter.mask = 0;
        def.mass = MassProperties{static_cast<float>(kMass), {}, {{kI, 0, 0}, {0, kI, 0}, {0, 0, kI}}};
        (turns(kind_) ? def.angularVelocity : def.linearVelocity) = {v, 0, 0};
        if (turns(kind_))
            def.pose.rotation = rotationAbout({1, 0, 0}, x);
        else
            def.pose.position.x = at.x;
        return world.create(def);
    }

    Sprung kind_;
    BodyId first_, second_;
    JointId joint_;
};

constexpr Sprung kSprungKinds[] = {Sprung::slider, Sprung::distance, Sprung::hinge, Sprung::ball};

/// Displaced, thrown, or dropped into its spring: places and speeds of each step are those of the closed form up to
/// (ωh)²/12, by which speeds of rows differ from those of places, and single precision.
TEST(SpringCourse, IsThatOfADampedOscillatorAtTheTimeOfTheStep) {
    for (const Sprung kind : kSprungKinds)
        for (const bool two : {false, true})
            for (const double hertz : {2.0, 8.0})
                for (const double zeta : {0.0, 0.3, 1.0, 3.0})
                    for (const int start : {0, 1, 2}) {
                        if (start == 2 && (two || turns(kind))) continue;
                        const Oscillator law{2 * std::numbers::pi * hertz, zeta, start == 2 ? -9.81 : 0};
                        const State from{start == 0 ? 0.4 : 0.0, start == 1 ? 2.0 : 0.0};
                        SprungBodies bodies(kind, two, law, from, SolverChoice::iterative);
                        bodies.keepAwake();
                        double place = 0, speed = 0;
                        for (int step = 1; step <= 60; ++step) {
                            bodies.world.step(kDt);
                            const State now = bodies.state(), exact = law.after(from, step * kDt);
                            place = std::max(place, std::abs(now.x - exact.x));
                            speed = std::max(speed, std::abs(now.v - exact.v) / law.omega);
                        }
                        const double turn = law.omega * kDt / 4, scale = law.scale(from);
                        const double bound = (turn * turn / 12 + 2e-4) * scale;
                        EXPECT_LT(place, bound)
                            << static_cast<int>(kind) << two << hertz << ' ' << zeta << ' ' << start;
                        EXPECT_LT(speed, bound)
                            << static_cast<int>(kind) << two << hertz << ' ' << zeta << ' ' << start;
                    }
}

TEST(SpringCourse, IsTheSameWhereItIsSolvedDirectly) {
    const Oscillator law{2 * std::numbers::pi * 2, 0.3, 0};
    for (const Sprung kind : kSprungKinds) {
        SprungBodies bodies(kind, true, law, {0.4, 0}, SolverChoice::direct);
        for (int step = 1; step <= 60; ++step) {
            bodies.world.step(kDt);
            const State now = bodies.state(), exact = law.after({0.4, 0}, step * kDt);
            EXPECT_NEAR(now.x, exact.x, 4e-4) << static_cast<int>(kind) << ", step " << step;
            EXPECT_NEAR(now.v, exact.v, 4e-4 * law.omega) << static_cast<int>(kind) << ", step " << step;
        }
    }
}

/// Kinetic energy and that of the spring, of the same time: an undamped spring keeps their sum to (ωh)²/6 for good.
TEST(SpringCourse, KeepsItsEnergyAtEachStep) {
    const Oscillator law{2 * std::numbers::pi * 8, 0, 0};
    const double turn = law.omega * kDt / 4;
    for (const Sprung kind : kSprungKinds) {
        SprungBodies bodies(kind, true, law, {0.4, 0}, SolverChoice::automatic);
        const double start = law.omega * law.omega * 0.4 * 0.4;
        for (int step = 0; step < 1200; ++step) {
            bodies.world.step(kDt);
            const State now = bodies.state();
            const double energy = now.v * now.v + law.omega * law.omega * now.x * now.x;
            EXPECT_NEAR(energy / start, 1, turn * turn / 6 + 1e-3) << static_cast<int>(kind) << ", step " << step;
        }
    }
}

/// What hangs on a spring and rests has no speed, however stiff the spring is, and sleeps.
TEST(SpringCourse, WhatRestsUnderALoadHasNoSpeed) {
    for (const double hertz : {1.0, 10.0, 100.0}) {
        const Oscillator law{2 * std::numbers::pi * hertz, 1, -9.81};
        const double rest = law.load / (law.omega * law.omega);
        SprungBodies bodies(Sprung::slider, false, law, {rest, 0}, SolverChoice::automatic);
        for (int step = 0; step < 120; ++step) {
            bodies.world.step(kDt);
            EXPECT_NEAR(bodies.state().x, rest, 1e-4) << hertz;
            EXPECT_NEAR(bodies.state().v, 0, 1e-4) << hertz;
        }
        EXPECT_EQ(bodies.world.stats().awakeBodies, 0) << hertz;
    }
}

/// A pose that is set has the speed that was given to it.
TEST(SpringCourse, GoesOnFromAPlaceThatWasSet) {
    const Oscillator law{2 * std::numbers::pi * 2, 0, 0};
    SprungBodies bodies(Sprung::slider, false, law, {0, 0}, SolverChoice::iterative);
    for (int step = 0; step < 10; ++step) bodies.world.step(kDt);
    bodies.displace({0.4, 0});
    for (int step = 1; step <= 60; ++step) {
        bodies.world.step(kDt);
        EXPECT_NEAR(bodies.state().x, law.after({0.4, 0}, step * kDt).x, 1e-3 * 0.4) << step;
    }
}

/// β of an undamped spring, (1 − cos θ)/(θ sin θ) with θ = ωh, is ½ where it is slow; of a damper without stiffness the
/// limit 1 + 1/x − 1/(1 − e^{−x}); and it has no step where damping becomes critical.
TEST(SpringLead, HasTheShareOfTheExactCourse) {
    const float h = 1.0f / 240;
    for (const double turn : {0.01, 0.1, 0.5, 0.99}) {
        const auto stiffness = static_cast<float>(turn * turn / static_cast<double>(h * h));
        const double exact = (1 - std::cos(turn)) / (turn * std::sin(turn));
        EXPECT_NEAR(static_cast<double>(leadShare(stiffness, 0, 1, h)), exact, 1e-5) << turn;
        const float critical = 2 * std::sqrt(stiffness);
        const float below = leadShare(stiffness, 0.9999f * critical, 1, h), at = leadShare(stiffness, critical, 1, h),
                    above = leadShare(stiffness, 1.0001f * critical, 1, h);
        EXPECT_NEAR(below, at, 1e-4f) << turn;
        EXPECT_NEAR(above, at, 1e-4f) << turn;
    }
    for (const double x : {0.01, 0.3, 5.0}) {
        const auto damping = static_cast<float>(x / static_cast<double>(h));
        EXPECT_NEAR(static_cast<double>(leadShare(1e-3f, damping, 1, h)), 1 + 1 / x - 1 / (1 - std::exp(-x)), 1e-4)
            << x;
    }
    // What exceeds a radian in h takes no more speed along than a spring of a radian does.
    EXPECT_NEAR(leadShare(4 / (h * h), 0, 1, h), 0.25f * leadShare(1 / (h * h), 0, 1, h), 1e-6f);
}

}  // namespace
}  // namespace ragtop::test
