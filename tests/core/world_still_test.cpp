#include "world_support.h"

namespace ragtop {
namespace {

using namespace test;

/// A stack that is solved directly and has come to rest, turned so that no number of its rotations is exact.
class WorldStill : public ::testing::Test {
protected:
    WorldStill() : world(settings()) {
        BodyDef ground = bodyDef(Box{{10, 0.5f, 10}}, {0, -0.5, 0});
        ground.type = BodyType::fixed;
        world.create(ground);
        for (int i = 0; i < 6; ++i) {
            BodyDef def = bodyDef(Box{{0.5f, 0.5f, 0.5f}}, {0, 0.5 + i, 0});
            def.pose.rotation = rotationAbout({0, 1, 0}, 0.3f);
            boxes.push_back(world.create(def));
        }
        run(world, 2);
    }
    static WorldSettings settings() {
        WorldSettings settings = withoutSleep();
        settings.solver = SolverChoice::direct;
        return settings;
    }

    World world;
    std::vector<BodyId> boxes;
};

// What has no velocity goes nowhere: not by the rounding of gravity and its reaction, nor by that of a turn by nothing.
TEST_F(WorldStill, AStackAtRestKeepsItsPlaceToTheBitForAMinute) {
    std::vector<Pose> before;
    for (const BodyId box : boxes) {
        ASSERT_EQ(world.linearVelocity(box), Vec3{});
        ASSERT_EQ(world.angularVelocity(box), Vec3{});
        before.push_back(world.pose(box));
    }
    run(world, 60);
    for (std::size_t i = 0; i < boxes.size(); ++i) {
        EXPECT_EQ(world.pose(boxes[i]).position, before[i].position) << i;
        EXPECT_EQ(world.pose(boxes[i]).rotation, before[i].rotation) << i;
        EXPECT_EQ(world.angularVelocity(boxes[i]), Vec3{}) << i;
    }
}

// A blow beside the centre moves and turns the uppermost box in the step in which it is struck.
TEST_F(WorldStill, WhatIsStruckMovesInTheSameStep) {
    const BodyId top = boxes.back();
    const Pose before = world.pose(top);
    world.applyImpulse(top, {0, world.mass(top).mass, 0}, before.position + Vec3{0.1f, 0, 0});
    world.step(kDt);
    const Pose now = world.pose(top);
    // 1 m/s, less what gravity takes of it in a step.
    EXPECT_NEAR(now.position.y - before.position.y, kDt * (1 - 0.5 * 9.81 * kDt), 1e-3);
    EXPECT_NE(now.rotation, before.rotation);
    EXPECT_NE(world.angularVelocity(top), Vec3{});
}

}  // namespace
}  // namespace ragtop
