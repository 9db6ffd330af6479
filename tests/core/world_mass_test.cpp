#include <gtest/gtest.h>

#include <stdexcept>

#include "ragtop/world.h"
#include "scenes.h"

namespace ragtop {
namespace {

MassProperties ballOf(float mass, const Vec3& center) {
    const float i = 0.4f * mass * 0.25f;
    return {mass, center, {{i, 0, 0}, {0, i, 0}, {0, 0, i}}};
}

/// A change of mass moves no point of the body and changes the velocity of none.
TEST(Mass, ChangesNeitherPlaceNorMotion) {
    World world({.gravity = {}});
    BodyDef def;
    def.shapes.push_back({.geometry = Box{{1, 0.5f, 0.25f}}});
    def.pose = {{3, 4, 5}, rotationAbout({1, 2, 3}, 0.7f)};
    def.linearVelocity = {1, 2, 3};
    def.angularVelocity = {0.3f, -0.2f, 0.5f};
    const BodyId body = world.create(def);
    const DVec3 corner = transformPoint(world.pose(body), {1, 0.5f, 0.25f});
    const Vec3 speed = world.velocityAt(body, corner);
    world.setMass(body, ballOf(7, {0.3f, -0.1f, 0.05f}));
    EXPECT_NEAR(length(relative(transformPoint(world.pose(body), {1, 0.5f, 0.25f}), corner)), 0, 1e-6);
    EXPECT_NEAR(length(world.velocityAt(body, corner) - speed), 0, 1e-6);
    EXPECT_EQ(world.mass(body).mass, 7);
    EXPECT_NEAR(length(world.mass(body).center - Vec3{0.3f, -0.1f, 0.05f}), 0, 1e-6);
    EXPECT_NEAR(length(world.frame(world.shapes(body)[0]).position), 0, 1e-6);
    // Free, it turns about its new centre, which goes straight.
    const DVec3 center = world.centerOfMass(body);
    const Vec3 velocity = world.linearVelocity(body);
    for (int i = 0; i < 60; ++i) world.step(1.0 / 60);
    EXPECT_NEAR(length(relative(world.centerOfMass(body), center + velocity)), 0, 1e-4);
}

/// A box that stands goes on standing when it gets heavier, and the ground carries its new weight at once.
TEST(Mass, StandingBodiesStandOnWithTheirNewWeight) {
    World world;
    world.create(StaticBody{.shape = Box{{10, 1, 10}}, .position = {0, -1, 0}});
    const BodyId box =
        world.create(DynamicBody{.shape = Box{{0.5f, 0.5f, 0.5f}}, .density = 100, .position = {0, 0.5, 0}});
    for (int i = 0; i < 60; ++i) world.step(1.0 / 60);
    const double height = world.pose(box).position.y;
    MassProperties mass = world.mass(box);
    const float before = mass.mass;
    mass = {4 * mass.mass, {0.1f, -0.1f, 0}, {4 * mass.inertia.cx, 4 * mass.inertia.cy, 4 * mass.inertia.cz}};
    world.setMass(box, mass);
    for (int i = 0; i < 60; ++i) world.step(1.0 / 60);
    EXPECT_NEAR(world.pose(box).position.y, height, 1e-3);
    float force = 0;
    world.forEachContact(box, [&](const Contact& contact) { force += contact.normalForce; });
    EXPECT_NEAR(force, 4 * before * 9.81f, 0.02f * 4 * before * 9.81f);
}

/// A pendulum's joint holds the same point of the body.
TEST(Mass, JointsStayWhereTheyAre) {
    World world;
    const BodyId bob = world.create(DynamicBody{.shape = Sphere{0.2f}, .position = {1, 0, 0}});
    HingeDef hinge;
    hinge.bodies.b = bob;
    hinge.bodies.frameB.position = {-1, 0, 0};
    const JointId joint = world.create(JointDef(hinge));
    for (int i = 0; i < 20; ++i) world.step(1.0 / 60);
    const float gap = world.state(joint).gap;
    world.setMass(bob, ballOf(50, {0.05f, 0.05f, 0}));
    EXPECT_NEAR(world.state(joint).gap, gap, 1e-6f);
    for (int i = 0; i < 120; ++i) world.step(1.0 / 60);
    EXPECT_LT(world.state(joint).gap, 1e-3f);
}

TEST(Mass, WhatCannotBeIsRefused) {
    World world;
    const BodyId ground = world.create(StaticBody{.shape = Box{{10, 1, 10}}});
    const BodyId box = world.create(DynamicBody{.shape = Box{}});
    const MassProperties before = world.mass(box);
    EXPECT_THROW(world.setMass(ground, ballOf(1, {})), std::invalid_argument);
    EXPECT_THROW(world.setMass(box, ballOf(0, {})), std::invalid_argument);
    EXPECT_THROW(world.setMass(box, {1, {}, {{-1, 0, 0}, {0, 1, 0}, {0, 0, 1}}}), std::invalid_argument);
    EXPECT_EQ(world.mass(box).mass, before.mass);
}

TEST(Mass, IsPartOfTheState) {
    World world;
    scenes::addTower(world, {}, 4);
    for (int i = 0; i < 30; ++i) world.step(1.0 / 60);
    std::vector<std::byte> state(world.saveSize());
    world.save(state);
    const BodyId box = world.bodies()[2];
    const float before = world.mass(box).mass;
    const auto heavier = [&] {
        MassProperties mass = world.mass(box);
        mass.mass *= 3;
        world.setMass(box, mass);
        for (int i = 0; i < 30; ++i) world.step(1.0 / 60);
        return world.hash();
    };
    const std::uint64_t hash = heavier();
    world.restore(state);
    EXPECT_EQ(world.mass(box).mass, before);
    EXPECT_EQ(heavier(), hash);
}

TEST(Islands, AreKnownByTheirFirstBody) {
    World world;
    world.create(StaticBody{.shape = Box{{20, 1, 20}}, .position = {0, -1, 0}});
    std::vector<BodyId> boxes;
    for (const double x : {-5.0, 0.0, 5.0}) {
        for (const double y : {0.5, 1.5})
            boxes.push_back(world.create(DynamicBody{.shape = Box{}, .position = {x, y, 0}}));
    }
    for (int i = 0; i < 5; ++i) world.step(1.0 / 60);
    const std::vector<BodyId> islands = world.islands();
    ASSERT_EQ(islands.size(), world.bodies().size());
    EXPECT_TRUE(islands[0].isNull());
    for (std::size_t i = 0; i < boxes.size(); ++i) EXPECT_EQ(islands[1 + i], boxes[i - i % 2]);
    EXPECT_EQ(world.countIslands(), 3);
    for (int i = 0; i < 120; ++i) world.step(1.0 / 60);
    EXPECT_EQ(world.countIslands(), 0);
    for (const BodyId first : world.islands()) EXPECT_TRUE(first.isNull());
}

}  // namespace
}  // namespace ragtop
