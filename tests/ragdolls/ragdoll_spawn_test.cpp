#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <stdexcept>
#include <vector>

#include "human.h"
#include "ragtop/pose.h"
#include "ragtop/ragdoll.h"
#include "ragtop/world.h"

namespace ragtop {
namespace {

/// Walks and turns as a whole while it bends its left elbow and both hips.
std::vector<Pose> frameAt(double time) {
    const HumanRig rig;
    const auto t = static_cast<float>(time);
    LocalPose pose = restPose(rig.skeleton, {{3 * time, 1, 0}, rotationAbout({0, 1, 0}, 2 * t)});
    const auto bend = [&](int bone, const Vec3& axis, float angle) {
        Frame& frame = pose.bones[static_cast<std::size_t>(bone)];
        frame.rotation = normalized(frame.rotation * rotationAbout(axis, angle));
    };
    bend(rig.forearm[0], {0, -1, 0}, 0.5f + 4 * t);
    bend(rig.thigh[0], {-1, 0, 0}, 0.2f + 3 * t);
    bend(rig.thigh[1], {-1, 0, 0}, 0.5f - 3 * t);
    return writePose(rig.skeleton, pose);
}

TEST(RagdollSpawn, EachBoneMovesAndTurnsAsItDidInTheAnimation) {
    const HumanRig rig;
    World world(WorldSettings{.gravity = {0, 0, 0}});
    const double dt = 1.0 / 60;
    const std::vector<Pose> before = frameAt(-dt), now = frameAt(0);
    const Ragdoll ragdoll(world, human(), before, now, dt);
    for (std::size_t i = 0; i < human().parts.size(); ++i) {
        const auto bone = static_cast<std::size_t>(human().parts[i].bone);
        const Vec3 center = world.mass(ragdoll.bodies()[i]).center;
        const Vec3 moved = relative(transformPoint(now[bone], center), transformPoint(before[bone], center));
        // Single precision of places of 2 m over a frame: 2.4e-7 · 60 and some of it.
        EXPECT_LT(length(world.linearVelocity(ragdoll.bodies()[i]) - 60 * moved), 2e-4f) << i;
    }
    const auto bodyOf = [&](int bone) { return ragdoll.bodies()[static_cast<std::size_t>(partOf(bone))]; };
    const BodyId pelvis = bodyOf(rig.hips), forearm = bodyOf(rig.forearm[0]);
    EXPECT_LT(length(world.angularVelocity(pelvis) - Vec3{0, 2, 0}), 1e-3f);
    EXPECT_LT(length(world.angularVelocity(forearm) - Vec3{0, 2 - 4, 0}), 1e-3f);
}

/// After a frame in flight bones are where the animation would have had them, but for what accelerations make of it.
TEST(RagdollSpawn, GoesOnAsTheAnimationWouldHave) {
    World world(WorldSettings{.gravity = {0, 0, 0}});
    const double dt = 1.0 / 120;
    const Ragdoll ragdoll(world, human(), frameAt(-dt), frameAt(0), dt);
    world.step(dt);
    const std::vector<Pose> is = ragdoll.pose(), next = frameAt(dt);
    for (std::size_t i = 0; i < is.size(); ++i) {
        // Two frames of ω² r: (3 + 2)² · 1 m · dt².
        EXPECT_LT(length(relative(is[i].position, next[i].position)), 25 * dt * dt);
    }
}

TEST(RagdollSpawn, StretchedBonesAreClosedAndGiveNoEnergy) {
    const HumanRig rig;
    World world(WorldSettings{.gravity = {0, 0, 0}, .sleeping = false});
    LocalPose pose = restPose(rig.skeleton, {{0, 2, 0}, {}});
    pose.bones[static_cast<std::size_t>(rig.forearm[0])].position += Vec3{0.1f, 0.05f, 0};
    pose.bones[static_cast<std::size_t>(rig.shank[1])].position += Vec3{0, -0.1f, 0};
    const Ragdoll ragdoll(world, human(), writePose(rig.skeleton, pose));
    for (int i = 0; i < 30; ++i) world.step(1.0 / 60);
    for (const JointId joint : ragdoll.joints()) EXPECT_LT(world.state(joint).gap, 1e-5f);
    EXPECT_LT(world.energy(), 1e-6);
}

TEST(RagdollSpawn, APoseBeyondLimitsIsToldAndGainsNoEnergy) {
    const HumanRig rig;
    World world(WorldSettings{.gravity = {0, 0, 0}, .sleeping = false});
    LocalPose before = restPose(rig.skeleton, {{0, 2, 0}, {}}), now = before;
    const auto over = [&](LocalPose& pose, int bone, const Vec3& axis, float angle) {
        Frame& frame = pose.bones[static_cast<std::size_t>(bone)];
        frame.rotation = normalized(frame.rotation * rotationAbout(axis, angle));
    };
    // A knee 0.5 rad the wrong way, and a head turned to the back, both on their way there.
    over(before, rig.shank[0], {-1, 0, 0}, 0.48f);
    over(now, rig.shank[0], {-1, 0, 0}, 0.5f);
    over(before, rig.neck, {0, 1, 0}, 1.55f);
    over(now, rig.neck, {0, 1, 0}, 1.6f);
    const Ragdoll ragdoll(world, human(), writePose(rig.skeleton, before), writePose(rig.skeleton, now), 1.0 / 60);
    const std::vector<BeyondLimit> told = ragdoll.beyondLimits();
    ASSERT_EQ(told.size(), 2u);
    for (const BeyondLimit& each : told) {
        const RagdollPart& part =
            human().parts[static_cast<std::size_t>(human().joints[static_cast<std::size_t>(each.joint)].child)];
        EXPECT_TRUE(part.role == BodyRole::shank || part.role == BodyRole::head);
        // The knee is bent at rest, and hinges stop where they are straight; heads turn by 60°.
        const float bent = arcTan2(0.01f, 0.42f) + arcTan2(0.03f, 0.42f);
        EXPECT_NEAR(each.by, part.role == BodyRole::shank ? 0.5f - bent : 1.6f - kPi / 3, 1e-3f);
    }
    const double begun = world.energy();
    for (int i = 0; i < 300; ++i) {
        world.step(1.0 / 60);
        ASSERT_LT(world.energy(), begun * 1.001) << i;
    }
    EXPECT_TRUE(ragdoll.beyondLimits(0.01f).empty());
}

TEST(RagdollSpawn, FramesThatDoNotFitAreRefused) {
    World world;
    const std::vector<Pose> frame = frameAt(0);
    const std::vector<Pose> shorter(frame.begin(), frame.end() - 1);
    EXPECT_THROW(Ragdoll(world, human(), shorter, frame, 0.1), std::invalid_argument);
    EXPECT_THROW(Ragdoll(world, human(), frame, shorter, 0.1), std::invalid_argument);
    for (const double dt : {0.0, -1.0, std::numeric_limits<double>::quiet_NaN()})
        EXPECT_THROW(Ragdoll(world, human(), frame, frame, dt), std::invalid_argument);
    EXPECT_EQ(world.bodies().size(), 0u);
}

/// m, of the deepest contact.
float deepest(const World& world) {
    float depth = 0;
    world.forEachContact([&](const Contact& contact) {
        for (int i = 0; i < contact.pointCount; ++i) depth = std::max(depth, -contact.points[i].separation);
    });
    return depth;
}

/// Whoever is put into the ground comes out of it, limp, in any attitude: what overlaps is lifted, which nothing takes
/// back.
TEST(RagdollSpawn, ComesOutOfTheGroundThatItIsPutInto) {
    std::mt19937 random(21);
    const auto draw = [&](float from, float to) {
        return from + (to - from) * static_cast<float>(random() % 1000) / 999;
    };
    for (int figure = 0; figure < 40; ++figure) {
        World world;
        world.create(StaticBody{.shape = Box{{50, 5, 50}}, .position = {0, -5, 0}});
        const Quat turned = rotationAbout(normalized(Vec3{draw(-1, 1), draw(-1, 1), draw(0.1f, 1)}), draw(0, kPi));
        const Ragdoll ragdoll(world, human(), Pose{{0, 5, 0}, turned});
        double low = 1e9;
        for (const BodyId body : ragdoll.bodies())
            low = std::min(low, static_cast<double>(world.bounds(world.shapes(body)[0]).lower.y));
        const double down = low + static_cast<double>(draw(0.2f, 0.6f));
        for (const BodyId body : ragdoll.bodies()) {
            Pose pose = world.pose(body);
            pose.position.y -= down;
            world.setPose(body, pose);
        }
        for (int step = 0; step < 300; ++step) world.step(1.0 / 60);  // in which who falls is to lie still
        EXPECT_LT(deepest(world), 0.005f) << figure;                  // what loads press in
    }
}

}  // namespace
}  // namespace ragtop
