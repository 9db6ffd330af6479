#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

#include "heap_counter.h"
#include "ragtop/tasks.h"
#include "world_support.h"

namespace ragtop {
namespace {

using namespace test;

constexpr float kNeverBreaks = std::numeric_limits<float>::infinity();

/// A door of 2 m × 1 m on hinges on one line, which spins with 2 rad/s.
struct Door {
    BodyId body;
    std::vector<JointId> hinges;

    Door(World& world, int count, double x = 0, float breakForce = kNeverBreaks, BodyId frame = {}) {
        BodyDef def = bodyDef(Box{{0.5f, 1, 0.02f}}, {x + 0.5, 1, 0});
        def.shapes[0].filter.mask = 0;
        def.shapes[0].density = 250;  // 20 kg
        def.angularVelocity = {0, 2, 0};
        def.linearVelocity = {0, 0, -1};
        body = world.create(def);
        const Quat up = rotationBetween({1, 0, 0}, {0, 1, 0});
        for (int i = 0; i < count; ++i) {
            const float y = 0.2f + 1.6f * static_cast<float>(i) / static_cast<float>(count - 1);
            JointBodies joined{frame, body, {{static_cast<float>(x), y, 0}, up}, {{-0.5f, y - 1, 0}, up}};
            joined.breakForce = breakForce;
            hinges.push_back(world.create(HingeDef{.bodies = joined}));
        }
    }
    float gap(const World& world) const {
        float largest = 0;
        for (const JointId hinge : hinges) largest = std::max(largest, world.state(hinge).gap);
        return largest;
    }
};

/// A ring of six links that fly, on balls.
std::vector<BodyId> addRing(World& world, float spin = 2) {
    std::vector<BodyId> links;
    for (int i = 0; i < 6; ++i) {
        const double angle = kPi / 3 * i;
        BodyDef def = bodyDef(Capsule{0.05f, 0.2f}, {0.5 * std::cos(angle), 5 + 0.5 * std::sin(angle), 0});
        def.shapes[0].filter.mask = 0;
        def.pose.rotation = rotationAbout({0, 0, 1}, static_cast<float>(angle));
        def.angularVelocity = {0, 0, spin};
        def.linearVelocity = {static_cast<float>(-0.5 * std::sin(angle)) * spin,
                              static_cast<float>(0.5 * std::cos(angle)) * spin, 0.1f * static_cast<float>(i % 2)};
        links.push_back(world.create(def));
    }
    for (std::size_t i = 0; i < 6; ++i) {
        const BodyId a = links[i], b = links[(i + 1) % 6];
        world.create(BallDef{.bodies = {a, b, {{0, 0.25f, 0}, {}}, {{0, -0.25f, 0}, {}}}});
    }
    return links;
}

TEST(Mechanisms, DoorsKeepTheirSpinAndTheirHingesShareTheWeight) {
    for (const SolverChoice solver : {SolverChoice::automatic, SolverChoice::direct}) {
        for (const int hinges : {2, 3, 4}) {
            WorldSettings settings = withoutSleep();
            settings.solver = solver;
            World world(settings);
            const Door door(world, hinges);
            run(world, 20, kDt, [&] { ASSERT_LT(door.gap(world), 1e-6f); });
            EXPECT_NEAR(world.angularVelocity(door.body).y, 2, 1e-4f);
            for (const JointId hinge : door.hinges)
                EXPECT_NEAR(world.state(hinge).force.y, 20 * kGravity / static_cast<float>(hinges), 0.01f);
            ASSERT_EQ(world.stats().islands.size(), 1u);
            EXPECT_STREQ(world.stats().islands[0].reason, solver == SolverChoice::automatic ? "loop" : "asked");
        }
    }
}

/// Limits make it a case for Newton's method, whose loads are carried from substep to substep.
TEST(DirectJoints, HingesOfADoorDoNotPullAgainstEachOther) {
    WorldSettings settings = withoutSleep();
    settings.solver = SolverChoice::direct;
    World world(settings);
    Door door(world, 0);
    const Quat up = rotationBetween({1, 0, 0}, {0, 1, 0});
    for (const float y : {0.2f, 1.0f, 1.8f}) {
        HingeDef def{.bodies = {{}, door.body, {{0, y, 0}, up}, {{-0.5f, y - 1, 0}, up}}};
        def.limit = Range{-1000, 1000};
        door.hinges.push_back(world.create(def));
    }
    run(world, 20, kDt, [&] { ASSERT_LT(door.gap(world), 1e-5f); });
    EXPECT_NEAR(world.angularVelocity(door.body).y, 2, 2e-3f);
    for (const JointId hinge : door.hinges) {
        const Vec3 force = world.state(hinge).force;
        EXPECT_NEAR(force.y, 20 * kGravity / 3, 0.01f * 20 * kGravity / 3);
        // The turning moment of the weight and the centripetal force: no more than both on one hinge.
        EXPECT_LT(std::hypot(force.x, force.z), 20 * kGravity * 0.5f / 1.6f + 20 * 4 * 0.5f);
    }
}

TEST(Mechanisms, TurnsOfHingesAreCountedHoweverFast) {
    World world(withoutSleep());
    const Door door(world, 2);
    world.setVelocity(door.body, {0, 0, -20}, {0, 40, 0});
    float before = world.state(door.hinges[0]).coordinate, turned = 0;
    run(world, 1, kDt, [&] {
        const float now = world.state(door.hinges[0]).coordinate;
        turned += now - before;
        before = now;
    });
    // Steps of φ = 1/12 rad lead by φ²/8.
    EXPECT_NEAR(turned, 40, 40.0f / 8 / 144 * 1.05f);
}

TEST(Mechanisms, RestoredWorldGoesOnBitForBit) {
    World world(withoutSleep());
    addRing(world, 30);
    const Door door(world, 3, 10);
    run(world, 1);
    expectRestoredGoesOn(world);
}

TEST(Mechanisms, ThreadsLanesAndCompanyChangeNoBit) {
    const auto placesAfter = [](const WorldConfig& config, int company) {
        World world(withoutSleep(), config);
        const std::vector<BodyId> links = addRing(world);
        std::vector<Door> others;
        for (int i = 0; i < company; ++i) others.emplace_back(world, 2 + i % 3, 3.0 * i + 3);
        run(world, 1);
        std::vector<DVec3> places;
        for (const BodyId link : links) places.push_back(world.centerOfMass(link));
        return places;
    };
    const std::vector<DVec3> alone = placesAfter({.lanes = 4}, 0);
    for (const int lanes : {4, 8, 16})
        for (const int workers : {1, 2})
            EXPECT_EQ(placesAfter({.tasks = threadTasks(workers), .lanes = lanes}, 5), alone) << lanes << workers;
}

TEST(Mechanisms, SteadyStepsAskForNoMemory) {
    World world(withoutSleep());
    addRing(world);
    const Door door(world, 3, 10);
    run(world, 6);
    const long before = heapCalls();
    for (int i = 0; i < stepsIn(1); ++i) world.step(kDt);  // without asking the world what holds of it, which takes memory
    EXPECT_EQ(heapCalls() - before, 0);
}

TEST(Mechanisms, FlyOnAParabola) {
    World world(withoutSleep());
    const std::vector<BodyId> links = addRing(world);
    const auto center = [&] {
        DVec3 sum;
        for (const BodyId link : links) sum = sum + (1.0 / 6) * world.centerOfMass(link);
        return sum;
    };
    const DVec3 before = center();
    run(world, 2);
    EXPECT_NEAR(center().y, before.y - 0.5 * 9.81 * 4, 1e-4);
    EXPECT_NEAR(center().x, before.x, 1e-4);
}

TEST(Mechanisms, FollowWhatIsMovedByHand) {
    World world(withoutSleep());
    BodyDef frame = bodyDef(Box{{0.1f, 0.1f, 0.1f}}, {0, 0, 0}, {}, BodyType::kinematic);
    frame.shapes[0].filter.mask = 0;
    const BodyId hand = world.create(frame);
    const Door door(world, 3, 0, kNeverBreaks, hand);
    float largest = 0;
    int step = 0;
    run(world, 3, kDt, [&] {
        const float t = static_cast<float>(++step) / 60;
        world.setVelocity(hand, {std::sin(3 * t), 0.2f * std::cos(5 * t), 0}, {0.3f * std::sin(t), 1, 0});
        largest = std::max(largest, door.gap(world));
    });
    EXPECT_LT(largest, 1e-5f);
}

/// The door pulls each of two hinges with some 110 N, 98 N of them its weight.
TEST(Mechanisms, HingesBreakUnderMoreThanTheyBear) {
    World world(withoutSleep());
    const Door strong(world, 2, 0, 150), weak(world, 2, 5, 90);
    run(world, 0.5);
    for (const JointId hinge : strong.hinges) EXPECT_TRUE(world.isValid(hinge));
    EXPECT_FALSE(world.isValid(weak.hinges[0]));
}

TEST(Mechanisms, ImpulsesFromOutsideAreTakenOver) {
    World world(withoutSleep());
    const Door door(world, 2);
    run(world, 0.5);
    const Vec3 w = world.angularVelocity(door.body);
    world.setVelocity(door.body, {}, {});
    run(world, 0.5);
    EXPECT_NEAR(w.y, 2, 1e-4f);
    EXPECT_NEAR(world.angularVelocity(door.body).y, 0, 1e-4f);
}

/// A bar of 1 m between two points that are 3 m apart: no pose closes both joints.
TEST(Mechanisms, WhatCannotBeClosedIsSwept) {
    World world(withoutSleep());
    BodyDef def = bodyDef(Box{{0.5f, 0.02f, 0.02f}}, {0, 0, 0});
    def.shapes[0].filter.mask = 0;
    const BodyId bar = world.create(def);
    for (const float side : {-1.0f, 1.0f})
        world.create(BallDef{.bodies = {{}, bar, {{1.5f * side, 0, 0}, {}}, {{0.5f * side, 0, 0}, {}}}});
    run(world, 1, kDt, [&] { ASSERT_TRUE(std::isfinite(world.centerOfMass(bar).y)); });
    EXPECT_GE(world.stats().directFailures, 1u);
    EXPECT_LT(length(world.linearVelocity(bar)), 1);
}

}  // namespace
}  // namespace ragtop
