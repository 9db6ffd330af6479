#include "world_support.h"

namespace ragtop {
namespace {

using namespace test;

constexpr float kBallRadius = 0.5f;

// What is round about its centre does not come nearer to anything as it turns.
TEST(WorldRoundBodies, ABallThatSpinsInPlaceMeetsNothing) {
    constexpr float kSpin = 60;  // rad/s: its surface goes a radius per step
    for (const bool isBall : {true, false}) {
        World world(withoutGravity());
        addFloor(world);
        const Shape shape = isBall ? Shape(Sphere{kBallRadius}) : Shape(Box{{kBallRadius, kBallRadius, kBallRadius}});
        BodyDef def = bodyDef(shape, {0, asDouble(kBallRadius) + 0.03, 0});
        def.angularVelocity = {0, 0, kSpin};
        world.create(def);
        world.step(kDt);
        EXPECT_EQ(world.stats().colors, isBall ? 0 : 1);
    }
}

// The ends of a rod go round its centre, by more than the gap in a step.
TEST(WorldRoundBodies, ARodThatTurnsIsForeseenToMeetTheFloor) {
    constexpr float kHalf = 0.5f, kRound = 0.1f, kSpin = 12;
    World world(withoutGravity());
    addFloor(world, surface(0));
    BodyDef def = bodyDef(Capsule{kRound, kHalf}, {0, 0.15, 0}, surface(0));
    def.pose.rotation = rotationAbout({0, 0, 1}, kPi / 2);
    def.angularVelocity = {0, 0, kSpin};
    const BodyId rod = world.create(def);
    for (int i = 0; i < 30; ++i) {
        world.step(kDt);
        const Vec3 axis = rotate(world.pose(rod).rotation, Vec3{0, kHalf, 0});
        const double lowest = height(world, rod) - asDouble(std::fabs(axis.y) + kRound);
        EXPECT_GT(lowest, -0.02 * asDouble(kRound)) << i;
    }
}

}  // namespace
}  // namespace ragtop
