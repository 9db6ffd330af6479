#include "ragtop/muscles.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <vector>

#include "human.h"
#include "ragtop/pose.h"
#include "ragtop/world.h"

namespace ragtop {
namespace {

/// Of a march on the spot: legs and arms swing, elbows and knees bend.
std::vector<Pose> marching(double time) {
    const float swing = std::sin(2 * kPi * 0.8f * static_cast<float>(time));
    LocalPose pose = restPose(humanRig().skeleton, {{0, 2, 0}, {}});
    for (int side = 0; side < 2; ++side) {
        const float s = side == 0 ? swing : -swing, out = side == 0 ? 1.0f : -1.0f;
        bend(pose, humanRig().thigh[side], {1, 0, 0}, -0.4f - 0.4f * s);
        bend(pose, humanRig().shank[side], {1, 0, 0}, 0.6f + 0.3f * s);
        bend(pose, humanRig().upperArm[side], {0, 0, 1}, -1.0f * out);
        bend(pose, humanRig().forearm[side], {0, 1, 0}, -out * (0.8f + 0.3f * s));
    }
    return writePose(humanRig().skeleton, pose);
}

/// Hung up by its pelvis, as a puppet.
struct Held {
    World world{WorldSettings{.sleeping = false}};
    Ragdoll body;
    Muscles muscles;

