#include "suspension.h"

#include <gtest/gtest.h>

#include <cmath>

#include "steering.h"

namespace ragtop {
namespace {

TEST(StaticLoads, FollowTheLeverLaw) {
    const float weight = 12000, a = 1.1f, b = 1.4f;
    const auto loads = staticLoads({{0.7f, 0, a}, {-0.7f, 0, a}, {0.7f, 0, -b}, {-0.7f, 0, -b}}, weight);
    ASSERT_EQ(loads.size(), 4u);
    EXPECT_NEAR(loads[0] + loads[1], weight * b / (a + b), 1e-5f * weight);
    EXPECT_NEAR(loads[2] + loads[3], weight * a / (a + b), 1e-5f * weight);
    EXPECT_NEAR(loads[0], loads[1], 1e-6f * weight);
}

TEST(StaticLoads, AreNoneForWheelsInALine) {
    EXPECT_TRUE(staticLoads({{0, 0, 1}, {0, 0, 0}, {0, 0, -1}}, 1000).empty());
}

/// A mass on a strut, free to move: two periods apart the undamped sway has the same phase. Backward Euler lengthens
/// the period by (ω h)²/3 relative, 1e-6 here.
TEST(Strut, SwaysAtItsFrequency) {
    SuspensionDef def;
    def.frequency = 1.4f;
    def.dampingRatio = 0;
    def.travelUp = def.travelDown = 1;
    const float load = 3000, g = 9.81f, mass = load / g, h = 1.0f / 4000;
    const StrutSpec strut = makeStrut(def, load, g);
    double height = -0.02, speed = 0;
    double crossing = -1, period = 0;
    for (int i = 0; i < 8000; ++i) {
        const auto free = static_cast<float>(speed) - h * g;
        const float impulse = solveStrut(strut, static_cast<float>(-height), 1, h, 1 / mass, free);
        speed += static_cast<double>(impulse) / static_cast<double>(mass) - static_cast<double>(h * g);
        const double before = height;
        height += static_cast<double>(h) * speed;
        if (before < 0 && height >= 0) {
            const double now = (i + before / (before - height)) * static_cast<double>(h);
            if (crossing >= 0 && period == 0) period = now - crossing;
            crossing = now;
        }
    }
    EXPECT_NEAR(period, 1 / 1.4, 2e-3 / 1.4);
}

/// However stiff the strut and long the step, it stops what falls on it and never throws it back faster.
TEST(Strut, NeverOvershoots) {
    for (const float stiffness : {1e3f, 1e6f, 1e9f, 1e12f}) {
        SuspensionDef def;
        def.stiffness = stiffness;
        const StrutSpec strut = makeStrut(def, 3000, 9.81f);
        const float K = 1.0f / 300, free = -5;
        const float impulse = solveStrut(strut, 0, 1, 1.0f / 30, K, free);
        EXPECT_LE(free + K * impulse, 3000 * K / 30 + 1e-3f) << stiffness;
        EXPECT_GE(impulse, 0);
    }
}

TEST(Strut, PushesOnly) {
    const StrutSpec strut = makeStrut({}, 3000, 9.81f);
    EXPECT_EQ(solveStrut(strut, 0, 1, 1.0f / 240, 1.0f / 300, 50), 0);
}

TEST(Steering, TurnsAllWheelsAboutOnePoint) {
    const SteeringDef def;
    const float wheelbase = 2.5f, track = 1.5f, angle = 0.4f;
    const double radius = wheelbase / std::tan(0.4);
    for (const float side : {0.5f * track, -0.5f * track}) {
        const Vec3 d = wheelDirection(def, 1, {side, 0, wheelbase}, angle);
        EXPECT_NEAR(d.x / d.z, wheelbase / (radius - side), 1e-5);
        EXPECT_NEAR(length(d), 1, 1e-6);
    }
    SteeringDef parallel;
    parallel.ackermann = 0;
    const Vec3 d = wheelDirection(parallel, 1, {0.75f, 0, wheelbase}, angle);
    EXPECT_NEAR(d.x / d.z, std::tan(0.4), 1e-6);
}

TEST(Steering, GoesNoFasterThanItsRateAndLessFarAtSpeed) {
    SteeringDef def;
    def.halfAngleSpeed = 20.0f;
    float angle = 0;
    angle = steeredAngle(def, angle, -1, 0, 0.1f);
    EXPECT_FLOAT_EQ(angle, 0.1f * def.rate);
    for (int i = 0; i < 100; ++i) angle = steeredAngle(def, angle, -1, 0, 0.1f);
    EXPECT_FLOAT_EQ(angle, def.maxAngle);
    for (int i = 0; i < 100; ++i) angle = steeredAngle(def, angle, -1, 20, 0.1f);
    EXPECT_FLOAT_EQ(angle, 0.5f * def.maxAngle);
}

}  // namespace
}  // namespace ragtop
