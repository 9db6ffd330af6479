#include <algorithm>
#include <cmath>

#include "world_support.h"

namespace ragtop {
namespace {

using namespace test;

/// A box at rest on a slope, solved by sweeps, that nothing else touches.
class WorldFreezing : public ::testing::Test {
protected:
    static constexpr float kTilt = 0.2f;
    static constexpr float kFriction = 0.5f;

    explicit WorldFreezing(const WorldSettings& settings = withoutSleep()) : world(settings) {
        BodyDef slope = bodyDef(Box{{20, 0.5f, 20}}, {}, surface(kFriction), BodyType::fixed);
        slope.pose.rotation = rotationAbout({0, 0, 1}, kTilt);
        ground = world.create(slope);
        const Vec3 up = rotate(slope.pose.rotation, Vec3{0, 1.0005f, 0});
        BodyDef def = bodyDef(Box{{0.5f, 0.5f, 0.5f}}, DVec3{up}, surface(kFriction));
        def.pose.rotation = slope.pose.rotation;
        box = world.create(def);
        run(world, 3);
    }
    void expectStill() {
        const Pose before = world.pose(box);
        run(world, 1);
        EXPECT_EQ(world.pose(box).position, before.position);
        EXPECT_EQ(world.pose(box).rotation, before.rotation);
        EXPECT_EQ(world.linearVelocity(box), Vec3{});
    }
    /// m/s along the slope after so many seconds of sliding with a friction coefficient.
    static float slidingSpeed(float friction, double seconds) {
        return kGravity * (std::sin(kTilt) - friction * std::cos(kTilt)) * static_cast<float>(seconds);
    }

