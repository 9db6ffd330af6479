#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <memory_resource>
#include <random>
#include <vector>

#include "joint_rig.h"
#include "model/joint_sims.h"

namespace ragtop::test {
namespace {

const Quat kFromXToZ = rotationBetween({1, 0, 0}, {0, 0, 1});

/// Links of 1 kg and 0.2 m on the world, the last one of another mass.
Rig chain(int count, float lastMass, bool level) {
    Rig rig;
    const float half = 0.1f;
    const Vec3 along = level ? Vec3{1, 0, 0} : Vec3{0, -1, 0};
    std::uint32_t last = 0;
    for (int i = 0; i < count; ++i) {
        const Vec3 extents = level ? Vec3{half, 0.02f, 0.02f} : Vec3{0.02f, half, 0.02f};
        const std::uint32_t next =
            rig.add(box(i == count - 1 ? lastMass : 1, extents, DVec3(half * static_cast<float>(2 * i + 1) * along)));
        rig.join(last, next, BallDef{.bodies = frames(i == 0 ? Vec3{} : half * along, -half * along)});
        last = next;
    }
    return rig;
}

float largestGap(const Rig& rig) {
    float gap = 0;
    for (std::size_t j = 0; j < rig.joints.size(); ++j) gap = std::max(gap, rig.state(j).gap);
    return gap;
}

TEST(Ball, HangingChainStaysTogether) {
    Rig rig = chain(10, 1, false);
    float largest = 0;
    for (int i = 0; i < 600; ++i) {
        rig.step();
        largest = std::max(largest, largestGap(rig));
    }
    EXPECT_LT(largest, 0.01f * 0.2f);
    EXPECT_NEAR(rig.state(0).force.y, 10 * 9.81, 0.01);
    EXPECT_NEAR(rig.state(9).force.y, 9.81, 0.01);
}

TEST(Ball, HeavySwingingLoadStretchesAChainAndDoesNotTearIt) {
    for (const float mass : {1.0f, 100.0f, 1000.0f, 10000.0f}) {
        for (const int count : {10, 40}) {
            Rig rig = chain(count, mass, true);
            // A soft joint sags by m g/(m_eff ω²), with m_eff of two links of 1 kg; a swing loads it 3 m g, and the
            // drop doubles that.
            const double omega = 2 * kPi * rig.jointFrequency / rig.h();
            const double sag = (mass + count) * 9.81 / (0.5 * omega * omega);
            double largest = 0;
            for (int i = 0; i < 300; ++i) {
                rig.step();
                largest = std::max(largest, static_cast<double>(largestGap(rig)));
            }
            EXPECT_LT(largest, 6 * sag + 0.3 * 0.2) << mass << " kg on " << count << " links";
        }
    }
}

/// Two bodies at the beginning of a step, and a joint between them.
struct Bench {
    BodyState states[3];
    BodyInertia inertia[3];
    AxesJointSim joint;
    JointContext context{1 / 240.0f, 240, makeSoftness(60, 2, 1 / 240.0f)};
    JointBodiesAtStep bodies;

