#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "joint_rig.h"

namespace ragtop::test {
namespace {

constexpr float kRadPerDegree = kPi / 180;
const Quat kTurnedToZ = rotationBetween({1, 0, 0}, {0, 0, 1});

/// One body on a hinge along z through its centre of mass, without gravity: I θ'' = torque.
Rig flywheel(HingeDef def, float inertia) {
    Rig rig;
    rig.gravity = {};
    rig.add({{}, {}, {}, {}, 2, {inertia, inertia, inertia}, 0});
    def.bodies = frames({}, {}, kTurnedToZ, kTurnedToZ);
    rig.join(0, 1, def);
    return rig;
}

/// A 1 kg rod of 1 m that hangs on the world by its end, turned up by `angle` from hanging down.
Rig rod(float angle, const HingeDef& settings = {}) {
    Rig rig;
    RigBody body = box(1, {0.02f, 0.5f, 0.02f}, {});
    body.rotation = rotationAbout({0, 0, 1}, angle);
    body.position = DVec3(rotate(body.rotation, {0, -0.5f, 0}));
    rig.add(body);
    HingeDef def = settings;
    def.bodies = frames({}, {0, 0.5f, 0}, kTurnedToZ, kTurnedToZ);
    rig.join(0, 1, def);
    rig.begin();
    return rig;
}

TEST(Hinge, PeriodMatchesCompoundPendulum) {
    const float amplitude = 0.05f;
    Rig rig = rod(amplitude);
    const RigBody& body = rig.bodies[1];
    const double aboutPivot = body.inertia.z + 0.25;
    const double period =
        2 * std::numbers::pi * std::sqrt(aboutPivot / (9.81 * 0.5)) * (1 + amplitude * amplitude / 16);
    double first = 0, last = 0, before = rig.state().coordinate;
    int crossings = 0;
    for (int i = 1; i <= 60 * 20; ++i) {
        rig.step();
        const double now = rig.state().coordinate;
        if (before > 0 && now <= 0) {
            last = (i - 1 + before / (before - now)) * rig.dt;
            if (crossings++ == 0) first = last;
        }
        before = now;
    }
    ASSERT_GT(crossings, 8);
    EXPECT_NEAR((last - first) / (crossings - 1) / period, 1, 1e-3);
}

/// x'' + 2 ζ ω x' + ω² x = 0 from x = 1 at rest.
double oscillator(double omega, double zeta, double time) {
    const double a = zeta * omega;
    if (zeta < 1) {
        const double w = omega * std::sqrt(1 - zeta * zeta);
        return std::exp(-a * time) * (std::cos(w * time) + a / w * std::sin(w * time));
    }
    const double s = omega * std::sqrt(zeta * zeta - 1), slow = a - s, fast = a + s;
    return (fast * std::exp(-slow * time) - slow * std::exp(-fast * time)) / (fast - slow);
}

TEST(Hinge, SpringMovesAsTheDampedOscillatorAtEveryStep) {
    const double inertia = 0.4;
    for (const double rate : {30.0, 60.0, 240.0})
        for (const double zeta : {0.0, 0.1, 0.7, 3.0})
            for (const double hertz : {0.5, 2.0, 5.0}) {
                const double omega = 2 * std::numbers::pi * hertz;
                HingeDef def;
                def.spring =
                    Spring{static_cast<float>(inertia * omega * omega), static_cast<float>(2 * zeta * inertia * omega)};
                def.target = 0.3f;
                Rig rig = flywheel(def, static_cast<float>(inertia));
                rig.dt = 1 / rate;
                double worst = 0;
                for (int i = 1; i <= static_cast<int>(3 * rate); ++i) {
                    rig.step();
                    // The speed stands half a substep behind the angle, which shifts the start of the motion.
                    const double time = i * rig.dt + 0.5 * static_cast<double>(rig.h());
                    const double exact = 0.3 * (1 - oscillator(omega, zeta, time));
                    worst = std::max(worst, std::abs(static_cast<double>(rig.state().coordinate) - exact));
                }
                const double stepAngle = omega * static_cast<double>(rig.h());
                EXPECT_LT(worst, 0.3 * (0.01 + 0.5 * stepAngle * stepAngle))
                    << rate << " Hz, zeta " << zeta << ", " << hertz << " Hz";
            }
}

TEST(Hinge, StiffSpringsStayBounded) {
    for (const float stiffness : {1e3f, 1e4f, 1e5f, 1e6f})
        for (const float damping : {0.0f, 10.0f, 1e4f}) {
            HingeDef def;
            def.spring = Spring{stiffness, damping};
            def.target = 0.3f;
            Rig rig = flywheel(def, 0.01f);
            for (int i = 0; i < 600; ++i) {
                rig.step();
                ASSERT_LE(std::abs(rig.state().coordinate - 0.3f), 0.3f * 1.001f) << stiffness << " " << damping;
            }
            // Beyond a step per radian the oscillation is damped, and a damper makes the rest take d/k.
            if (damping < 0.1f * stiffness && (damping > 0 || stiffness > 1e3f)) {
                EXPECT_NEAR(rig.state().coordinate, 0.3f, 1e-3f) << stiffness << " " << damping;
            }
        }
}

TEST(Hinge, SpringHoldsTheSameStaticAngleAtEveryStep) {
    HingeDef def;
    def.spring = Spring{20, 4};
    def.target = kPi / 2;
    // k (target − θ) = m g l/2 sin θ, solved by bisection.
    double low = 0, high = std::numbers::pi / 2;
    for (int i = 0; i < 60; ++i) {
        const double middle = 0.5 * (low + high);
        (20 * (std::numbers::pi / 2 - middle) > 9.81 * 0.5 * std::sin(middle) ? low : high) = middle;
    }
    for (const double rate : {30.0, 60.0, 250.0}) {
        Rig rig = rod(1, def);
        rig.dt = 1 / rate;
        rig.run(10);
        // The soft gap shifts the force by half its width at most.
        const double shift = 9.81 * 0.5 * rig.state().gap / 20;
        EXPECT_NEAR(rig.state().coordinate, low, shift + 2e-6) << rate << " Hz";
    }
}

TEST(Slider, SpringHoldsTheSameStaticTravelAtEveryStep) {
    for (const double rate : {30.0, 60.0, 250.0}) {
        Rig rig;
        rig.dt = 1 / rate;
        rig.add(box(3, {0.1f, 0.2f, 0.1f}, {}));
        SliderDef def;
        const Quat up = rotationBetween({1, 0, 0}, {0, 1, 0});
        def.bodies = frames({}, {}, up, up);
        def.spring = Spring{1000, 60};
        rig.join(0, 1, def);
        rig.run(5);
        EXPECT_NEAR(rig.state().coordinate, -3 * 9.81 / 1000, 1e-6) << rate << " Hz";
        EXPECT_NEAR(rig.state().force.y, 3 * 9.81, 1e-3);
    }
}

TEST(Hinge, MotorReachesItsSpeedAndKeepsWithinItsTorque) {
    const float inertia = 0.4f, torque = 2, target = 10;
    HingeDef def;
    def.motor = Motor{target, torque};
    Rig rig = flywheel(def, inertia);
    const double rampTime = inertia * target / torque;  // 2 s
    for (int i = 1; i <= 180; ++i) {
        rig.step();
        const JointState state = rig.state();
        ASSERT_LE(length(state.torque), torque * (1 + 1e-6f));
        const double expected = std::min(i * rig.dt / rampTime, 1.0) * target;
        ASSERT_NEAR(state.speed, expected, 1e-4) << "step " << i;
    }
}

TEST(Slider, MotorLiftsALoadItCanCarryAndNoOther) {
    for (const float maxForce : {25.0f, 35.0f}) {  // 3 kg weigh 29.43 N
        Rig rig;
        rig.add(box(3, {0.1f, 0.2f, 0.1f}, {}));
        SliderDef def;
        const Quat up = rotationBetween({1, 0, 0}, {0, 1, 0});
        def.bodies = frames({}, {0.05f, 0, 0}, up, up);
        def.motor = Motor{0.5f, maxForce};
        rig.join(0, 1, def);
        rig.run(2);
        const double expected = maxForce < 29 ? (maxForce / 3 - 9.81) * 2 : 0.5;
        EXPECT_NEAR(rig.state().speed, expected, 1e-3);
        EXPECT_LE(rig.state().force.y, maxForce * (1 + 1e-6f));
    }
}

TEST(Hinge, FrictionStopsItAfterMomentumOverTorque) {
    const float inertia = 0.1f, torque = 0.5f, speed = 10;  // 2 s, 10 rad
    HingeDef def;
    def.friction = torque;
    Rig rig = flywheel(def, inertia);
    rig.bodies[1].w = {0, 0, speed};
    double turned = 0, before = 0, stopped = 0;
    for (int i = 1; i <= 150; ++i) {
        rig.step();
        const double now = rig.state().coordinate;
        turned += std::remainder(now - before, 2 * std::numbers::pi);
        before = now;
        if (stopped == 0 && std::abs(rig.state().speed) < 1e-5) stopped = i * rig.dt;
    }
    EXPECT_NEAR(stopped, 2, rig.dt * 1.001);
    EXPECT_NEAR(turned, 10, 1e-3);
    EXPECT_NEAR(rig.state().speed, 0, 1e-6);
}

TEST(Ball, FrictionStopsItAfterMomentumOverTorque) {
    Rig rig;
    rig.gravity = {};
    rig.add({{}, {}, {}, {3, -6, 2}, 2, {0.2f, 0.2f, 0.2f}, 0});
    BallDef def;
    def.friction = 1.4f;  // L = 0.2 · 7, so 1 s
    rig.join(0, 1, def);
    rig.run(0.5);
    EXPECT_NEAR(length(rig.bodies[1].w), 3.5, 1e-4);
    rig.run(0.5 + 2 * rig.dt);
    EXPECT_NEAR(length(rig.bodies[1].w), 0, 1e-6);
}

TEST(Ball, SpringTurnsToItsTargetWithinItsTorque) {
    Rig rig;
    rig.gravity = {};
    rig.add(box(2, {0.1f, 0.3f, 0.2f}, {0.2f, 0, 0}));
    BallDef def;
    def.bodies = frames({}, {-0.2f, 0, 0});
    def.target = rotationAbout({1, 2, 3}, 2.5f);
    def.spring = Spring{300, 12};
    def.maxSpringTorque = 40;
    rig.join(0, 1, def);
    for (int i = 0; i < 300; ++i) {
        rig.step();
        // Its force acts half the gap away.
        const JointState state = rig.state();
        ASSERT_LE(length(state.torque), 40 * (1 + 1e-5f) + 0.5f * state.gap * length(state.force));
    }
    const Quat error = conjugate(def.target) * rig.bodies[1].rotation;
    EXPECT_LT(length(rotationVector(error)), 1e-4f);
}

TEST(Hinge, LimitStopsAFallingRodWithoutOvershootOrRebound) {
    HingeDef def;
    const float stop = kPi / 2 - 1;
    def.limit = Range{stop, 3};
    Rig rig = rod(kPi / 2, def);
    double lowest = 2, highestAfter = 0;
    bool reached = false;
    for (int i = 0; i < 120; ++i) {
        rig.step();
        const double angle = rig.state().coordinate;
        lowest = std::min(lowest, angle);
        if (reached) highestAfter = std::max(highestAfter, angle);
        reached = reached || angle < stop + 1e-3;
    }
    ASSERT_TRUE(reached);
    EXPECT_GT(lowest, stop - 0.1 * kRadPerDegree);
    EXPECT_LT(highestAfter, stop + 0.05 * kRadPerDegree);
}

TEST(Ball, ConeAndTwistStopAThrownRod) {
    Rig rig;
    RigBody body = box(1, {0.5f, 0.05f, 0.02f}, {0.5, 0, 0});
    body.w = {9, 5, -7};
    rig.add(body);
    BallDef def;
    def.bodies = frames({}, {-0.5f, 0, 0});
    def.swingLimit = 0.8f;
    def.twistLimit = Range{-0.4f, 0.6f};
    rig.join(0, 1, def);
    double worst = 0;
    for (int i = 0; i < 240; ++i) {
        rig.step();
        worst = std::max(worst, -static_cast<double>(rig.state().limitMargin));
    }
    EXPECT_LT(worst, 0.5 * kRadPerDegree);
}

TEST(Distance, RodAndRopeKeepTheirLength) {
    for (const float lower : {0.0f, 1.0f}) {
        Rig rig;
        rig.add(box(2, {0.1f, 0.1f, 0.1f}, {1.1, 0, 0}));
        DistanceDef def;
        def.bodies = frames({}, {-0.1f, 0.02f, 0});
        def.limit = Range{lower, 1};
        rig.join(0, 1, def);
        double longest = 0, shortest = 2;
        for (int i = 0; i < 300; ++i) {
            rig.step();
            longest = std::max(longest, static_cast<double>(rig.state().coordinate));
            shortest = std::min(shortest, static_cast<double>(rig.state().coordinate));
        }
        EXPECT_LT(longest, 1.002);
        EXPECT_GT(shortest, lower > 0 ? 0.998 : 0.0);
    }
}

JointDef anyJoint(int kind) {
    const JointBodies bodies = frames({0.3f, 0.1f, -0.05f}, {-0.4f, 0.05f, 0.1f}, {}, rotationAbout({1, 1, 0}, 0.2f));
    if (kind == 0) {
        BallDef def{.bodies = bodies, .swingLimit = 0.5f, .twistLimit = Range{-0.3f, 0.3f}, .friction = 0.1f};
        def.spring = Spring{5, 0.2f};
        return def;
    }
    if (kind == 1) {
        HingeDef def{.bodies = bodies, .limit = Range{-0.6f, 0.9f}, .motor = Motor{3, 0.5f}};
        def.spring = Spring{4, 0.1f};
        def.friction = 0.05f;
        return def;
    }
    if (kind == 2) {
        SliderDef def{.bodies = bodies, .limit = Range{-0.2f, 0.3f}, .motor = Motor{0.5f, 2}};
        def.spring = Spring{50, 0.5f};
        def.friction = 0.3f;
        return def;
    }
    if (kind == 3) return FixedDef{bodies};
    DistanceDef def{.bodies = bodies, .limit = Range{0.05f, 0.2f}};
    def.spring = Spring{60, 1};
    def.rest = 0.1f;
    return def;
}

Rig freePair(int kind, float lengths = 1, float masses = 1, float times = 1) {
    const auto body = [&](float mass, const Vec3& half, const Vec3& at, const Vec3& v, const Vec3& w) {
        RigBody b = box(masses * mass, lengths * half, DVec3(lengths * at));
        b.v = (lengths / times) * v;
        b.w = (1 / times) * w;
        return b;
    };
    Rig rig;
    rig.dt *= times;
    rig.gravity = {};
    rig.add(body(2, {0.3f, 0.2f, 0.1f}, {}, {0.5f, 1, 0.2f}, {1, -2, 3}));
    rig.add(body(1, {0.4f, 0.1f, 0.2f}, {0.72f, 0.05f, -0.13f}, {-1, 0.5f, 0}, {-2, 4, 1}));
    JointDef def = anyJoint(kind);
    const float torque = masses * lengths * lengths / (times * times);
    // Springs and motors of balls and hinges are per radian, the others per metre.
    const float force = kind < 2 ? torque : torque / lengths;
    const float length = kind < 2 ? 1 : lengths;
    std::visit(
        [&](auto& d) {
            d.bodies.frameA.position *= lengths;
            d.bodies.frameB.position *= lengths;
            if constexpr (requires { d.spring; })
                d.spring = {d.spring->stiffness * force / length, d.spring->damping * force * times / length};
            if constexpr (requires { d.friction; }) d.friction *= force;
            if constexpr (requires { d.limit; }) d.limit = {d.limit->lower * length, d.limit->upper * length};
            if constexpr (requires { d.motor; })
                d.motor = {d.motor->targetSpeed * length / times, d.motor->maxForce * force};
            if constexpr (requires { d.rest; }) d.rest *= length;
        },
        def);
    rig.join(1, 2, def);
    return rig;
}

TEST(Joint, FreePairKeepsItsMomentum) {
    for (int kind = 0; kind < 5; ++kind) {
        Rig rig = freePair(kind);
        const DVec3 before = rig.angularMomentum();
        double scaleOfL = 0;
        for (const RigBody& b : rig.bodies) scaleOfL += b.mass * length(b.v) * 1.0 + length(scale(b.inertia, b.w));
        rig.run(1);
        const double drift = length(toVec3(rig.angularMomentum() - before));
        EXPECT_LT(drift, 1e-6 * scaleOfL) << "kind " << kind;
    }
}

TEST(Joint, MotionScalesBitForBit) {
    for (int kind = 0; kind < 5; ++kind) {
        Rig small = freePair(kind), large = freePair(kind, 4, 64, 2);
        for (int i = 0; i < 120; ++i) {
            small.step();
            large.step();
            for (std::size_t b = 1; b < 3; ++b) {
                ASSERT_EQ(4.0 * small.bodies[b].position, large.bodies[b].position) << kind << " step " << i;
                ASSERT_EQ(small.bodies[b].rotation, large.bodies[b].rotation) << kind << " step " << i;
                ASSERT_EQ(2.0f * small.bodies[b].v, large.bodies[b].v) << kind << " step " << i;
                ASSERT_EQ(small.bodies[b].w, 2.0f * large.bodies[b].w) << kind << " step " << i;
            }
            ASSERT_EQ(64.0f * small.state().force, large.state().force);
            ASSERT_EQ(256.0f * small.state().torque, large.state().torque);
        }
    }
}

TEST(Fixed, CantileverCarriesItsWeight) {
    Rig rig;
    std::uint32_t last = 0;
    for (int i = 0; i < 3; ++i) {
        const std::uint32_t next = rig.add(box(1, {0.1f, 0.05f, 0.05f}, {0.1 + 0.2 * i, 0, 0}));
        rig.join(last, next, FixedDef{frames(i == 0 ? Vec3{} : Vec3{0.1f, 0, 0}, {-0.1f, 0, 0})});
        last = next;
    }
    rig.run(5);
    const JointState wall = rig.state(0);
    EXPECT_NEAR(wall.force.y, 3 * 9.81, 1e-3);
    // The moment about the wall is that of the weights where they are now.
    double moment = 0;
    for (std::size_t b = 1; b < 4; ++b) moment += 9.81 * rig.bodies[b].position.x;
    EXPECT_NEAR(wall.torque.z, moment, 9.81 * 3 * wall.gap + 1e-3);
    EXPECT_GT(rig.bodies[3].position.y, -0.6 * 0.03);
}

}  // namespace
}  // namespace ragtop::test
