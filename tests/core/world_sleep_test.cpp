#include "world_support.h"

namespace ragtop {
namespace {

using namespace test;

bool anyAwake(const World& world, const std::vector<BodyId>& bodies) {
    for (const BodyId body : bodies)
        if (world.isAwake(body)) return true;
    return false;
}

struct Stack {
    World world;
    BodyId floor;
    std::vector<BodyId> boxes;

    explicit Stack(int count = 3) {
        floor = addFloor(world);
        for (int i = 0; i < count; ++i)
            boxes.push_back(world.create(bodyDef(Box{{0.5f, 0.5f, 0.5f}}, {0, 0.5 + i, 0})));
        run(world, 4);
    }
};

// The stack is placed at rest, so it is quiet after its soft contacts have sagged, well within a second, and sleeps
// sleepTime later.
TEST(WorldSleep, AStackSleepsAndCostsNothing) {
    Stack stack;
    EXPECT_FALSE(anyAwake(stack.world, stack.boxes));
    EXPECT_EQ(stack.world.stats().awakeBodies, 0);
    const std::uint64_t hash = stack.world.hash();
    const DVec3 p = stack.world.pose(stack.boxes[2]).position;
    run(stack.world, 2);
    EXPECT_EQ(stack.world.pose(stack.boxes[2]).position, p);
    EXPECT_EQ(stack.world.linearVelocity(stack.boxes[2]), Vec3{});
    EXPECT_NE(hash, 0u);
}

TEST(WorldSleep, ASleeperIsToldOnce) {
    World world;
    addFloor(world);
    const BodyId box = world.create(bodyDef(Box{{0.5f, 0.5f, 0.5f}}, {0, 0.5, 0}));
    int asleep = 0, awake = 0;
    const auto count = [&] {
        for (const SleepEvent& event : world.sleepEvents()) {
            EXPECT_EQ(event.body, box);
            ++(event.asleep ? asleep : awake);
        }
    };
    run(world, 4, kDt, count);
    EXPECT_EQ(asleep, 1);
    EXPECT_FALSE(world.isAwake(box));
}

TEST(WorldSleep, WakingDoesNotJump) {
    Stack stack(5);
    std::vector<DVec3> before;
    for (const BodyId box : stack.boxes) before.push_back(stack.world.pose(box).position);
    stack.world.wake(stack.boxes[0]);
    for (const BodyId box : stack.boxes) EXPECT_TRUE(stack.world.isAwake(box));
    for (int i = 0; i < 10; ++i) {
        stack.world.step(kDt);
        for (std::size_t k = 0; k < before.size(); ++k) {
            // Impulses are kept over the sleep: speeds stay below the one that counts as rest.
            EXPECT_LT(length(stack.world.linearVelocity(stack.boxes[k])), 0.01f) << k << " step " << i;
            EXPECT_LT(distanceBetween(stack.world.pose(stack.boxes[k]).position, before[k]), 1e-3);
        }
    }
}

TEST(WorldSleep, TouchingWakes) {
    Stack stack;
    BodyDef def = bodyDef(Sphere{0.3f}, {-6, 0.5, 0});
    def.linearVelocity = {6, 2, 0};
    stack.world.create(def);
    bool woke = false;
    run(stack.world, 2, kDt, [&] { woke |= stack.world.isAwake(stack.boxes[2]); });
    EXPECT_TRUE(woke);
}

TEST(WorldSleep, APassingBodyDoesNotWake) {
    Stack stack;
    BodyDef def = bodyDef(Sphere{0.3f}, {-6, 1.5, 2});
    def.linearVelocity = {6, 4, 0};
    stack.world.create(def);
    run(stack.world, 1.2, kDt, [&] { ASSERT_FALSE(anyAwake(stack.world, stack.boxes)); });
}

TEST(WorldSleep, WhatLosesItsSupportFalls) {
    for (const bool byFloor : {false, true}) {
        Stack stack;
        stack.world.destroy(byFloor ? stack.floor : stack.boxes[0]);
        run(stack.world, 0.5);
        EXPECT_LT(height(stack.world, stack.boxes[2]), 2.5 - (byFloor ? 1.0 : 0.8));
    }
}

TEST(WorldSleep, MovingTheFloorAwayWakes) {
    Stack stack;
    stack.world.setPose(stack.floor, {{0, -5, 0}, {}});
    run(stack.world, 0.5);
    EXPECT_NEAR(height(stack.world, stack.boxes[0]), 0.5 - 0.5 * 9.81 * 0.25, 0.05);
}

TEST(WorldSleep, EveryChangeWakes) {
    const std::vector<std::function<void(World&, BodyId)>> changes = {
        [](World& w, BodyId b) {
            w.applyImpulse(b, {1, 0, 0}, {});
        },
        [](World& w, BodyId b) {
            w.applyAngularImpulse(b, {1, 0, 0});
        },
        [](World& w, BodyId b) {
            w.applyForce(b, {1, 0, 0}, {});
        },
        [](World& w, BodyId b) {
            w.applyTorque(b, {1, 0, 0});
        },
        [](World& w, BodyId b) {
            w.setVelocity(b, {1, 0, 0}, {});
        },
        [](World& w, BodyId b) {
            w.setPose(b, {{0, 3, 0}, {}});
        },
        [](World& w, BodyId b) { w.setGravityScale(b, 0.5f); },
        [](World& w, BodyId b) { w.setMaterial(w.shapes(b)[0], surface(0)); },
        [](World& w, BodyId b) { w.setFilter(w.shapes(b)[0], Filter{.mask = 0}); },
        [](World& w, BodyId b) {
            w.create(BallDef{.bodies = {.b = b, .frameA = {{0, 0.5f, 0}, {}}}});
        },
        [](World& w, BodyId) {
            WorldSettings s;
            s.gravity = {0, 9.81f, 0};
            w.setSettings(s);
        },
        [](World& w, BodyId) { w.setSettings(withoutSleep()); },
    };
    for (std::size_t i = 0; i < changes.size(); ++i) {
        Stack stack(1);
        ASSERT_FALSE(stack.world.isAwake(stack.boxes[0]));
        changes[i](stack.world, stack.boxes[0]);
        EXPECT_TRUE(stack.world.isAwake(stack.boxes[0])) << i;
        stack.world.step(kDt);
        EXPECT_TRUE(stack.world.isAwake(stack.boxes[0])) << i;
    }
}

TEST(WorldSleep, AJointWakesItsBodies) {
    World world(withoutGravity());
    const BodyId a = world.create(bodyDef(Box{{0.5f, 0.5f, 0.5f}}, {0, 0, 0}));
    const BodyId b = world.create(bodyDef(Box{{0.5f, 0.5f, 0.5f}}, {3, 0, 0}));
    SliderDef def{.bodies = {.a = a, .b = b, .frameA = {{3, 0, 0}, {}}}};
    const JointId joint = world.create(def);
    run(world, 2);
    EXPECT_FALSE(anyAwake(world, {a, b}));
    def.motor = Motor{1, 100};
    world.setDef(joint, def);
    EXPECT_TRUE(world.isAwake(a) && world.isAwake(b));
    world.sleep(a);
    EXPECT_FALSE(anyAwake(world, {a, b}));
    world.wake(b);
    EXPECT_TRUE(world.isAwake(a) && world.isAwake(b));
    world.sleep(a);
    world.destroy(joint);
    EXPECT_TRUE(world.isAwake(a) && world.isAwake(b));
}

TEST(WorldSleep, AMovingPlatformKeepsItsLoadAwake) {
    World world;
    BodyDef def = bodyDef(Box{{1, 0.1f, 1}}, {}, surface(0.8f), BodyType::kinematic);
    def.linearVelocity = {0.01f, 0, 0};
    const BodyId platform = world.create(def);
    const BodyId box = world.create(bodyDef(Box{{0.3f, 0.3f, 0.3f}}, {0, 0.4, 0}, surface(0.8f)));
    run(world, 10);
    EXPECT_TRUE(world.isAwake(box));
    EXPECT_NEAR(world.pose(box).position.x, 0.1, 1e-3);
    // Once it stands, both sleep; when it starts again, both go.
    world.setVelocity(platform, {}, {});
    run(world, 3);
    EXPECT_FALSE(world.isAwake(box));
    const double x = world.pose(box).position.x;
    world.setVelocity(platform, {1, 0, 0}, {});
    run(world, 1);
    EXPECT_NEAR(world.pose(box).position.x - x, 1, 0.1);
}

/// It falls asleep by itself, and the joint with it did: the pendulum fell.
TEST(WorldSleep, AKinematicBodyThatStandsStillHoldsAPendulum) {
    World world;
    const BodyId hook = world.create(bodyDef(Sphere{0.1f}, {0, 10, 0}, {}, BodyType::kinematic));
    const BodyId bob = world.create(bodyDef(Sphere{0.2f}, {2, 10, 0}));
    const JointId joint = world.create(BallDef{.bodies = {.a = hook, .b = bob, .frameB = {{-2, 0, 0}, {}}}});
    run(world, 3, kDt, [&] { ASSERT_LT(world.state(joint).gap, 1e-3f); });
    EXPECT_FALSE(world.isAwake(hook));
    EXPECT_TRUE(world.isAwake(bob));
}

/// A hand that is given its velocity in each step, as a game does, first stands still until what it holds sleeps.
TEST(WorldSleep, AKinematicBodyThatSetsOffTakesAlongWhatItHolds) {
    for (const float speed : {1e-4f, 0.01f, 1.0f}) {
        World world;
        const BodyId hand = world.create(bodyDef(Box{{0.3f, 0.1f, 0.3f}}, {0, 5, 0}, {}, BodyType::kinematic));
        const BodyId held = world.create(bodyDef(Box{{0.1f, 0.1f, 0.1f}}, {0, 4.5, 0}));
        FixedDef grip;
        grip.bodies.a = hand;
        grip.bodies.b = held;
        grip.bodies.frameA.position = {0, -0.5f, 0};
        world.create(JointDef{grip});
        const auto go = [&](float along, int steps) {
            for (int i = 0; i < steps; ++i) {
                world.setVelocity(hand, {along, 0, 0}, {});
                world.step(kDt);
            }
        };
        go(0, 120);
        EXPECT_FALSE(world.isAwake(held));
        go(speed, 120);
        EXPECT_TRUE(world.isAwake(held)) << speed;
        EXPECT_NEAR(world.pose(held).position.x, world.pose(hand).position.x, 1e-4) << speed;
    }
}

TEST(WorldSleep, WhoMayNotSleepDoesNot) {
    World world;
    addFloor(world);
    BodyDef def = bodyDef(Box{{0.5f, 0.5f, 0.5f}}, {0, 0.5, 0});
    def.allowSleep = false;
    const BodyId box = world.create(def);
    run(world, 4);
    EXPECT_TRUE(world.isAwake(box));
    EXPECT_EQ(world.stats().awakeBodies, 1);
}

TEST(WorldSleep, AFallingBodyAtItsApexDoesNotSleep) {
    World world;
    const BodyId ball = world.create(DynamicBody{.shape = Sphere{0.5f}, .linearVelocity = {0, 5, 0}});
    run(world, 3);
    EXPECT_NEAR(height(world, ball), 15 - 0.5 * 9.81 * 9, 0.01);
}

TEST(WorldSleep, AFixedBodyPutIntoASleeperWakesIt) {
    World world;
    addFloor(world);
    const BodyId box = world.create(bodyDef(Box{{0.5f, 0.5f, 0.5f}}, {0, 0.5, 0}));
    const BodyId wall = world.create(bodyDef(Box{{0.5f, 0.5f, 0.5f}}, {20, 0.5, 0}, {}, BodyType::fixed));
    run(world, 3);
    ASSERT_FALSE(world.isAwake(box));
    world.setPose(wall, {{0.8, 0.5, 0}, {}});
    EXPECT_TRUE(world.isAwake(box));
    run(world, 3);
    EXPECT_NEAR(world.pose(box).position.x, -0.2, 0.01);
}

}  // namespace
}  // namespace ragtop
