#include <gtest/gtest.h>

#include <limits>
#include <stdexcept>
#include <vector>

#include "ragtop/world.h"
#include "world_support.h"

/// Shapes that are moved in their bodies, and that give way.
namespace ragtop {
namespace {

BodyId layFloor(World& world) { return world.create(StaticBody{.shape = Box{{50, 1, 50}}, .position = {0, -1, 0}}); }

/// A box whose foot is moved down: it stands higher by as much.
TEST(ShapeMotion, ABodyStandsOnAShapeWhereItWasMoved) {
    World world;
    layFloor(world);
    BodyDef def;
    def.shapes = {ShapeDef{.geometry = Box{{0.5f, 0.1f, 0.5f}}}, ShapeDef{.geometry = Box{{0.4f, 0.1f, 0.4f}}}};
    def.pose.position = {0, 0.1, 0};
    const BodyId body = world.create(def);
    for (int i = 0; i < 60; ++i) world.step(test::kDt);
    EXPECT_NEAR(world.pose(body).position.y, 0.1, 2e-3);
    const ShapeId foot = world.shapes(body)[1];
    for (int i = 1; i <= 60; ++i) {
        world.setFrame(foot, {{0, -0.005f * static_cast<float>(i), 0}, {}});
        world.step(test::kDt);
        ASSERT_EQ(world.validate(), "");
    }
    for (int i = 0; i < 60; ++i) world.step(test::kDt);
    EXPECT_NEAR(world.pose(body).position.y, 0.4, 4e-3);
    EXPECT_NEAR(world.frame(foot).position.y, -0.3f, 1e-6f);
}

TEST(ShapeMotion, WakesTheBodyWhereItIsAChange) {
    World world;
    layFloor(world);
    const BodyId body = world.create(DynamicBody{.shape = Box{{0.5f, 0.1f, 0.5f}}, .position = {0, 0.1, 0}});
    for (int i = 0; i < 120; ++i) world.step(test::kDt);
    ASSERT_FALSE(world.isAwake(body));
    const ShapeId shape = world.shapes(body)[0];
    world.setFrame(shape, world.frame(shape));
    EXPECT_FALSE(world.isAwake(body));
    world.setFrame(shape, {{0, 0.05f, 0}, {}});
    EXPECT_TRUE(world.isAwake(body));
}

TEST(ShapeMotion, RejectsAFrameThatIsNone) {
    World world;
    const BodyId body = world.create(DynamicBody{.shape = Sphere{0.5f}});
    const ShapeId shape = world.shapes(body)[0];
    const float none = std::numeric_limits<float>::quiet_NaN();
    EXPECT_THROW(world.setFrame(shape, {{none, 0, 0}, {}}), std::invalid_argument);
    EXPECT_THROW(world.setFrame(shape, {{}, {0, 0, 0, 0}}), std::invalid_argument);
    EXPECT_THROW(world.setFrame(ShapeId{}, {}), std::out_of_range);
    EXPECT_EQ(world.frame(shape).position, (Vec3{}));
}

/// What gives way upward sinks into the floor that pushes it so, and is stopped by the wall beside it.
TEST(ShapeMotion, WhatGivesWayIsPushedAcrossItsWayAlone) {
    World world;
    layFloor(world);
    world.create(StaticBody{.shape = Box{{1, 5, 5}}, .position = {3, 0, 0}});
    BodyDef def;
    def.shapes = {ShapeDef{.geometry = Sphere{0.5f}, .givesWay = true}};
    def.pose.position = {0, 1, 0};
    def.linearVelocity = {4, 0, 0};
    def.gravityScale = 0;
    const BodyId body = world.create(def);
    EXPECT_TRUE(world.givesWay(world.shapes(body)[0]));
    for (int i = 0; i < 60; ++i) world.step(test::kDt);
    EXPECT_NEAR(world.pose(body).position.x, 1.5, 0.02);
    world.setVelocity(body, {0, -2, 0}, {});
    for (int i = 0; i < 24; ++i) world.step(test::kDt);
    EXPECT_NEAR(world.pose(body).position.y, 0.2, 0.01);
}

/// A wheel that gives way goes over a step that ends below its middle, and is stopped by one that ends above it,
/// however fast it comes.
TEST(ShapeMotion, WhatGivesWayGoesOverWhatMeetsItBelowItsMiddle) {
    std::vector<Vec3> rim;
    for (int i = 0; i < 16; ++i)
        for (const float side : {-0.1f, 0.1f})
            rim.push_back(Vec3{side, 0, 0} +
                          rotate(rotationAbout({1, 0, 0}, 2 * kPi * static_cast<float>(i) / 16), {0, 0.5f, 0}));
    for (const float speed : {1.0f, 8.0f}) {
        for (const float height : {0.6f, 0.85f, 1.1f}) {
            WorldSettings settings;
            settings.sleeping = false;  // whatever its size is: none of its shapes holds it
            World world(settings);
            world.create(
                StaticBody{.shape = Box{{5, 0.5f * height, 5}}, .position = {0, 0.5 * static_cast<double>(height), 6}});
            BodyDef def;
            def.shapes = {ShapeDef{.geometry = ConvexHull(rim), .givesWay = true}};
            def.pose.position = {0, 1, 0};
            def.linearVelocity = {0, 0, speed};
            def.gravityScale = 0;
            const BodyId body = world.create(def);
            for (int i = 0; i < static_cast<int>(120 / speed); ++i) world.step(test::kDt);
            const double z = world.pose(body).position.z;
            if (height < 1)
                EXPECT_NEAR(z, 2, 0.2) << height << " m at " << speed << " m/s";
            else
                EXPECT_LT(z, 0.52) << height << " m at " << speed << " m/s";
        }
    }
}

}  // namespace
}  // namespace ragtop
