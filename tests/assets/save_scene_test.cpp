#include <gtest/gtest.h>

#include "ragtop/scene.h"
#include "support/temporary_path.h"

namespace ragtop {
namespace {

SceneBody body(Shape shape, const DVec3& position, float density) {
    SceneBody made;
    made.def.shapes.push_back({.geometry = std::move(shape), .density = density});
    made.def.pose.position = position;
    return made;
}

/// What a generator has built is a file like any other.
TEST(SaveScene, WhatIsWrittenIsReadAsItWas) {
    Scene scene;
    scene.settings.gravity = {0, -3.7f, 0};
    scene.step = 1.0 / 120;
    scene.bodies = {body(Box{{1, 0.5f, 2}}, {0, 3, 0}, 700), body(Sphere{0.25f}, {0, 4, 1.5}, 2000)};
    scene.bodies[0].def.type = BodyType::kinematic;
    scene.bodies[0].def.linearVelocity = {1, 0, 0};
    scene.bodies[1].def.shapes[0].material.friction = 0.3f;
    BallDef ball;
    ball.swingLimit = 0.5f;
    ball.friction = 2;
    ball.bodies.frameA.position = {0, 0.5f, 1.5f};
    ball.bodies.frameB.position = {0, -0.5f, 0};
    scene.joints.push_back({{}, 0, 1, ball});

    const auto file = temporaryPath("saved_scene.json");
    saveScene(scene, file);
    const Scene read = loadScene(file);

    EXPECT_EQ(read.settings.gravity, scene.settings.gravity);
    EXPECT_EQ(read.step, scene.step);
    ASSERT_EQ(read.bodies.size(), 2u);
    EXPECT_EQ(read.bodies[0].def.type, BodyType::kinematic);
    EXPECT_EQ(read.bodies[0].def.linearVelocity, scene.bodies[0].def.linearVelocity);
    EXPECT_EQ(read.bodies[1].def.pose.position, scene.bodies[1].def.pose.position);
    EXPECT_EQ(read.bodies[1].def.shapes[0].density, 2000);
    EXPECT_EQ(read.bodies[1].def.shapes[0].material.friction, 0.3f);
    ASSERT_EQ(read.joints.size(), 1u);
    EXPECT_EQ(read.joints[0].bodyA, 0);
    EXPECT_EQ(read.joints[0].bodyB, 1);
    const auto& joint = std::get<BallDef>(read.joints[0].def);
    EXPECT_EQ(joint.swingLimit, ball.swingLimit);
    EXPECT_EQ(joint.friction, ball.friction);
    EXPECT_EQ(joint.bodies.frameB.position, ball.bodies.frameB.position);
}

TEST(SaveScene, ABodyOfSeveralShapesIsRefused) {
    Scene scene;
    scene.bodies = {body(Sphere{0.25f}, {}, 1000)};
    scene.bodies[0].def.shapes.push_back(scene.bodies[0].def.shapes[0]);
    EXPECT_THROW(saveScene(scene, temporaryPath("two_shapes.json")), AssetError);
}

}  // namespace
}  // namespace ragtop
