#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>
#include <vector>

#include "world_support.h"

// Gears, racks, pulleys, differentials and tendons against their laws.
namespace ragtop::test {
namespace {

const Quat kAlongY = rotationBetween({1, 0, 0}, {0, 1, 0});

/// A wheel of a given moment about z.
BodyDef wheel(const DVec3& at, float mass, float inertia) {
    BodyDef body = bodyDef(Sphere{0.2f}, at);
    body.mass = MassProperties{mass, {}, {{inertia, 0, 0}, {0, inertia, 0}, {0, 0, inertia}}};
    return body;
}

HingeDef axle(BodyId carrier, BodyId turning, const Vec3& inCarrier) {
    HingeDef hinge;
    hinge.bodies.a = carrier;
    hinge.bodies.b = turning;
    hinge.bodies.frameA = {inCarrier, kAboutZ};
    hinge.bodies.frameB = {{}, kAboutZ};
    return hinge;
}

SliderDef upright(BodyId body, const Vec3& at) {
    SliderDef slider;
    slider.bodies.b = body;
    slider.bodies.frameA = {at, kAlongY};
    slider.bodies.frameB = {{}, kAlongY};
    return slider;
}

/// Hangs B from a pulley.
DistanceDef strand(BodyId body, const Vec3& pulley) {
    DistanceDef rope;
    rope.bodies.b = body;
    rope.bodies.frameA.position = pulley;
    return rope;
}

struct GearPair {
    World world;
    BodyId a{}, b{};
    JointId driver{}, driven{};
    CouplingId gears{};

