#include "ragtop/ragdoll.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <stdexcept>
#include <utility>

#include "human.h"
#include "ragtop/world.h"

namespace ragtop {
namespace {

TEST(Ragdoll, SpawnsWhereItsBonesRest) {
    World world;
    const Pose placement{{100, 5, -3}, rotationAbout({0, 1, 0}, 0.7f)};
    const HumanRig rig;
    const Ragdoll ragdoll(world, human(), placement, {1, 2, 3});
    EXPECT_EQ(ragdoll.bodies().size(), 16u);
    EXPECT_EQ(ragdoll.joints().size(), 15u);
    const auto poses = ragdoll.pose();
    ASSERT_EQ(poses.size(), rig.skeleton.bones.size());
    for (std::size_t i = 0; i < poses.size(); ++i) {
        const Pose expected = placement * rig.skeleton.bones[i].bind;
        EXPECT_LT(length(relative(poses[i].position, expected.position)), 1e-5f);
    }
    float mass = 0;
    for (const BodyId body : ragdoll.bodies()) {
        mass += world.mass(body).mass;
        EXPECT_EQ(world.linearVelocity(body), (Vec3{1, 2, 3}));
    }
    EXPECT_NEAR(mass, 75.0f, 75e-4f);
    EXPECT_EQ(ragdoll.body("b0"), ragdoll.bodies()[0]);
    EXPECT_TRUE(ragdoll.body("nobody").isNull());
}

TEST(Ragdoll, GainsNoEnergyBySpawning) {
    World world(WorldSettings{.gravity = {0, 0, 0}, .sleeping = false});
    const Ragdoll ragdoll(world, human());
    for (const JointId joint : ragdoll.joints()) EXPECT_GE(world.state(joint).limitMargin, -1e-4f);
    for (int i = 0; i < 10; ++i) world.step(1.0 / 60);
    for (const BodyId body : ragdoll.bodies()) {
        // At rest, nothing pushes; rounding of unit quaternions leaves 1e-7 rad per 1/240 s at most.
        EXPECT_LT(length(world.linearVelocity(body)), 1e-3f);
        EXPECT_LT(length(world.angularVelocity(body)), 1e-3f);
    }
}

TEST(Ragdoll, StaysTogetherInAFall) {
    World world;
    world.create(StaticBody{.shape = Box{{50, 1, 50}}, .position = {0, -1, 0}});
    const Ragdoll ragdoll(world, human(), {{0, 1, 0}, rotationAbout({1, 0, 0.3f}, 0.6f)});
    float peak = 0;
    for (int i = 0; i < 600; ++i) {
        world.step(1.0 / 60);
        for (const JointId joint : ragdoll.joints()) peak = std::max(peak, world.state(joint).gap);
    }
    RecordProperty("peak_gap_mm", std::to_string(1000 * peak));
    // Joints are springs of a quarter of the substep rate, 60 Hz: under their own weight they sag g/ω² = 0.07 mm, and
    // at most by the body's mass over that of the lightest part, a hand's 1/164, times as much.
    for (const JointId joint : ragdoll.joints()) EXPECT_LT(world.state(joint).gap, 0.0115f);
    for (const BodyId body : ragdoll.bodies()) {
        const double height = world.centerOfMass(body).y;
        EXPECT_GT(height, 0.0);
        EXPECT_LT(height, 0.6);
    }
}

TEST(Ragdoll, SleepsWithinFiveSecondsOfADrop) {
    int asleep = 0;
    for (int seed = 1; seed <= 100; ++seed) {
        World world;
        world.create(StaticBody{.shape = Box{{50, 1, 50}}, .position = {0, -1, 0}});
        // Any way round, the middle of the body 1 m above where it can touch the ground.
        std::mt19937 random(static_cast<unsigned>(seed));
        const auto number = [&] { return static_cast<float>(random()) / 2147483648.0f - 1.0f; };
        const Quat turn = normalized(Quat{number(), number(), number(), number()});
        const Vec3 middle = rotate(turn, {0, 0.9f, 0});
        const Ragdoll ragdoll(world, human(), {DVec3{0, 1.9, 0} - middle, turn});
        for (int i = 0; i < 300; ++i) world.step(1.0 / 60);
        asleep += std::none_of(ragdoll.bodies().begin(), ragdoll.bodies().end(),
                               [&](BodyId body) { return world.isAwake(body); });
    }
    EXPECT_GE(asleep, 95);
}

TEST(Ragdoll, FallsLikeAStone) {
    World world;
    const Ragdoll ragdoll(world, human(), {{0, 100, 0}, {}});
    DVec3 start, center, momentum;
    double mass = 0;
    const auto measure = [&] {
        center = momentum = {};
        mass = 0;
        for (const BodyId body : ragdoll.bodies()) {
            const double m = static_cast<double>(world.mass(body).mass);
            center = center + m * world.centerOfMass(body);
            momentum = momentum + m * DVec3(world.linearVelocity(body));
            mass += m;
        }
        center = (1 / mass) * center;
    };
    measure();
    start = center;
    for (int i = 0; i < 60; ++i) world.step(1.0 / 60);
    measure();
    // Forces within the body cannot change its momentum; 240 substeps round velocities of 10 m/s to 1e-6 each.
    const double rounding = 240 * 1e-6;
    EXPECT_NEAR(momentum.y / mass, -9.81, rounding);
    EXPECT_NEAR(momentum.x / mass, 0, rounding);
    EXPECT_NEAR(momentum.z / mass, 0, rounding);
    // Substeps of h are at most first order in the path: g t h / 2 off g t² / 2.
    EXPECT_NEAR(start.y - center.y, 0.5 * 9.81, 0.5 * 9.81 / 240 + rounding);
    EXPECT_NEAR(start.x - center.x, 0, rounding);
    EXPECT_NEAR(start.z - center.z, 0, rounding);
}

TEST(Ragdoll, LeavesNothingBehind) {
    World world;
    world.create(StaticBody{.shape = Box{{50, 1, 50}}, .position = {0, -1, 0}});
    {
        Ragdoll first(world, human());
        Ragdoll second(std::move(first));
        EXPECT_EQ(world.bodies().size(), 17u);
        first = Ragdoll(world, human(), {{5, 0, 0}, {}});
        EXPECT_EQ(world.bodies().size(), 33u);
        second = std::move(first);
        EXPECT_EQ(world.bodies().size(), 17u);
        world.destroy(second.bodies()[3]);
    }
    EXPECT_EQ(world.bodies().size(), 1u);
    EXPECT_EQ(world.joints().size(), 0u);
}

TEST(Ragdoll, TwoOfOneKindCollideWithEachOther) {
    World world(WorldSettings{.gravity = {0, 0, 0}});
    const Ragdoll standing(world, human());
    const Ragdoll flying(world, human(), {{0, 0, -1}, {}}, {0, 0, 4});
    for (int i = 0; i < 60; ++i) world.step(1.0 / 60);
    float speed = 0;
    for (const BodyId body : standing.bodies()) speed += world.mass(body).mass * world.linearVelocity(body).z / 75.0f;
    EXPECT_GT(speed, 0.5f);
}

TEST(Ragdoll, TakesThePoseOfAnAnimation) {
    World world;
    std::vector<Pose> bones;
    for (const Bone& bone : HumanRig().skeleton.bones) bones.push_back(Pose{{0, 2, 0}, {}} * bone.bind);
    const Ragdoll ragdoll(world, human(), bones);
    EXPECT_LT(length(relative(ragdoll.pose(4).position, bones[4].position)), 1e-5f);
    bones.pop_back();
    EXPECT_THROW(Ragdoll(world, human(), bones), std::invalid_argument);
}

TEST(Ragdoll, RefusesABadDefinitionAndLeavesTheWorldAlone) {
    World world;
    RagdollDef def = human();
    def.parts[5].mass = -1;
    EXPECT_THROW(Ragdoll(world, def), std::invalid_argument);
    EXPECT_EQ(world.bodies().size(), 0u);
}

}  // namespace
}  // namespace ragtop
