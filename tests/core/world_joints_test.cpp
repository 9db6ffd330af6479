#include "world_support.h"

namespace ragtop {
namespace {

using namespace test;

/// Times at which `value` goes through zero upwards, interpolated between steps.
class Crossings {
public:
    void add(double t, double value) {
        if (any_ && before_ < 0 && value >= 0) times_.push_back(t - kDt * value / (value - before_));
        before_ = value;
        any_ = true;
    }
    double period() const { return (times_.back() - times_.front()) / static_cast<double>(times_.size() - 1); }
    std::size_t count() const { return times_.size(); }

private:
    double before_ = 0;
    bool any_ = false;
    std::vector<double> times_;
};

Frame frameAt(const Vec3& position, const Quat& rotation = {}) { return {position, rotation}; }

/// … and along −y, so that a slider's travel grows downwards.
const Quat kDown = rotationBetween({1, 0, 0}, {0, -1, 0});

// T = 2π √(I / (m g d)) (1 + θ²/16), I about the pivot. The next term is 11 θ⁴/3072 = 6e-6, the substep's error
// (ω h)² / 24 = 1e-5; the damping of soft joints takes up to a fifth of the amplitude in ten periods, θ²/16 · 0.2 =
// 5e-4.
TEST(WorldJoints, ACompoundPendulumSwingsWithItsPeriod) {
    for (const bool hinge : {true, false}) {
        World world(withoutSleep());
        const float d = 0.7f, start = 0.2f;
        BodyDef def = bodyDef(Box{{0.1f, 0.5f, 0.2f}}, {d * std::sin(start), -d * std::cos(start), 0});
        def.pose.rotation = rotationAbout({0, 0, 1}, start);
        const BodyId body = world.create(def);
        const JointBodies bodies{.b = body, .frameA = frameAt({}, kAboutZ), .frameB = frameAt({0, d, 0}, kAboutZ)};
        const JointId joint =
            hinge ? world.create(HingeDef{.bodies = bodies}) : world.create(BallDef{.bodies = bodies});
        Crossings crossings;
        float gap = 0;
        run(world, 20, kDt, [&] {
            crossings.add(world.time(), world.pose(body).position.x);
            gap = std::max(gap, world.state(joint).gap);
        });
        const MassProperties mass = world.mass(body);
        const double inertia = mass.inertia.cz.z + mass.mass * d * d;
        const double period = 2 * kPi * std::sqrt(inertia / (mass.mass * 9.81 * d));
        ASSERT_GT(crossings.count(), 8u);
        EXPECT_NEAR(crossings.period(), period * (1 + start * start / 16), 6e-4 * period) << hinge;
        EXPECT_LT(gap, 1e-3f);
    }
}

TEST(WorldJoints, APendulumKeepsItsEnergy) {
    World world(withoutSleep());
    const BodyId body = world.create(bodyDef(Sphere{0.1f}, {1, 0, 0}));
    world.create(BallDef{.bodies = {.b = body, .frameB = frameAt({-1, 0, 0})}});
    const double weight = world.mass(body).mass * 9.81;
    const double start = world.energy();
    double least = 0, most = 0;
    run(world, 10, kDt, [&] {
        least = std::min(least, (world.energy() - start) / weight);
        most = std::max(most, (world.energy() - start) / weight);
    });
    // Semi-implicit steps see the velocity half a substep late: height errs by v h / 2 at most, without growing.
    EXPECT_LT(most, 0.5 * kDt / 4 * std::sqrt(2 * 9.81));
    EXPECT_GT(least, -0.1);
}

TEST(WorldJoints, AMotorReachesItsSpeedAndStalls) {
    World world(withoutGravity());
    const BodyId wheel = world.create(bodyDef(Box{{0.5f, 0.5f, 0.1f}}, {}));
    HingeDef def{.bodies = {.b = wheel, .frameA = frameAt({}, kAboutZ), .frameB = frameAt({}, kAboutZ)},
                 .motor = Motor{5, 20}};
    const JointId joint = world.create(def);
    // α = τ / I until the target, then it keeps the speed.
    const float inertia = world.mass(wheel).inertia.cz.z;
    const double rampTime = 5 * static_cast<double>(inertia) / 20;
    ASSERT_GT(rampTime, 1);
    run(world, 1);
    EXPECT_NEAR(world.angularVelocity(wheel).z, 20 / inertia, 1e-3 * 20 / inertia);
    run(world, rampTime + 1);
    EXPECT_NEAR(world.angularVelocity(wheel).z, 5, 1e-3);
    EXPECT_NEAR(world.state(joint).speed, 5, 1e-3);
    // A load above the motor's torque turns it back with τ_load − τ_motor.
    const float before = world.angularVelocity(wheel).z;
    for (int i = 0; i < 60; ++i) {
        world.applyTorque(wheel, {0, 0, -30});
        world.step(kDt);
    }
    EXPECT_NEAR(world.angularVelocity(wheel).z, before - 10 / inertia, 0.02 * 10 / inertia);
    // One below it does not turn it.
    def.motor = Motor{0, 50};
    world.setDef(joint, def);
    run(world, 3);
    for (int i = 0; i < 60; ++i) {
        world.applyTorque(wheel, {0, 0, -30});
        world.step(kDt);
    }
    EXPECT_NEAR(world.angularVelocity(wheel).z, 0, 1e-3);
}

TEST(WorldJoints, AHingeStopsAtItsLimits) {
    World world(withoutSleep());
    const BodyId door = world.create(bodyDef(Box{{0.5f, 0.1f, 0.1f}}, {0.5, 0, 0}));
    const JointId joint = world.create(
        HingeDef{.bodies = {.b = door, .frameA = frameAt({}, kAboutZ), .frameB = frameAt({-0.5f, 0, 0}, kAboutZ)},
                 .limit = Range{-0.5f, 0.5f}});
    float least = 0;
    run(world, 3, kDt, [&] { least = std::min(least, world.state(joint).coordinate); });
    EXPECT_NEAR(world.state(joint).coordinate, -0.5, 2e-3);
    EXPECT_GT(least, -0.51f);
    EXPECT_NEAR(world.state(joint).limitMargin, 0, 2e-3);
}

// ω² = k/m − (c/2m)², and the equilibrium at m g / k. The spring is integrated implicitly: its own damping is h ω / 2.
TEST(WorldJoints, ASpringOscillatesWithItsFrequency) {
    for (const bool slider : {true, false}) {
        World world(withoutSleep());
        const BodyId body = world.create(bodyDef(Sphere{0.3f}, {0, -2, 0}));
        const float m = world.mass(body).mass;
        const float omega = 6;
        const Spring spring{m * omega * omega, 0};
        const JointBodies bodies{.b = body, .frameA = frameAt({}, kDown), .frameB = frameAt({}, kDown)};
        if (slider)
            world.create(SliderDef{.bodies = bodies, .spring = spring, .target = 2});
        else
            world.create(DistanceDef{.bodies = bodies, .spring = spring, .rest = 2});
        const double rest = -2 - 9.81 / (omega * omega);
        Crossings crossings;
        run(world, 6, kDt, [&] { crossings.add(world.time(), height(world, body) - rest); });
        ASSERT_GT(crossings.count(), 4u);
        // Phase error of implicit Euler: (ω h)² / 3 = 2e-4 … of the period.
        EXPECT_NEAR(crossings.period(), 2 * kPi / omega, 0.005 * 2 * kPi / omega) << slider;
        EXPECT_NEAR(world.pose(body).position.x, 0, 1e-4);
    }
}

TEST(WorldJoints, ADampedSpringComesToRestAtItsSag) {
    World world(withoutSleep());
    const BodyId body = world.create(bodyDef(Sphere{0.3f}, {0, -2, 0}));
    const float m = world.mass(body).mass;
    world.create(SliderDef{.bodies = {.b = body, .frameA = frameAt({}, kDown), .frameB = frameAt({}, kDown)},
                           .spring = Spring{m * 100, m * 20},
                           .target = 2});
    run(world, 5);
    EXPECT_NEAR(height(world, body), -2 - 9.81 / 100, 1e-4);
}

TEST(WorldJoints, ASliderMotorAndFrictionAreForces) {
    World world(withoutGravity());
    const BodyId body = world.create(bodyDef(Box{{0.5f, 0.5f, 0.5f}}, {}));
    const float m = world.mass(body).mass;
    SliderDef def{.bodies = {.b = body}, .motor = Motor{100, 2 * m}};
    const JointId joint = world.create(def);
    run(world, 1);
    EXPECT_NEAR(world.linearVelocity(body).x, 2, 1e-3);
    EXPECT_NEAR(world.pose(body).position.x, 1, 5e-3);
    def.motor.reset();
    def.friction = m;
    world.setDef(joint, def);
    // v²/(2a) further, then it stays.
    run(world, 3);
    EXPECT_NEAR(world.pose(body).position.x, 3, 0.015);
    EXPECT_NEAR(world.linearVelocity(body).x, 0, 1e-5);
}

TEST(WorldJoints, ARopeHangsAtItsLengthAndIsSlackWithin) {
    World world(withoutSleep());
    const BodyId body = world.create(bodyDef(Sphere{0.2f}, {1, 0, 0}));
    const JointId joint = world.create(DistanceDef{.bodies = {.b = body}, .limit = Range{0, 2}});
    // Slack: free fall until the length is 2, after √(2 √3 / g) s. Jointed bodies move by semi-implicit Euler, whose
    // fall is g t (t + h) / 2.
    run(world, 0.5);
    EXPECT_NEAR(height(world, body), -0.5 * 9.81 * 0.5 * (0.5 + kDt / 4), 1e-4);
    double longest = 0;
    run(world, 10, kDt, [&] { longest = std::max(longest, distanceBetween(world.pose(body).position, {})); });
    EXPECT_LT(longest, 2.01);
    EXPECT_LT(world.state(joint).coordinate, 2.001f);
}

TEST(WorldJoints, AWeldHoldsABeam) {
    World world(withoutSleep());
    const BodyId beam = world.create(bodyDef(Box{{0.5f, 0.1f, 0.1f}}, {0.5, 0, 0}));
    const JointId joint = world.create(FixedDef{.bodies = {.b = beam, .frameB = frameAt({-0.5f, 0, 0})}});
    run(world, 3);
    const float weight = world.mass(beam).mass * kGravity;
    EXPECT_NEAR(world.state(joint).force.y, weight, 0.01 * weight);
    EXPECT_NEAR(world.state(joint).torque.z, 0.5 * weight, 0.01 * weight);
    EXPECT_LT(length(rotationVector(world.pose(beam).rotation)), 1e-3f);
    EXPECT_LT(world.state(joint).gap, 1e-3f);
}

TEST(WorldJoints, AChainHangsTogether) {
    World world(withoutSleep());
    BodyId before{};
    std::vector<JointId> joints;
    for (int i = 0; i < 10; ++i) {
        const BodyId link = world.create(bodyDef(Capsule{0.05f, 0.1f}, {0, -0.15 - 0.3 * i, 0}));
        joints.push_back(world.create(BallDef{.bodies = {.a = before,
                                                         .b = link,
                                                         .frameA = frameAt({0, i == 0 ? 0.0f : -0.15f, 0}),
                                                         .frameB = frameAt({0, 0.15f, 0})}}));
        before = link;
    }
    world.setVelocity(before, {2, 0, 1}, {});
    float gap = 0;
    run(world, 10, kDt, [&] {
        for (const JointId joint : joints) gap = std::max(gap, world.state(joint).gap);
    });
    EXPECT_LT(gap, 0.01f);
    EXPECT_TRUE(isFinite(world.pose(before).position));
}

TEST(WorldJoints, JoinedBodiesCollideOnlyWhereAsked) {
    for (const bool collide : {false, true}) {
        World world(withoutGravity());
        const BodyId a = world.create(bodyDef(Sphere{0.5f}, {0, 0, 0}));
        const BodyId b = world.create(bodyDef(Sphere{0.5f}, {0.8, 0, 0}));
        JointBodies bodies{.a = a, .b = b};
        bodies.collide = collide;
        const JointId joint = world.create(DistanceDef{.bodies = bodies, .limit = Range{0, 3}});
        run(world, 1);
        const double apart = distanceBetween(world.pose(a).position, world.pose(b).position);
        if (collide)
            EXPECT_GT(apart, 0.99);
        else
            EXPECT_NEAR(apart, 0.8, 1e-5);
        // Without the joint they collide again.
        world.destroy(joint);
        run(world, 1);
        EXPECT_GT(distanceBetween(world.pose(a).position, world.pose(b).position), 0.99);
    }
}

// The momentum of two joined bodies is theirs together: joints act on both alike.
TEST(WorldJoints, AJointedPairKeepsItsMomentum) {
    World world(withoutGravity());
    BodyDef one = bodyDef(Box{{0.5f, 0.1f, 0.1f}}, {0, 0, 0}), two = bodyDef(Box{{0.5f, 0.2f, 0.1f}}, {1, 0, 0});
    one.linearVelocity = {1, 2, 0};
    two.angularVelocity = {0, 3, 4};
    const BodyId a = world.create(one), b = world.create(two);
    world.create(
        BallDef{.bodies = {.a = a, .b = b, .frameA = frameAt({0.5f, 0, 0}), .frameB = frameAt({-0.5f, 0, 0})}});
    const auto momentum = [&] {
        return world.mass(a).mass * world.linearVelocity(a) + world.mass(b).mass * world.linearVelocity(b);
    };
    const auto spin = [&] {
        DVec3 l = DVec3(angularMomentum(world, a)) + DVec3(angularMomentum(world, b));
        for (const BodyId body : {a, b}) {
            const DVec3 x = world.centerOfMass(body), m(world.mass(body).mass * world.linearVelocity(body));
            l = l + DVec3{x.y * m.z - x.z * m.y, x.z * m.x - x.x * m.z, x.x * m.y - x.y * m.x};
        }
        return l;
    };
    const Vec3 p = momentum();
    const DVec3 l = spin();
    run(world, 5);
    EXPECT_LT(length(momentum() - p), 1e-4f * length(p));
    EXPECT_LT(distanceBetween(spin(), l), 0.01 * distanceBetween(l, {}));
}

}  // namespace
}  // namespace ragtop