    explicit GearPair(float ratio, float torque = 0, float speed = 0) : world(withoutSleep()) {
        world.setSettings([&] {
            WorldSettings settings = world.settings();
            settings.gravity = {};
            return settings;
        }());
        a = world.create(wheel({0, 0, 0}, 1, 0.1f));
        b = world.create(wheel({1, 0, 0}, 3, 0.7f));
        HingeDef first = axle({}, a, {});
        if (torque > 0) first.motor = Motor{speed, torque};
        driver = world.create(first);
        driven = world.create(axle({}, b, {1, 0, 0}));
        gears = world.create(gear(driver, driven, ratio));
    }
};

TEST(Gear, KeepsItsRatioOverTenThousandTurns) {
    const float ratio = -17.0f / 41;
    GearPair pair(ratio, 1000, 400);
    const double turns = 1e4, seconds = turns * 2 * std::numbers::pi / 400 + 0.5;
    double worst = 0;
    for (int i = 0; i < stepsIn(seconds); ++i) {
        pair.world.step(kDt);
        if (i > 60) worst = std::max(worst, std::abs(pair.world.state(pair.gears).sum));
    }
    EXPECT_GT(static_cast<double>(pair.world.state(pair.driver).coordinate), turns * 2 * std::numbers::pi);
    EXPECT_LT(worst, 2e-5);
    EXPECT_LT(std::abs(pair.world.state(pair.gears).sum), 2e-6);
}

/// A torque on the driver turns the moments I₁ + r² I₂.
TEST(Gear, AddsTheDrivenMomentByTheSquareOfTheRatio) {
    for (const float ratio : {-0.5f, 3.0f}) {
        GearPair pair(ratio, 2, 1e4f);
        run(pair.world, 1);
        const double r = static_cast<double>(ratio);
        EXPECT_NEAR(static_cast<double>(pair.world.angularVelocity(pair.a).z), 2 / (0.1 + r * r * 0.7),
                    2e-3 * 2 / (0.1 + r * r * 0.7));
        EXPECT_NEAR(static_cast<double>(pair.world.angularVelocity(pair.b).z),
                    r * static_cast<double>(pair.world.angularVelocity(pair.a).z), 1e-3);
        // What turns the driven wheel is what the gear gives.
        EXPECT_NEAR(static_cast<double>(pair.world.state(pair.gears).force), 0.7 * r * 2 / (0.1 + r * r * 0.7), 0.01);
    }
}

DVec3 momentumOf(const World& world) {
    DVec3 sum;
    for (const BodyId id : world.bodies()) {
        const MassProperties mass = world.mass(id);
        const Quat q = world.pose(id).rotation;
        const DVec3 x = world.centerOfMass(id), p = static_cast<double>(mass.mass) * DVec3(world.linearVelocity(id));
        const Vec3 spin = rotate(q, mass.inertia * inverseRotate(q, world.angularVelocity(id)));
        sum = sum + DVec3{x.y * p.z - x.z * p.y, x.z * p.x - x.x * p.z, x.x * p.y - x.y * p.x} + DVec3(spin);
    }
    return sum;
}

/// The teeth push the housing too, which turns the other way.
TEST(Gear, LeavesTheMomentumOfAFloatingGearboxAlone) {
    WorldSettings settings = withoutGravity();
    settings.sleeping = false;
    World world(settings);
    const BodyId housing = world.create(wheel({0.3, 0, 0}, 2, 0.4f));
    const BodyId a = world.create(wheel({0, 0, 0}, 1, 0.1f)), b = world.create(wheel({1, 0, 0}, 3, 0.7f));
    HingeDef first = axle(housing, a, {-0.3f, 0, 0});
    first.motor = Motor{30, 5};
    const JointId driver = world.create(first), driven = world.create(axle(housing, b, {0.7f, 0, 0}));
    const CouplingId gears = world.create(gear(driver, driven, -0.5f));
    double worst = 0;
    run(world, 3, kDt, [&] {
        const DVec3 l = momentumOf(world);
        worst = std::max(worst, std::sqrt(l.x * l.x + l.y * l.y + l.z * l.z));
    });
    EXPECT_LT(worst, 1e-3);  // of wheels that have 3 kg m²/s each
    EXPECT_NEAR(static_cast<double>(world.state(driver).speed), 30, 0.01);
    EXPECT_LT(std::abs(world.state(gears).sum), 1e-4);
    EXPECT_LT(static_cast<double>(world.state(driver).gap), 2e-4);
}

/// m g = (m + I/r²) a
TEST(Rack, TurnsItsPinionAsItFalls) {
    World world(withoutSleep());
    const BodyId pinion = world.create(wheel({}, 1, 0.02f)), rack = world.create(wheel({1, 0, 0}, 2, 0.1f));
    const JointId hinge = world.create(axle({}, pinion, {}));
    const JointId slider = world.create(upright(rack, {1, 0, 0}));
    const CouplingId teeth = world.create(rackAndPinion(hinge, slider, 0.1f));
    run(world, 1);
    const double a = 2 * 9.81 / (2 + 0.02 / 0.01);
    EXPECT_NEAR(static_cast<double>(world.state(slider).speed), -a, 2e-3 * a);
    EXPECT_NEAR(static_cast<double>(world.state(hinge).coordinate),
                static_cast<double>(world.state(slider).coordinate) / 0.1, 1e-3);
    // Joints of a quarter of the substep rate sag by a (2 h/π)².
    EXPECT_LT(std::abs(world.state(teeth).sum), 1e-4);
}

/// Atwood's machine, with one or two strands: a = (m₁ − m₂/n) g/(m₁ + m₂/n²).
TEST(Pulley, FallsAsAtwoodsMachineDoes) {
    for (const float strands : {1.0f, 2.0f}) {
        World world(withoutSleep());
        const BodyId a = world.create(wheel({0, -2, 0}, 3, 0.1f)), b = world.create(wheel({1, -3, 0}, 2, 0.1f));
        const JointId left = world.create(strand(a, {})), right = world.create(strand(b, {1, 0, 0}));
        const float rope = 2 + 3 * strands;
        const CouplingId line = world.create(pulley(left, right, rope, strands));
        run(world, 0.5);
        const double n = static_cast<double>(strands), exact = (3 - 2 / n) * 9.81 / (3 + 2 / (n * n));
        EXPECT_NEAR(static_cast<double>(world.linearVelocity(a).y), -exact * 0.5, 5e-3 * exact);
        EXPECT_NEAR(world.state(line).sum, static_cast<double>(rope), 1e-3);
        EXPECT_NEAR(static_cast<double>(world.state(line).force), -3 * (9.81 - exact), 0.02 * 3 * 9.81);
    }
}

/// A rope cannot push.
TEST(Pulley, GoesSlack) {
    World world(withoutSleep());
    const BodyId a = world.create(wheel({0, -2, 0}, 3, 0.1f)), b = world.create(wheel({1, -2, 0}, 3, 0.1f));
    const CouplingId line = world.create(pulley(world.create(strand(a, {})), world.create(strand(b, {1, 0, 0})), 4));
    world.setVelocity(a, {0, 3, 0}, {});
    run(world, 0.2);
    EXPECT_LT(world.state(line).sum, 3.9);
    EXPECT_EQ(world.state(line).force, 0);
}

/// Two limp links hang from a wall with a tendon over both hinges: 0.7 q₁ + q₂ stays in its range, whoever of them
/// gives way.
TEST(Tendon, LimitsTheSumOfTwoAngles) {
    World world(withoutSleep());
    BodyDef link = bodyDef(Box{{0.25f, 0.03f, 0.03f}}, {0.25, 0, 0});
    const BodyId first = world.create(link);
    link.pose.position.x = 0.75;
    const BodyId second = world.create(link);
    HingeDef root = axle({}, first, {}), knee = axle(first, second, {0.25f, 0, 0});
    root.bodies.frameB.position = knee.bodies.frameB.position = {-0.25f, 0, 0};
    const JointId hip = world.create(root), other = world.create(knee);
    CouplingDef tendon;
    tendon.count = 2;
    tendon.parts[0] = {hip, 0, 0.7f};
    tendon.parts[1] = {other, 0, 1};
    tendon.sum.limit = Range{-0.6f, 0.4f};
    const CouplingId sum = world.create(tendon);
    double worst = 0, reached = 0;
    const double before = world.energy();
    double most = before;
    run(world, 10, kDt, [&] {
        worst = std::max(worst, -static_cast<double>(world.state(sum).limitMargin));
        reached = std::max(reached, std::abs(static_cast<double>(world.state(hip).coordinate)));
        most = std::max(most, world.energy());
    });
    EXPECT_LT(worst * 180 / std::numbers::pi, 0.1);
    EXPECT_GT(reached, 1);
    EXPECT_LT(most - before, 1e-3 * 9.81 * 2);
}

/// left + right = 2 · cage: the stuck side makes the other turn twice as fast.
TEST(Differential, SharesItsSpeed) {
    WorldSettings settings = withoutGravity();
    settings.sleeping = false;
    World world(settings);
    JointId axles[3];
    for (int i = 0; i < 3; ++i) {
        const Vec3 at{static_cast<float>(i), 0, 0};
        HingeDef hinge = axle({}, world.create(wheel(DVec3(at), 1, 0.1f)), at);
        if (i == 0) hinge.motor = Motor{5, 100};
        if (i == 1) hinge.friction = 1000;
        axles[i] = world.create(hinge);
    }
    CouplingDef def;
    def.count = 3;
    def.parts[0] = {axles[0], 0, -2};
    def.parts[1] = {axles[1], 0, 1};
    def.parts[2] = {axles[2], 0, 1};
    def.sum.limit = Range{0, 0};
    const CouplingId gears = world.create(def);
    run(world, 2);
    EXPECT_NEAR(static_cast<double>(world.state(axles[1]).speed), 0, 1e-3);
    EXPECT_NEAR(static_cast<double>(world.state(axles[2]).speed), 10, 1e-2);
    EXPECT_LT(std::abs(world.state(gears).sum), 1e-3);
}

/// A nut on a thread of mean radius r slides down by itself if and only if tan(lead) > μ, and then with
/// (I + m p r s) α = m g r s, p = r tan(lead), s = (tan(lead) − μ)/(1 + μ tan(lead)).
TEST(Worm, LocksIfAndOnlyIfTheLeadIsBelowTheFrictionAngle) {
    const float radius = 0.05f, lead = 0.2f;
    for (const float friction : {0.19f, 0.21f}) {
        World world(withoutSleep());
        const BodyId nut = world.create(wheel({}, 2, 0.01f));
        ScrewDef screw;
        screw.bodies.b = nut;
        screw.bodies.frameA.rotation = screw.bodies.frameB.rotation = kAlongY;
        screw.pitch = lead * 2 * kPi * radius;
        screw.turn.bearing = Bearing{0, 0, friction, radius};
        const JointId joint = world.create(screw);
        // Friction knows its load from the second substep on.
        run(world, 0.5);
        const JointState before = world.state(joint);
        run(world, 4);
        const JointState after = world.state(joint);
        // Down the thread with the flank force N: N (cos + μ sin) bears the weight, N (sin − μ cos) r turns.
        const double tangent = 0.2, mu = static_cast<double>(friction), r = 0.05, p = tangent * r;
        const double share = (tangent - mu) / (1 + mu * tangent);
        const double exact = 2 * 9.81 * r * share / (0.01 + 2 * p * r * share);
        if (friction > lead)
            EXPECT_NEAR(static_cast<double>(after.coordinate - before.coordinate), 0, 1e-5);
        else
            EXPECT_NEAR(static_cast<double>(after.speed - before.speed), -exact * 4, 0.01 * exact * 4);
    }
}

TEST(Coupling, SleepsAndWakesAsOne) {
    WorldSettings settings = withoutGravity();
    World world(settings);
    const BodyId a = world.create(wheel({}, 1, 0.1f)), b = world.create(wheel({1, 0, 0}, 1, 0.1f));
    world.create(gear(world.create(axle({}, a, {})), world.create(axle({}, b, {1, 0, 0})), -1));
    EXPECT_EQ(world.countIslands(), 1);
    run(world, 3);
    EXPECT_FALSE(world.isAwake(a));
    EXPECT_FALSE(world.isAwake(b));
    world.applyAngularImpulse(a, {0, 0, 1});
    EXPECT_TRUE(world.isAwake(b));
    run(world, 0.1);
    EXPECT_NEAR(static_cast<double>(world.angularVelocity(b).z), -5, 0.01);
}

TEST(Coupling, GoesOnBitForBitAfterARestore) {
    GearPair pair(-0.5f, 2, 50);
    run(pair.world, 0.7);
    std::vector<std::byte> saved(pair.world.saveSize());
    pair.world.save(saved);
    run(pair.world, 1);
    const std::uint64_t hash = pair.world.hash();
    pair.world.restore(saved);
    run(pair.world, 1);
    EXPECT_EQ(pair.world.hash(), hash);
}

TEST(Coupling, EndsWithItsJoints) {
    GearPair pair(-0.5f, 2, 50);
    run(pair.world, 0.5);
    pair.world.destroy(pair.driver);
    EXPECT_FALSE(pair.world.isValid(pair.gears));
    EXPECT_TRUE(pair.world.couplings().empty());
    const double speed = static_cast<double>(pair.world.angularVelocity(pair.b).z);
    run(pair.world, 1);
    EXPECT_NEAR(static_cast<double>(pair.world.angularVelocity(pair.b).z), speed, 1e-4);
}

TEST(Coupling, SaysWhatIsWrong) {
    GearPair pair(1);
    const auto complaint = [&](auto&& change) -> std::string {
        CouplingDef def = gear(pair.driver, pair.driven, 2);
        change(def);
        try {
            pair.world.create(def);
        } catch (const std::invalid_argument& error) {
            return error.what();
        }
        return "none";
    };
    EXPECT_EQ(complaint([](CouplingDef& def) { def.count = 0; }), "count is 0, must be in [1, 4]");
    EXPECT_EQ(complaint([](CouplingDef& def) { def.parts[1].ratio = NAN; }),
              "parts[1].ratio is nan, must be in [-1000000, 1000000]");
    EXPECT_EQ(complaint([](CouplingDef& def) { def.parts[0].ratio = 0; }),
              "parts[0].ratio is 0, must be another number");
    EXPECT_EQ(complaint([](CouplingDef& def) { def.parts[1] = def.parts[0]; }),
              "parts[1].joint and coordinate are those of parts[0], must differ");
    EXPECT_EQ(complaint([](CouplingDef& def) { def.parts[0].joint = {}; }),
              "parts[0].joint names no joint of this world");
    EXPECT_EQ(complaint([](CouplingDef& def) { def.parts[0].coordinate = 1; }),
              "parts[0].coordinate is 1, which this kind of joint does not have");
    EXPECT_EQ(complaint([](CouplingDef& def) {
                  def.sum.limit = Range{1, -1};
              }),
              "sum.limit.lower is 1, must be at most sum.limit.upper, -1");
    EXPECT_EQ(pair.world.couplings().size(), 1u);
}

}  // namespace
}  // namespace ragtop::test
