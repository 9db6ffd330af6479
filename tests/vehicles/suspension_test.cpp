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

/// A strut on a tire that hardly yields.
StrutSpec strutOf(const SuspensionDef& def, float load, float g, float tireStiffness = 1e9f) {
    WheelDef wheel;
    wheel.suspension = def;
    wheel.tire.radialStiffness = tireStiffness;
    return makeStrut(wheel, load, g);
}

/// The period of a mass that sways on a strut and its tire; two crossings apart it has the same phase.
double periodOf(const StrutSpec& strut, float load, float g, float h) {
    const float mass = load / g;
    double height = -0.02, speed = 0, crossing = -1;
    float compression = 0.02f;
    for (int i = 0; i < 40000; ++i) {
        const auto free = static_cast<float>(speed) - h * g;
        const float squash = static_cast<float>(-height) - compression + strut.tireSquash;
        const StrutVisit visit = solveStrut(strut, compression, squash, 1, h, 1 / mass, free);
        compression += visit.way;
        speed += static_cast<double>(visit.impulse) / static_cast<double>(mass) - static_cast<double>(h * g);
        const double before = height;
        height += static_cast<double>(h) * speed;
        if (before < 0 && height >= 0) {
            const double now = (i + before / (before - height)) * static_cast<double>(h);
            if (crossing >= 0) return now - crossing;
            crossing = now;
        }
    }
    return 0;
}

/// Backward Euler lengthens the period by (ω h)²/3 relative, 1e-6 here.
TEST(Strut, SwaysAtItsFrequency) {
    SuspensionDef def;
    def.frequency = 1.4f;
    def.dampingRatio = 0;
    def.travelUp = def.travelDown = 1;
    EXPECT_NEAR(periodOf(strutOf(def, 3000, 9.81f), 3000, 9.81f, 1.0f / 4000), 1 / 1.4, 2e-3 / 1.4);
}

/// Springs in series: 1/k = 1/k_strut + 1/k_tire, so that with a tire as stiff as the strut the period is √2 longer.
TEST(Strut, SwaysOnATireAsSpringsInSeriesDo) {
    SuspensionDef def;
    def.stiffness = 30000.0f;
    def.dampingRatio = 0;
    def.travelUp = def.travelDown = 1;
    const double mass = 3000 / 9.81;
    for (const float tire : {30000.0f, 200000.0f}) {
        const double both = 1 / (1 / 30000.0 + 1 / static_cast<double>(tire));
        const double expected = 2 * 3.14159265358979 * std::sqrt(mass / both);
        EXPECT_NEAR(periodOf(strutOf(def, 3000, 9.81f, tire), 3000, 9.81f, 1.0f / 4000), expected, 2e-3 * expected);
    }
}

/// However stiff the strut and long the step, it stops what falls on it and never throws it back faster.
TEST(Strut, NeverOvershoots) {
    for (const float stiffness : {1e3f, 1e6f, 1e9f, 1e12f}) {
        SuspensionDef def;
        def.stiffness = stiffness;
        const StrutSpec strut = strutOf(def, 3000, 9.81f);
        const float K = 1.0f / 300, free = -5;
        const float impulse = solveStrut(strut, 0, strut.tireSquash, 1, 1.0f / 30, K, free).impulse;
        EXPECT_LE(free + K * impulse, 3000 * K / 30 + 1e-3f) << stiffness;
        EXPECT_GE(impulse, 0);
    }
}

TEST(Strut, PushesOnly) {
    const StrutSpec strut = strutOf({}, 3000, 9.81f);
    EXPECT_EQ(solveStrut(strut, 0, strut.tireSquash, 1, 1.0f / 240, 1.0f / 300, 50).impulse, 0);
}

/// However fast the ground comes up, a tire presses with no more than it is squashed by, and the strut gives way.
TEST(Strut, OnATireMeetsAKerbWithTheTiresForce) {
    const StrutSpec strut = strutOf({}, 3000, 9.81f, 200000);
    const float h = 1.0f / 1000, speed = 50;
    const StrutVisit visit = solveStrut(strut, 0, strut.tireSquash, 1, h, 0, -speed);
    EXPECT_LE(visit.impulse / h, 3000 + 200000 * speed * h);
    EXPECT_GT(visit.way, 0);
    EXPECT_LT(visit.way, speed * h);
}

/// Springs and stops hold the work that compresses them, from the droop stop to the metal, and tires on their rims.
TEST(Strut, HoldsTheWorkThatIsDoneOnIt) {
    SuspensionDef def;
    def.bumpStopProgression = 2;
    def.droopStopStiffness = 5;
    def.droopStopProgression = 1;
    const StrutSpec strut = strutOf(def, 3000, 9.81f, 200000);
    constexpr int kParts = 20000;
    const float from = strut.travelLeast, to = 1.2f * strut.travelMost, each = (to - from) / kParts;
    double work = 0;
    for (int i = 0; i < kParts; ++i)
        work += static_cast<double>(each * springForce(strut, from + (static_cast<float>(i) + 0.5f) * each));
    EXPECT_NEAR((springEnergy(strut, to) - springEnergy(strut, from)) / work, 1, 1e-4);

    double squashing = 0;
    float squash = 0;
    for (float load = 10; squash < 2 * strut.rimSquash; load += 20) {
        const float next = squashUnder(strut, load + 10);
        squashing += static_cast<double>(load * (next - squash));
        squash = next;
    }
    EXPECT_NEAR(squashEnergy(strut, squash) / squashing, 1, 1e-4);
}

TEST(Strut, LetsAWheelInTheAirFallToItsDroopStop) {
    const StrutSpec strut = strutOf({}, 3000, 9.81f);
    float compression = 0.05f;
    for (int i = 0; i < 240; ++i) {
        const float way = fallOfWheel(strut, compression, 1.0f / 240);
        EXPECT_LE(way, 0);
        compression += way;
    }
    EXPECT_FLOAT_EQ(compression, -strut.travelDown);
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