    World world;
    BodyId ground, box;
};

TEST_F(WorldFreezing, WhatRestsOnASlopeKeepsItsPlaceToTheBit) { expectStill(); }

TEST_F(WorldFreezing, IsHeldByItsWeight) {
    run(world, 1);
    float force = 0;
    world.forEachContact(box, [&](const Contact& contact) { force += contact.normalForce; });
    const float weight = world.mass(box).mass * kGravity;
    EXPECT_NEAR(force, weight * std::cos(kTilt), 1e-3f * weight);
}

TEST_F(WorldFreezing, ABlowMovesItInTheSameStep) {
    expectStill();
    const Pose before = world.pose(box);
    world.applyImpulse(box, {0, world.mass(box).mass, 0}, before.position);
    world.step(kDt);
    EXPECT_NEAR(world.pose(box).position.y - before.position.y, kDt * (1 - 0.5 * kGravity * kDt), 1e-3);
}

TEST_F(WorldFreezing, AForceAboveFrictionMovesIt) {
    const float mass = world.mass(box).mass;
    const Vec3 down{-std::cos(kTilt), -std::sin(kTilt), 0};
    for (int i = 0; i < 60; ++i) {
        world.applyForce(box, kGravity * mass * down, world.pose(box).position);
        world.step(kDt);
    }
    EXPECT_NEAR(dot(world.linearVelocity(box), down), slidingSpeed(kFriction, 1) + kGravity, 0.02f * kGravity);
}

// A blow without restitution leaves both at the speed of their common centre of mass; on the 1.1 m before it the ball
// gains at most what the slope gives, and friction takes less than a tenth in the steps around it.
TEST_F(WorldFreezing, IsMovedByWhatHitsItAsMomentumSays) {
    const Vec3 down{-std::cos(kTilt), -std::sin(kTilt), 0};
    const DVec3 start = world.pose(box).position + (-2.0f) * down;
    const BodyId ball = world.create(bodyDef(Sphere{0.4f}, start, surface(kFriction)));
    world.setVelocity(ball, 8.0f * down, {});
    float fastest = 0;
    run(world, 0.5, kDt, [&] { fastest = std::max(fastest, dot(world.linearVelocity(box), down)); });
    const float hits = std::sqrt(64 + 2 * 1.1f * kGravity * std::sin(kTilt));
    const float share = world.mass(ball).mass / (world.mass(ball).mass + world.mass(box).mass);
    EXPECT_LT(fastest, 1.01f * share * hits);
    EXPECT_GT(fastest, 0.9f * share * 8);
}

TEST_F(WorldFreezing, SlidesWhenItsGroundGetsSlippery) {
    world.setMaterial(world.shapes(ground)[0], surface(0));
    run(world, 1);
    EXPECT_NEAR(length(world.linearVelocity(box)), slidingSpeed(0, 1), 0.01f);
}

TEST_F(WorldFreezing, FallsWhenItsGroundIsGone) {
    const double height = world.pose(box).position.y;
    world.destroy(ground);
    run(world, 1);
    EXPECT_NEAR(world.pose(box).position.y - height, -0.5 * kGravity, 0.01);
}

TEST_F(WorldFreezing, FollowsGravity) {
    WorldSettings settings = world.settings();
    settings.gravity = {0, 1, 0};
    world.setSettings(settings);
    run(world, 1);
    EXPECT_NEAR(world.linearVelocity(box).y, 1, 0.01);
}

TEST_F(WorldFreezing, StaysWhenTheStepChanges) {
    const DVec3 before = world.pose(box).position;
    run(world, 2, 1.0 / 144);
    EXPECT_LT(length(relative(world.pose(box).position, before)), 1e-4f);
}

TEST_F(WorldFreezing, GoesOnFromASavedState) {
    expectRestoredGoesOn(world);
    world.applyImpulse(box, {0, world.mass(box).mass, 0}, world.pose(box).position);
    expectRestoredGoesOn(world);
}

TEST_F(WorldFreezing, TouchesAllTheTime) {
    for (int i = 0; i < 60; ++i) {
        world.step(kDt);
        ASSERT_TRUE(world.contactBegins().empty());
        ASSERT_TRUE(world.contactEnds().empty());
    }
}

// What accelerates by a thousandth of gravity is far from rest, though it begins without speed.
TEST(WorldFreezingLimit, AScarceSlopeIsNoRest) {
    World world(withoutSleep());
    constexpr float kFriction = 0.2f;
    const float tilt = std::atan(1.005f * kFriction);
    BodyDef slope = bodyDef(Box{{50, 0.5f, 50}}, {}, surface(kFriction), BodyType::fixed);
    slope.pose.rotation = rotationAbout({0, 0, 1}, tilt);
    world.create(slope);
    BodyDef def =
        bodyDef(Box{{0.5f, 0.25f, 0.5f}}, DVec3{rotate(slope.pose.rotation, Vec3{0, 0.75f, 0})}, surface(kFriction));
    def.pose.rotation = slope.pose.rotation;
    const BodyId box = world.create(def);
    run(world, 4);
    const float rate = kGravity * (std::sin(tilt) - kFriction * std::cos(tilt));
    EXPECT_NEAR(length(world.linearVelocity(box)), 4 * rate, 0.1f * 4 * rate);
}

// The same bits whether others rest beside it or not, on any number of threads and lanes.
TEST(WorldFreezingLimit, HasTheSameBitsOnAnyThreadsAndLanes) {
    const auto play = [](int lanes, int threads) {
        WorldConfig config;
        config.lanes = lanes;
        config.tasks = threadTasks(threads);
        World world(withoutSleep(), config);
        addFloor(world);
        std::vector<BodyId> bodies;
        for (int i = 0; i < 100; ++i) {
            const DVec3 at{1.5 * (i % 10), 0.5, 1.5 * (i / 10)};
            bodies.push_back(world.create(bodyDef(Box{{0.5f, 0.5f, 0.5f}}, at)));
        }
        run(world, 1);
        const BodyId ball = world.create(bodyDef(Sphere{0.5f}, {-3, 0.5, 4.6}));
        world.setVelocity(ball, {15, 0, 0.4f}, {});
        run(world, 2);
        return world.hash();
    };
    const std::uint64_t alone = play(4, 1);
    EXPECT_EQ(play(8, 1), alone);
    EXPECT_EQ(play(8, 2), alone);
    EXPECT_EQ(play(16, 2), alone);
}

}  // namespace
}  // namespace ragtop