    Bench() {
        for (int i = 1; i < 3; ++i) {
            states[i].invMass = 1;
            inertia[i] = {20, 0, 0, 30, 0, 25, {}};
        }
        joint.stateA = 1;
        joint.stateB = 2;
    }
    void substep() {
        prepareJoint(joint, bodies, states, inertia, context);
        warmStartJoint(joint, states, inertia, context);
        solveJoint(joint, states, inertia, context, true);
        solveJoint(joint, states, inertia, context, false);
    }
    bool finite() const {
        const JointState state = jointState(joint, bodies, states, context.inverseH);
        return isFinite(states[1].v) && isFinite(states[1].w) && isFinite(states[2].v) && isFinite(states[2].w) &&
               isFinite(state.force) && isFinite(state.torque) && std::isfinite(state.coordinate) &&
               std::isfinite(state.speed) && std::isfinite(state.swing) && std::isfinite(state.gap) &&
               !std::isnan(state.limitMargin);
    }
};

TEST(Ball, TwistAndSwingThroughHalfTurnsGiveBoundedImpulses) {
    for (int swing = 0; swing <= 64; ++swing) {
        for (int twist = -70; twist <= 70; ++twist) {
            Bench bench;
            BallDef def;
            def.swingLimit = 3;
            def.twistLimit = Range{-2.9f, 2.9f};
            def.spring = Spring{10, 1};
            def.friction = 1;
            compileJoint(def, {}, {}, bench.joint);
            const float swingAngle = kPi * static_cast<float>(swing) / 64;
            const float twistAngle = kPi * static_cast<float>(twist) / 64;
            bench.bodies.rotationB = rotationAbout({0, 0.6f, 0.8f}, swingAngle) * rotationAbout({1, 0, 0}, twistAngle);
            bench.states[2].w = {3, -2, 1};
            bench.substep();
            ASSERT_TRUE(bench.finite()) << swing << " " << twist;
            // Relaxing leaves no recovery speed behind; the spring adds at most h k π/I.
            const float limit = 2 * (3.8f + 10 * kPi * 30 / 240);
            ASSERT_LT(length(bench.states[2].w), limit) << swing << " " << twist;
            const JointState state = jointState(bench.joint, bench.bodies, bench.states, bench.context.inverseH);
            ASSERT_NEAR(state.swing, swingAngle, 1e-3);
            // At a half turn of swing there is no twist.
            if (swing < 60) {
                ASSERT_NEAR(std::remainder(state.coordinate - twistAngle, 2 * kPi), 0, 1e-4);
            }
        }
    }
}

class JointDice {
public:
    float unit() { return std::uniform_real_distribution<float>(-1, 1)(engine_); }
    bool coin() { return engine_() & 1u; }
    /// Of all magnitudes between 10^−range and 10^range.
    float magnitude(float range) { return std::pow(10.0f, range * unit()); }
    Vec3 vector(float size) { return {size * unit(), size * unit(), size * unit()}; }
    Quat rotation() { return normalized(Quat{unit(), unit(), unit(), unit()}); }
    int below(int n) { return static_cast<int>(engine_() % static_cast<unsigned>(n)); }
    Range range(float size) {
        const float a = size * unit(), b = size * unit();
        return {std::min(a, b), std::max(a, b)};
    }

private:
    std::mt19937 engine_{7};
};

JointDef randomBall(JointDice& random, const JointBodies& bodies, const std::optional<Range>& twist, const Stop& stop,
                    float friction, const std::optional<Bearing>& bearing, const std::optional<Spring>& spring) {
    BallDef ball;
    ball.bodies = bodies;
    ball.twistLimit = twist;
    ball.stop = stop;
    ball.friction = friction;
    ball.bearing = bearing;
    ball.spring = spring;
    ball.target = random.rotation();
    ball.maxSpringTorque = random.magnitude(5);
    switch (random.below(5)) {
        case 0:
            ball.swingLimit = 1.6f + 1.5f * random.unit();
            break;
        case 1:
            ball.swingEllipse = SwingEllipse{1.6f + 1.5f * random.unit(), 1.6f + 1.5f * random.unit()};
            break;
        case 2:
            ball.swingPyramid = SwingPyramid{random.range(3), random.range(3)};
            break;
        case 3: {
            ReachPolygon reach;
            reach.count = 3 + random.below(10);
            for (ReachCorner& corner : reach.corners) corner = {random.vector(1), random.range(kPi)};
            ball.reach = reach;
            ball.twistLimit = {};
            break;
        }
        default:
            break;
    }
    return ball;
}

JointDef randomJoint(JointDice& random) {
    const auto spring = [&]() -> std::optional<Spring> {
        if (random.coin()) return std::nullopt;
        return Spring{random.coin() ? random.magnitude(6) : 0.0f, random.coin() ? random.magnitude(5) : 0.0f};
    };
    const auto motor = [&]() -> std::optional<Motor> {
        if (random.coin()) return std::nullopt;
        return Motor{10 * random.unit(), random.magnitude(4)};
    };
    const auto limit = [&](float size) { return random.coin() ? std::optional(random.range(size)) : std::nullopt; };
    const float size = random.coin() ? random.magnitude(2) : 0;
    const JointBodies bodies = frames(random.vector(size), random.vector(size), random.rotation(), random.rotation());
    const float friction = random.coin() ? random.magnitude(4) : 0;
    const auto stop = [&]() -> Stop {
        if (random.coin()) return {};
        if (random.coin()) return {std::abs(random.unit()), 0, 0};
        return {0, random.magnitude(6), random.coin() ? random.magnitude(5) : 0.0f};
    };
    const auto bearing = [&]() -> std::optional<Bearing> {
        if (random.coin()) return std::nullopt;
        return Bearing{random.magnitude(3), random.magnitude(4), std::abs(random.unit()), random.magnitude(2)};
    };
    const auto fill = [&](auto& def, float range, bool drives) {
        def.bodies = bodies;
        def.limit = limit(range);
        def.stop = stop();
        def.spring = spring();
        if constexpr (requires { def.motor; }) {
            if (drives) def.motor = motor();
            def.target = range * random.unit();
            def.friction = friction;
            def.bearing = bearing();
        }
        return def;
    };
    HingeDef hinge;
    SliderDef slider;
    DistanceDef distance;
    switch (random.below(5)) {
        case 0:
            return randomBall(random, bodies, limit(kPi), stop(), friction, bearing(), spring());
        case 1:
            return fill(hinge, 3 * kPi, true);
        case 2:
            return fill(slider, size, true);
        case 3:
            return FixedDef{bodies};
        default: {
            const float a = std::abs(size * random.unit());
            fill(distance, size, false);
            distance.limit = Range{a, random.coin() ? a : a + size};
            distance.rest = a;
            return distance;
        }
    }
}

TEST(Joint, RandomStatesNeverGiveNaN) {
    JointDice random;
    for (int trial = 0; trial < 100000; ++trial) {
        Bench bench;
        compileJoint(randomJoint(random), random.vector(0.1f), random.vector(0.1f), bench.joint);
        for (int i = 1; i < 3; ++i) {
            const float mass = random.magnitude(4);
            BodyState& state = bench.states[i];
            state.invMass = random.below(8) == 0 ? 0 : 1 / mass;
            state.locks = random.below(4) == 0 ? static_cast<std::uint32_t>(random.below(8)) : 0u;
            state.v = random.vector(random.magnitude(3));
            state.w = random.vector(random.magnitude(3));
            state.dp = random.vector(random.magnitude(2));
            state.dq = random.below(3) == 0 ? Quat{} : random.rotation();
            const Vec3 axis = normalized(random.vector(1));
            const float i1 = random.magnitude(4) / mass, i2 = random.below(4) == 0 ? 0 : random.magnitude(3) * i1;
            bench.inertia[i] = {i1 + i2 * axis.x * axis.x,
                                i2 * axis.x * axis.y,
                                i2 * axis.x * axis.z,
                                i1 + i2 * axis.y * axis.y,
                                i2 * axis.y * axis.z,
                                i1 + i2 * axis.z * axis.z,
                                {}};
            if (random.below(8) == 0) bench.inertia[i] = {};
        }
        bench.bodies = {random.vector(random.magnitude(2)), random.rotation(), random.rotation()};
        if (random.below(4) == 0) bench.bodies = {};
        for (int i = 0; i < 3; ++i) bench.substep();
        ASSERT_TRUE(bench.finite()) << "trial " << trial << " kind " << static_cast<int>(bench.joint.kind);
    }
}

TEST(Joint, BodiesWithoutMassAreNeverWritten) {
    JointDice random;
    for (int trial = 0; trial < 1000; ++trial) {
        Bench bench;
        compileJoint(randomJoint(random), {}, {}, bench.joint);
        for (int i = 1; i < 3; ++i) {
            bench.states[i].v = random.vector(3);
            bench.states[i].w = random.vector(3);
        }
        bench.states[1].invMass = 0;
        bench.states[1].v.z = -0.0f;
        bench.joint.stateB = trial & 1 ? 2 : 0;
        const Bench before = bench;
        for (int i = 0; i < 3; ++i) bench.substep();
        EXPECT_EQ(0, std::memcmp(&before.states[0], &bench.states[0], sizeof(BodyState)));
        EXPECT_EQ(0, std::memcmp(&before.states[1], &bench.states[1], sizeof(BodyState)));
        EXPECT_TRUE(bench.finite());
    }
}

TEST(Distance, CoincidingAnchorsPullNowhereAndStayFinite) {
    Bench bench;
    DistanceDef def;
    def.limit = Range{0.5f, 1};
    def.spring = Spring{100, 1};
    def.rest = 0.5f;
    compileJoint(def, {}, {}, bench.joint);
    bench.substep();
    EXPECT_TRUE(bench.finite());
    // It is pushed apart along one axis, equally.
    EXPECT_EQ(bench.states[1].v, -bench.states[2].v);
}

TEST(Joint, LockedTranslationStays) {
    Bench bench;
    BallDef def;
    compileJoint(def, {}, {}, bench.joint);
    bench.bodies.centerOffset = {0.1f, 0.2f, 0.3f};
    bench.states[1].locks = 7;
    bench.states[2].locks = 4;
    bench.substep();
    bench.substep();
    EXPECT_EQ(bench.states[1].v, Vec3{});
    EXPECT_EQ(bench.states[2].v.z, 0);
    EXPECT_TRUE(bench.finite());
}

TEST(Hinge, LimitsNearAHalfTurnDoNotFlip) {
    for (const float speed : {20.0f, -20.0f}) {
        Rig rig;
        rig.gravity = {};
        rig.add({{}, {}, {}, {0, 0, speed}, 1, {0.1f, 0.1f, 0.1f}, 0});
        HingeDef def;
        def.bodies = frames({}, {}, kFromXToZ, kFromXToZ);
        def.limit = Range{-3.1f, 3.1f};
        rig.join(0, 1, def);
        for (int i = 0; i < 60; ++i) {
            rig.step();
            ASSERT_LE(std::abs(rig.state().coordinate), 3.1f + 1e-3f);
        }
        EXPECT_NEAR(rig.state().coordinate, speed > 0 ? 3.1f : -3.1f, 1e-3f);
        // Pushed beyond, even past a half turn, it comes back the way it went.
        rig.bodies[1].rotation = rotationAbout({0, 0, 1}, speed > 0 ? -3.12f : 3.12f);
        rig.run(1);
        EXPECT_NEAR(rig.state().coordinate, speed > 0 ? 3.1f : -3.1f, 1e-3f);
    }
}

TEST(Hinge, AnglesCountTurns) {
    for (const float end : {kPi, 7.5f, -30.0f}) {
        Rig rig;
        rig.gravity = {};
        rig.add({{}, {}, {}, {0, 0, end > 0 ? 5.0f : -5.0f}, 1, {0.1f, 0.1f, 0.1f}, 0});
        HingeDef def;
        def.bodies = frames({}, {}, kFromXToZ, kFromXToZ);
        def.limit = end > 0 ? Range{-1, end} : Range{end, 1};
        rig.join(0, 1, def);
        rig.run(0.95 * static_cast<double>(std::abs(end)) / 5);
        EXPECT_NEAR(rig.state().speed, end > 0 ? 5 : -5, 1e-3);
        rig.run(8);
        EXPECT_NEAR(rig.state().coordinate, end, 1e-3);
        EXPECT_NEAR(rig.state().speed, 0, 1e-3);
    }
}

TEST(Hinge, EqualLimitsWeld) {
    Rig rig;
    rig.add(box(1, {0.1f, 0.1f, 0.1f}, {0.1, 0, 0}));
    HingeDef def;
    def.bodies = frames({}, {-0.1f, 0, 0}, kFromXToZ, kFromXToZ);
    def.limit = Range{0, 0};
    rig.join(0, 1, def);
    rig.run(2);
    EXPECT_NEAR(rig.state().torque.z, 9.81 * 0.1, 1e-3);
    EXPECT_NEAR(rig.state().coordinate, 0, 1e-3);
}

TEST(Joint, ReportsTheForceThatAExertsOnB) {
    Rig rig;
    rig.add(box(3, {0.1f, 0.1f, 0.1f}, {0, -0.4, 0}));
    rig.join(0, 1, BallDef{.bodies = frames({}, {0, 0.4f, 0})});
    rig.run(3);
    EXPECT_NEAR(rig.state().force.y, 3 * 9.81, 1e-3);
    EXPECT_NEAR(length(rig.state().torque), 0, 1e-5);
}

/// Two free bodies whose centres are far off the axis, held by a stiff spring with hardly any damping: the reaction of
/// the rigid rows is many times the torque. What oscillates loses energy in every period, and the start has the most.
TEST(Joint, StiffSpringBetweenBodiesOffTheirAxisGainsNothing) {
    std::mt19937 random(5);
    std::uniform_real_distribution<float> spread(-0.5f, 0.5f);
    const auto vector = [&](float size) {
        const float x = spread(random), y = spread(random), z = spread(random);
        return size * Vec3{x, y, z};
    };
    const auto turn = [&] {
        const Vec3 v = vector(1);
        return normalized(Quat{v.x, v.y, v.z, spread(random)});
    };
    for (const float frequency : {30.0f, 40.0f, 60.0f}) {
        const Spring spring{.frequency = frequency, .dampingRatio = 0.1f};
        for (int i = 0; i < 400; ++i) {
            Rig rig;
            rig.gravity = {};
            const Vec3 armA = vector(1), armB = vector(1);
            RigBody a = box(1, {0.2f, 0.25f, 0.1f}, {}), b = box(4, {0.2f, 0.1f, 0.15f}, {});
            a.rotation = turn();
            b.rotation = turn();
            b.position = DVec3(rotate(a.rotation, armA) - rotate(b.rotation, armB));
            a.w = vector(1);
            const Quat frameA = turn();
            const JointBodies held = frames(armA, armB, frameA, conjugate(b.rotation) * (a.rotation * frameA));
            const std::uint32_t first = rig.add(a), second = rig.add(b);
            HingeDef hinge{.bodies = held, .spring = spring};
            UniversalDef universal{.bodies = held};
            universal.first.spring = universal.second.spring = spring;
            rig.join(first, second, i % 2 == 0 ? JointDef(hinge) : JointDef(universal));
            const double start = rig.energy();
            rig.run(2);
            EXPECT_LE(rig.energy(), start) << frequency << " Hz, pair " << i;
        }
    }
}

TEST(Joint, NewSettingsKeepTheImpulsesOfTheSameTypeOnly) {
    Rig rig;
    rig.add(box(3, {0.1f, 0.1f, 0.1f}, {0.4, 0, 0}));
    HingeDef hinge;
    hinge.bodies = frames({}, {-0.4f, 0, 0}, kFromXToZ, kFromXToZ);
    hinge.spring = Spring{100, 10};
    rig.join(0, 1, hinge);
    rig.run(3);
    const JointState before = rig.state();
    hinge.motor = Motor{1, 2};
    compileJoint(hinge, {}, {}, rig.joints[0]);
    EXPECT_EQ(before.force, rig.state().force);
    EXPECT_EQ(before.torque, rig.state().torque);
    rescaleJoint(rig.joints[0], 0.5f);
    EXPECT_EQ(0.5f * before.force, rig.state().force);
    hinge.spring.reset();
    compileJoint(hinge, {}, {}, rig.joints[0]);
    EXPECT_NEAR(rig.state().torque.z, 0, 0.5 * 3 * 9.81 * rig.state().gap + 1e-5);
    compileJoint(BallDef{.bodies = hinge.bodies}, {}, {}, rig.joints[0]);
    EXPECT_EQ(rig.state().force, Vec3{});
    EXPECT_EQ(rig.joints[0].stateB, 1u);
}

/// A step that went beyond all numbers is undone; the next begins without its impulses.
TEST(JointRobustness, TimesNothingNothingIsLeftOfImpulsesBeyondAllNumbers) {
    for (const float beyond : {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
        AxesJointSim joint{};
        joint.kind = JointKind::cylindrical;
        joint.block.impulseFirst = joint.block.impulseSecond = joint.lead.linear = {beyond, 0, beyond};
        joint.ball.springImpulse = {0, beyond, 0};
        joint.ball.twistLower.impulse = joint.axis.dry.bound = joint.axes.impulse[0] = beyond;
        joint.axis.impulse(AxisSlot::lower) = beyond;
        rescaleJoint(joint, 0);
        EXPECT_EQ(joint.block.impulseFirst, Vec3{});
        EXPECT_EQ(joint.block.impulseSecond, Vec3{});
        EXPECT_EQ(joint.lead.linear, Vec3{});
        EXPECT_EQ(joint.ball.springImpulse, Vec3{});
        EXPECT_EQ(joint.ball.twistLower.impulse, 0);
        EXPECT_EQ(joint.axis.impulse(AxisSlot::lower), 0);
        EXPECT_EQ(joint.axis.dry.bound, 0);
        EXPECT_EQ(joint.axes.impulse[0], 0);
    }
}

/// Joints of all kinds have one numbering, and those with axes memory of their own.
TEST(JointSims, StayWhereTheyAreWhileOthersComeAndGo) {
    JointSims sims(std::pmr::get_default_resource());
    constexpr std::uint32_t kFew = 100, kMany = 400;  // pages of both kinds of memory have fewer
    const auto kind = [](std::uint32_t i) { return i % 3 == 0 ? JointKind::sixDof : JointKind::ball; };
    const auto add = [&](std::uint32_t i) {
        sims.acquire(i, kind(i));
        sims[i].kind = kind(i);
        sims[i].stateA = i;
        if (hasAxes(kind(i))) withAxes(sims[i]).axes.freeRows = i;
    };
    for (std::uint32_t i = 0; i < kFew; ++i) add(i);
    std::vector<const JointSim*> places;
    for (std::uint32_t i = 0; i < kFew; ++i) places.push_back(&sims[i]);
    for (std::uint32_t i = kFew; i < kMany; ++i) add(i);
    for (std::uint32_t i = 0; i < kMany; ++i) {
        EXPECT_EQ(sims[i].stateA, i);
        EXPECT_TRUE(i >= kFew || &sims[i] == places[i]);
        EXPECT_TRUE(!hasAxes(kind(i)) || withAxes(sims[i]).axes.freeRows == i);
    }
    // What has gone leaves its place to the next of its size, as new.
    sims.release(3), sims.release(4);
    sims.acquire(4, JointKind::cylindrical);
    EXPECT_EQ(&sims[4], places[3]);
    EXPECT_EQ(withAxes(sims[4]).axes.freeRows, 0u);
    sims.acquire(3, JointKind::hinge);
    EXPECT_EQ(&sims[3], places[4]);
    EXPECT_EQ(sims[3].stateA, 0u);
}

}  // namespace
}  // namespace ragtop::test
