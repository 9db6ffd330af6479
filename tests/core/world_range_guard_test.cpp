#include "world_support.h"

namespace ragtop::test {
namespace {

constexpr float kBeyond = 3e38f;  // what single precision holds, and its square does not

struct Crowd {
    World world{withoutSleep()};
    std::vector<BodyId> bodies;

    /// A wall on a floor, a chain of all kinds of joints that hangs beside it, and a ball far from both.
    Crowd() {
        addFloor(world);
        for (int i = 0; i < 12; ++i)
            bodies.push_back(world.create(bodyDef(Box{{0.5f, 0.25f, 0.5f}}, {1.0 * (i % 3), 0.25 + 0.5 * (i / 3), 0})));
        BodyId last;
        for (int i = 0; i < 6; ++i) {
            const BodyId link = world.create(bodyDef(Capsule{0.1f, 0.2f}, {5, 5 - 0.5 * i, 0}));
            JointBodies joined{.a = last, .b = link};
            joined.frameA.position = i == 0 ? Vec3{5, 5.25f, 0} : Vec3{0, -0.25f, 0};
            joined.frameB.position = {0, 0.25f, 0};
            if (i % 2 == 0)
                world.create(JointDef{BallDef{.bodies = joined, .friction = 0.1f}});
            else
                world.create(JointDef{HingeDef{.bodies = joined, .limit = Range{-1, 1}}});
            bodies.push_back(last = link);
        }
        bodies.push_back(world.create(bodyDef(Sphere{0.5f}, {50, 0.5, 0})));
    }
    bool holds() const {
        for (const BodyId body : bodies) {
            const Pose pose = world.pose(body);
            const bool finite = isFinite(pose.position) && isFinite(pose.rotation) &&
                                isFinite(world.linearVelocity(body)) && isFinite(world.angularVelocity(body));
            if (!finite) return false;
        }
        return true;
    }
};

// A body on which a force beyond all measure acts stays where it was; what it touches, and what hangs on it, lives on.
TEST(WorldRangeGuard, AForceBeyondAllMeasureStopsItsBodyAlone) {
    for (const std::size_t victim : {std::size_t{0}, std::size_t{4}, std::size_t{13}, std::size_t{17}}) {
        Crowd crowd;
        World& world = crowd.world;
        for (int i = 0; i < 30; ++i) world.step(kDt);
        world.applyForce(crowd.bodies[victim], {kBeyond, kBeyond, 0}, world.pose(crowd.bodies[victim]).position);
        world.step(kDt);
        ASSERT_TRUE(crowd.holds());
        EXPECT_GT(world.stats().outOfRange, 0u);
        for (int i = 0; i < 120; ++i) world.step(kDt);
        ASSERT_TRUE(crowd.holds());
        EXPECT_NEAR(world.pose(crowd.bodies.back()).position.y, 0.5, 1e-3);
        EXPECT_NEAR(world.pose(crowd.bodies.back()).position.x, 50, 1e-3);
    }
}

TEST(WorldRangeGuard, AnImpulseBeyondAllMeasureDoesToo) {
    Crowd crowd;
    World& world = crowd.world;
    for (const std::size_t victim : {std::size_t{2}, std::size_t{15}}) {
        world.applyAngularImpulse(crowd.bodies[victim], {kBeyond, -kBeyond, kBeyond});
        world.step(kDt);
        ASSERT_TRUE(crowd.holds());
    }
    for (int i = 0; i < 120; ++i) world.step(kDt);
    EXPECT_TRUE(crowd.holds());
    EXPECT_GE(world.stats().outOfRange, 2u);
}

TEST(WorldRangeGuard, NothingLeavesTheRangeInQuietScenes) {
    Crowd crowd;
    for (int i = 0; i < 60; ++i) crowd.world.step(kDt);
    EXPECT_EQ(crowd.world.stats().outOfRange, 0u);
}

}  // namespace
}  // namespace ragtop::test