    explicit Held(const MuscleProfile& profile = {.friction = 0})
        : body(world, human(), marching(0)), muscles(world, body, profile) {
        const BodyId pelvis = body.bodies()[0];
        world.create(FixedDef{.bodies = {.b = pelvis, .frameA = {toVec3(world.pose(pelvis).position), {}}}});
    }
    void run(double seconds) {
        for (int i = 0; i < std::lround(60 * seconds); ++i) {
            muscles.step(1.0 / 60);
            world.step(1.0 / 60);
        }
    }
    /// rad, that any part turns by in a step.
    float turning() {
        std::vector<Pose> before(16), after(16);
        body.partPoses(before);
        run(1.0 / 60);
        body.partPoses(after);
        float most = 0;
        for (std::size_t i = 0; i < after.size(); ++i)
            most = std::max(most, length(rotationVector(conjugate(before[i].rotation) * after[i].rotation)));
        return most;
    }
};

int jointOf(BodyRole role, BodySide side) {
    for (std::size_t i = 0; i < human().joints.size(); ++i) {
        const RagdollPart& part = human().parts[static_cast<std::size_t>(human().joints[i].child)];
        if (part.role == role && part.side == side) return static_cast<int>(i);
    }
    return -1;
}

TEST(Muscles, HoldAPoseAgainstTheWeight) {
    Held held;
    held.run(2);
    EXPECT_LT(held.muscles.error(), 1 * kDegree);
    held.muscles.follow(marching(0.3));
    held.run(3);
    EXPECT_LT(held.muscles.error(), 1 * kDegree);
    EXPECT_LT(held.turning(), 0.01f / 60);
}

/// Dry friction holds joints short of their targets by its share of the springs' torque.
TEST(Muscles, HoldAPoseInStiffJoints) {
    Held held(MuscleProfile{.friction = 1});
    held.run(0.5);
    EXPECT_LT(held.muscles.error(), 1 * kDegree);
    held.muscles.follow(marching(0.3));
    held.run(1.5);
    RecordProperty("stiff_degrees", std::to_string(held.muscles.error() / kDegree));
    EXPECT_LT(held.muscles.error(), 3 * kDegree);
}

TEST(Muscles, FollowAMarch) {
    Held held;
    float sum = 0;
    int count = 0;
    for (int i = 0; i < 180; ++i) {
        held.muscles.follow(marching((i + 1) / 60.0), 1.0 / 60);
        held.muscles.step(1.0 / 60);
        held.world.step(1.0 / 60);
        if (i < 60) continue;
        sum += held.muscles.error() * held.muscles.error();
        ++count;
    }
    const float rms = std::sqrt(sum / static_cast<float>(count));
    RecordProperty("rms_degrees", std::to_string(rms / kDegree));
    EXPECT_LT(rms, 3 * kDegree);
}

/// Springs alone are bent by τ/k.
TEST(Muscles, BearTheWeightBeforeTheyAreBent) {
    Held without({.friction = 0, .weight = 0}), with;
    without.run(2);
    with.run(2);
    EXPECT_GT(without.muscles.error(), 3 * with.muscles.error());
}

TEST(Muscles, AnInjuredArmHangsAndTheOthersHold) {
    Held held;
    held.run(1);
    const int shoulder = jointOf(BodyRole::upperArm, BodySide::left),
              other = jointOf(BodyRole::upperArm, BodySide::right);
    ASSERT_GE(shoulder, 0);
    const float before = held.muscles.error(shoulder);
    held.muscles.setStrength(shoulder, 0.02f);
    held.run(2);
    EXPECT_NEAR(held.muscles.bound(shoulder), 0.02f * strengthOf(BodyRole::upperArm, 75), 1e-3f);
    EXPECT_GT(held.muscles.error(shoulder), 10 * before + 0.1f);
    EXPECT_LT(held.muscles.error(other), 1 * kDegree);
    held.muscles.setStrength(shoulder, 1, 0.5f);
    held.run(2);
    EXPECT_LT(held.muscles.error(shoulder), 1 * kDegree);
}

/// Let go and caught again, no part turns faster than one that falls.
TEST(Muscles, AChangeOfStrengthIsNoJump) {
    Held held;
    held.run(1);
    held.muscles.setProfile({.frequency = 1, .strength = 0, .friction = 0, .weight = 0}, 0.3f);
    float jump = 0;
    for (int i = 0; i < 180; ++i) {
        if (i == 30) held.muscles.setProfile({.friction = 0}, 0.5f);
        jump = std::max(jump, held.turning());
    }
    // √(2 g h)/r: a hand that falls by the length of its arm, 0.75 m, about the elbow, 0.25 m.
    EXPECT_LT(jump, 15.3f / 60);
    EXPECT_LT(held.muscles.error(), 1 * kDegree);
}

/// What takes over within T moves the target by the smoothest step, whose speed is at most 1.5 of the way over T.
TEST(Muscles, ACrossfadeIsNoJump) {
    Held abrupt, eased;
    for (Held* held : {&abrupt, &eased}) {
        held->run(1);
        held->muscles.follow(marching(0.3));
    }
    const int hip = jointOf(BodyRole::thigh, BodySide::left);
    const float way = eased.muscles.error(hip);
    ASSERT_GT(way, 0.3f);
    eased.muscles.crossfade(0.5f);
    const float jump = abrupt.turning();
    float fastest = 0;
    EXPECT_LT(eased.turning(), 0.1f * jump);
    for (int i = 0; i < 40; ++i) {
        const float before = eased.muscles.error(hip);
        eased.run(1.0 / 60);
        fastest = std::max(fastest, std::abs(eased.muscles.error(hip) - before) * 60);
    }
    EXPECT_LT(fastest, 1.2f * 1.5f * way / 0.5f);
    eased.run(1);
    EXPECT_LT(eased.muscles.error(), 1 * kDegree);
    EXPECT_THROW(eased.muscles.crossfade(-1), std::invalid_argument);
}

/// Knees that cannot hold their shanks push as hard as they may where each step begins. What slips within a step is
/// damped beyond that, by less the slower it begins to: after the first steps the mean over one is within the bound.
/// How far it will slip is known only of what hangs free: a foot on the ground is held by more than its own inertia.
TEST(Muscles, TheBoundOfTheTorqueIsKept) {
    Held held({.strength = 0.005f});
    const auto joint = static_cast<std::size_t>(jointOf(BodyRole::shank, BodySide::left));
    const float bound = 0.005f * strengthOf(BodyRole::shank, 75);
    EXPECT_NEAR(held.muscles.bound(static_cast<int>(joint)), bound, 1e-6f);
    float most = 0;
    for (int i = 0; i < 30; ++i) {
        held.run(1.0 / 60);
        const JointState state = held.world.state(held.body.joints()[joint]);
        if (state.limitMargin < 0.05f) break;
        const Frame& frame = std::get<HingeDef>(human().joints[joint].joint).bodies.frameB;
        const Quat axes =
            held.world.pose(held.body.bodies()[static_cast<std::size_t>(human().joints[joint].child)]).rotation;
        const float began = length(held.muscles.torque(static_cast<int>(joint)));
        const float ended = std::abs(dot(state.torque, rotate(axes * frame.rotation, {1, 0, 0})));
        EXPECT_LT(began, 1.001f * bound);
        most = std::max(most, began);
        EXPECT_TRUE(i < 4 || 0.5f * (began + ended) < 1.05f * bound) << i;
    }
    EXPECT_NEAR(most, bound, 0.01f * bound);
}

TEST(Muscles, TheLimpAreAsDefinedAndSoAreThoseLetGo) {
    Held held(muscleProfile("limp"));
    held.run(1.0 / 60);
    for (std::size_t i = 0; i < held.body.joints().size(); ++i)
        if (const auto* ball = std::get_if<BallDef>(&held.world.def(held.body.joints()[i]))) {
            EXPECT_FALSE(ball->spring);
            EXPECT_EQ(ball->friction, std::get<BallDef>(human().joints[i].joint).friction);
        }
    World world;
    Ragdoll body(world, human());
    {
        Muscles muscles(world, body);
        muscles.step(1.0 / 60);
        EXPECT_TRUE(std::get<BallDef>(world.def(body.joints()[0])).spring);
    }
    EXPECT_FALSE(std::get<BallDef>(world.def(body.joints()[0])).spring);
}

/// Muscles act between parts: a body in flight keeps its momentum and its path.
TEST(Muscles, GiveNoMomentum) {
    World world(WorldSettings{.gravity = {0, 0, 0}, .sleeping = false});
    Ragdoll body(world, human(), marching(0));
    Muscles muscles(world, body);
    for (int i = 0; i < 120; ++i) {
        muscles.follow(marching(i / 60.0), 1.0 / 60);
        muscles.step(1.0 / 60);
        world.step(1.0 / 60);
    }
    Vec3 momentum;
    float moving = 0;
    for (const BodyId part : body.bodies()) {
        momentum += world.mass(part).mass * world.linearVelocity(part);
        moving += world.mass(part).mass * length(world.linearVelocity(part));
    }
    EXPECT_GT(moving, 5.0f);
    EXPECT_LT(length(momentum), 1e-5f * 480 * moving);
}

/// Frames a microsecond apart, and bodies of a whale's and a mouse's mass.
TEST(Muscles, StepThroughAnything) {
    for (const float mass : {1e-3f, 1e6f}) {
        World world;
        const RagdollDef def = makeRagdoll(humanRig().skeleton, {.bodyMass = mass});
        Ragdoll body(world, def, marching(0));
        Muscles muscles(world, body, {.frequency = 20, .strength = 100, .friction = 100});
        for (int i = 0; i < 60; ++i) {
            muscles.follow(marching(i % 2), i % 3 == 0 ? 1e-9 : 1.0 / 60);
            EXPECT_NO_THROW(muscles.step(1.0 / 60));
            world.step(1.0 / 60);
        }
        for (const BodyId part : body.bodies()) EXPECT_TRUE(isFinite(world.pose(part).position));
    }
}

TEST(Muscles, WhatIsWrongIsToldInOneLine) {
    EXPECT_EQ(whyInvalid(MuscleProfile{.frequency = 0}), "frequency is 0 Hz, must be in [0.1, 20]");
    EXPECT_EQ(whyInvalid(MuscleProfile{.weight = 2}), "weight is 2, must be in [0, 1]");
    for (const std::string_view name : muscleProfileNames()) EXPECT_EQ(whyInvalid(muscleProfile(name)), "") << name;
    try {
        muscleProfile("angry");
        FAIL();
    } catch (const std::invalid_argument& error) {
        EXPECT_STREQ(error.what(), "muscle profile is angry, must be one of limp, weak, relaxed, tense, rigid");
    }
    World world;
    Ragdoll body(world, human());
    EXPECT_THROW(Muscles(world, body, {.strength = -1}), std::invalid_argument);
    Muscles muscles(world, body);
    EXPECT_THROW(muscles.setProfile({.dampingRatio = -1}), std::invalid_argument);
    EXPECT_THROW(muscles.setStrength(0, 1.5f), std::invalid_argument);
    EXPECT_THROW(muscles.setStrength(0, 1, std::numeric_limits<float>::quiet_NaN()), std::invalid_argument);
    EXPECT_THROW(muscles.setStrength(99, 1), std::out_of_range);
    EXPECT_THROW(muscles.follow({}), std::invalid_argument);
    std::vector<Pose> pose = marching(0);
    pose[0].rotation = {0, 0, 0, 0};
    EXPECT_THROW(muscles.follow(pose), std::invalid_argument);
}

}  // namespace
}  // namespace ragtop
