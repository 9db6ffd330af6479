#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "constraints/joint_swing.h"
#include "joint_rig.h"

// Stops, friction and drives against what mechanics says, at steps from 30 to 240 a second.
namespace ragtop::test {
namespace {

constexpr double kDegree = 3.14159265358979323846 / 180;
constexpr double kRates[] = {30, 60, 120, 240};
const Quat kAlongZ = rotationBetween({1, 0, 0}, {0, 0, 1});

Rig flywheel(HingeDef def, float inertia, float speed) {
    Rig rig;
    rig.gravity = {};
    rig.add({{}, {}, {}, {0, 0, speed}, 2, {inertia, inertia, inertia}, 0});
    def.bodies = frames({}, {}, kAlongZ, kAlongZ);
    rig.join(0, 1, def);
    return rig;
}

/// A 1 kg rod of 1 m on a hinge at its end, level, along x.
Rig rod(HingeDef def, float speed) {
    Rig rig;
    RigBody body = box(1, {0.5f, 0.02f, 0.02f}, {0.5, 0, 0});
    body.w = {0, 0, speed};
    body.v = {0, 0.5f * speed, 0};
    rig.add(body);
    def.bodies = frames({}, {-0.5f, 0, 0}, kAlongZ, kAlongZ);
    rig.join(0, 1, def);
    rig.begin();
    return rig;
}
double angleOf(const Rig& rig) { return static_cast<double>(rig.state().coordinate); }

TEST(HingeFriction, StopsAfterTheExactAngleAtEveryStep) {
    for (const double rate : kRates) {
        HingeDef def;
        def.friction = 0.5f;
        Rig rig = flywheel(def, 0.1f, 10);
        rig.dt = 1 / rate;
        rig.run(2.5);
        EXPECT_NEAR(angleOf(rig), 10, 1e-3) << rate;
        EXPECT_NEAR(rig.state().speed, 0, 1e-6);
    }
}

TEST(HingeFriction, WorksWhileAMotorRuns) {
    HingeDef def;
    def.friction = 0.5f;
    def.motor = Motor{20, 2};
    Rig rig = flywheel(def, 0.1f, 0);
    rig.run(1);  // (2 − 0.5)/0.1 = 15 rad/s²
    EXPECT_NEAR(rig.state().speed, 15, 0.01);
    EXPECT_NEAR(angleOf(rig), 7.5, 0.01);
}

TEST(HingeFriction, BreakawayHoldsWhatMotionDoesNot) {
    // The rod's weight gives 4.905 N m.
    for (const float breakaway : {0.8f, 1.2f}) {
        HingeDef def;
        def.friction = 4;
        def.bearing = Bearing{breakaway, 0, 0, 0};
        Rig rig = rod(def, 0);
        rig.run(1);
        if (breakaway > 0.905f) {
            EXPECT_NEAR(angleOf(rig), 0, 1e-4);
        } else {
            EXPECT_LT(angleOf(rig), -0.2);
        }
    }
}

TEST(HingeFriction, ViscousTorqueDecaysExponentially) {
    for (const double rate : kRates) {
        HingeDef def;
        def.bearing = Bearing{0, 0.05f, 0, 0};
        Rig rig = flywheel(def, 0.1f, 10);
        rig.dt = 1 / rate;
        rig.run(2);  // e^{−1}
        EXPECT_NEAR(rig.state().speed, 10 * std::exp(-1.0), 1e-3) << rate;
        EXPECT_NEAR(angleOf(rig), 20 * (1 - std::exp(-1.0)), 2e-3) << rate;
    }
}

/// A pendulum on a thick pin loses amplitude by μ r R per unit of its torque. For small swings R is its weight: each
/// half swing falls by 2 μ r/(l/2).
TEST(HingeFriction, LoadGivesThePendulumItsLinearDecay) {
    const double mu = 0.1, radius = 0.01;
    for (const double rate : kRates) {
        HingeDef def;
        def.bearing = Bearing{0, 0, static_cast<float>(mu), static_cast<float>(radius)};
        Rig rig;
        RigBody body = box(1, {0.02f, 0.5f, 0.02f}, {});
        body.rotation = rotationAbout({0, 0, 1}, 0.1f);
        body.position = DVec3(rotate(body.rotation, {0, -0.5f, 0}));
        rig.add(body);
        def.bodies = frames({}, {0, 0.5f, 0}, kAlongZ, kAlongZ);
        rig.join(0, 1, def);
        rig.dt = 1 / rate;
        rig.begin();
        // Peaks by parabolas through three samples.
        double a = angleOf(rig), b = a, first = 0.1, last = 0.1;
        int peaks = 0;
        for (int i = 0; peaks < 8; ++i) {
            ASSERT_LT(i, 20 * rate);
            rig.step();
            const double c = angleOf(rig);
            if (i > 0 && (b - a) * (c - b) < 0) {
                const double bend = a - 2 * b + c;
                last = std::abs(b - (c - a) * (c - a) / (8 * bend));
                ++peaks;
            }
            a = b, b = c;
        }
        const double fall = 8 * 2 * mu * radius / 0.5;
        EXPECT_NEAR(first - last, fall, 0.01 * fall) << rate;
    }
}

/// The substep loop, so that nothing hides between two steps: the stop is looked at at each of them.
TEST(HingeStop, ARodThatFallsOnItNeitherPassesNorReboundsAtEveryStep) {
    for (const double rate : kRates) {
        HingeDef def;
        def.limit = Range{-1, 1};
        Rig rig = rod(def, 0);
        rig.dt = 1 / rate / rig.substeps;
        rig.substeps = 1;
        double lowest = 0, highestAfter = -1;
        for (int i = 0; i < static_cast<int>(2 / rig.dt); ++i) {
            rig.step();
            lowest = std::min(lowest, angleOf(rig));
            if (lowest < -1 + 1e-3) highestAfter = std::max(highestAfter, angleOf(rig));
        }
        EXPECT_GT(lowest, -1 - 0.1 * kDegree) << rate;
        EXPECT_LT(highestAfter, -1 + 0.05 * kDegree) << rate;
    }
}

TEST(HingeStop, ReboundsWithItsRestitutionAtEveryStep) {
    for (const double rate : kRates)
        for (const float restitution : {0.3f, 0.5f, 0.9f, 1.0f}) {
            HingeDef def;
            def.limit = Range{-1, 1};
            def.stop.restitution = restitution;
            Rig rig = rod(def, 0);
            rig.dt = 1 / rate;
            double apex = -1, lowest = 0, before = 0;
            int strikes = 0;
            for (int i = 0; i < static_cast<int>(2 * rate) && strikes < 2; ++i) {
                rig.step();
                const double speed = rig.state().speed;
                lowest = std::min(lowest, angleOf(rig));
                if (before < 0 && speed > 0) ++strikes;
                before = speed;
                if (strikes == 1) apex = std::max(apex, angleOf(rig));
            }
            // Energy m g l/2 sin: from −1 it rises e² of the height that it fell.
            const double exact =
                std::asin(-std::sin(1.0) + static_cast<double>(restitution * restitution) * std::sin(1.0));
            const double ratio = std::sqrt((std::sin(apex) + std::sin(1.0)) / std::sin(1.0));
            EXPECT_NEAR(ratio, restitution, 0.05 * static_cast<double>(restitution))
                << rate << " apex " << apex << " of " << exact;
            EXPECT_GT(lowest, -1 - 0.1 * kDegree);
        }
}

TEST(HingeStop, FastImpactsGainNothing) {
    for (const double rate : kRates)
        for (const float speed : {20.0f, 200.0f})
            for (const float restitution : {0.0f, 0.5f, 1.0f}) {
                HingeDef def;
                def.limit = Range{-1, 1};
                def.stop.restitution = restitution;
                Rig rig = rod(def, speed);
                rig.gravity = {};
                rig.begin();
                const double energy = rig.energy();
                rig.dt = 1 / rate;
                for (int i = 0; i < static_cast<int>(rate); ++i) {
                    rig.step();
                    ASSERT_LE(rig.energy(), energy * 1.001) << rate << " " << speed << " e " << restitution;
                    ASSERT_LE(std::abs(angleOf(rig)), 1 + 0.01);
                }
            }
}

/// Thrown at a soft stop with gravity off: half a period of the damped oscillator, which leaves with e^{−π ζ/√(1−ζ²)}.
TEST(HingeStop, SoftStopHasItsFrequencyAndRebound) {
    const double inertia = 0.1, omega = 2 * 3.14159265358979323846 * 3;
    for (const double rate : kRates)
        for (const double zeta : {0.0, 0.1, 0.2}) {
            HingeDef def;
            def.limit = Range{-10, 0.2f};
            def.stop.stiffness = static_cast<float>(inertia * omega * omega);
            def.stop.damping = static_cast<float>(2 * zeta * inertia * omega);
            Rig rig = flywheel(def, static_cast<float>(inertia), 4);
            rig.dt = 1 / rate;
            const double damped = omega * std::sqrt(1 - zeta * zeta);
            rig.run(0.4);
            // The stop may only push: with damping it lets go where its force would pull, before the end is reached.
            const double turn = zeta > 0 ? std::atan2(2 * zeta * std::sqrt(1 - zeta * zeta), 2 * zeta * zeta - 1)
                                         : 3.14159265358979323846;
            const double time = turn / damped, decay = std::exp(-zeta * omega * time);
            const double leaving = 4 * decay * (std::cos(turn) - zeta / std::sqrt(1 - zeta * zeta) * std::sin(turn));
            EXPECT_NEAR(rig.state().speed, leaving, 0.02 * std::max(1.0, 60 / rate) * std::abs(leaving))
                << rate << " zeta " << zeta;
        }
}

TEST(HingeMotor, StallsAtItsTorqueInEachDirection) {
    for (const double rate : kRates)
        for (const float speed : {5.0f, -5.0f}) {
            HingeDef def;
            def.limit = Range{-0.5f, 0.5f};
            def.motor = Motor{speed, 3, 1.5f};
            Rig rig = flywheel(def, 0.1f, 0);
            rig.dt = 1 / rate;
            rig.run(2);
            // Stop and motor balance: what the motor gives is what the stop takes.
            EXPECT_NEAR(rig.joints[0].axis.motorImpulse / rig.h(), speed > 0 ? 3 : -1.5, 3e-3);
            EXPECT_NEAR(rig.state().speed, 0, 1e-5);
        }
}

TEST(HingeMotor, AcceleratesAlongTheExactParabola) {
    for (const double rate : kRates) {
        HingeDef def;
        def.motor = Motor{100, 2};
        Rig rig = flywheel(def, 0.1f, 0);
        rig.dt = 1 / rate;
        rig.run(2);
        EXPECT_NEAR(angleOf(rig), 40, 40 * 0.5 * static_cast<double>(rig.h())) << rate;
    }
}

TEST(HingeSpring, FrequencyAndDampingRatioFitWhateverItMoves) {
    for (const float inertia : {0.01f, 1.0f, 30.0f}) {
        HingeDef def;
        Spring spring;
        spring.frequency = 2;
        spring.dampingRatio = 0;
        def.spring = spring;
        def.target = 0.2f;
        Rig rig = flywheel(def, inertia, 0);
        rig.run(0.25);
        EXPECT_NEAR(angleOf(rig), 0.4, 0.002) << inertia;
    }
}

TEST(HingeSpring, FeedForwardTakesTheSagAway) {
    for (const double rate : kRates) {
        HingeDef def;
        def.spring = Spring{50, 10};
        def.spring->feedForward = 9.81f * 0.5f;
        Rig rig = rod(def, 0);
        rig.dt = 1 / rate;
        rig.run(5);
        EXPECT_NEAR(angleOf(rig), 0, 1e-4) << rate;
    }
}

TEST(HingeSpring, KeepsWithinItsForce) {
    HingeDef def;
    def.spring = Spring{1000, 10};
    def.spring->maxForce = 2;
    def.target = 10;
    Rig rig = flywheel(def, 0.1f, 0);
    for (int i = 0; i < 30; ++i) {
        rig.step();
        ASSERT_LE(length(rig.state().torque), 2 * (1 + 1e-5f));
    }
    EXPECT_NEAR(rig.state().speed, 10, 0.1);
}

}  // namespace
}  // namespace ragtop::test
