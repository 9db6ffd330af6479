#include "ragtop/part_modes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

#include "human.h"
#include "ragtop/pose.h"
#include "ragtop/world.h"

namespace ragtop {
namespace {

constexpr PartState kLed{.mode = PartMode::kinematic}, kLimp{.mode = PartMode::limp}, kPowered{};

/// Of a walk at 1.2 m/s, in the air: legs swing, arms are held out with bent elbows.
std::vector<Pose> walking(double time) {
    const auto swing = static_cast<float>(std::sin(2 * 3.14159265 * 0.9 * time));
    LocalPose pose = restPose(humanRig().skeleton, {{0, 2, 1.2 * time}, {}});
    for (int side = 0; side < 2; ++side) {
        const float s = side == 0 ? swing : -swing, out = side == 0 ? 1.0f : -1.0f;
        bend(pose, humanRig().thigh[side], {1, 0, 0}, -0.2f - 0.3f * s);
        bend(pose, humanRig().shank[side], {1, 0, 0}, 0.5f + 0.2f * s);
        bend(pose, humanRig().upperArm[side], {0, 0, 1}, -0.3f * out);
        bend(pose, humanRig().forearm[side], {0, 1, 0}, -out * (0.6f + 0.2f * s));
    }
    return writePose(humanRig().skeleton, pose);
}

struct Walker {
    World world{WorldSettings{.sleeping = false}};
    Ragdoll body;
    Muscles muscles;
    PartModes modes;
    double time = 0;
    std::vector<Pose> before{16}, after{16};
    std::vector<Vec3> velocity{16}, spin{16};
    float shift = 0, turn = 0;  ///< m and rad, the most that a part moved beside its velocity in a step

    Walker() : body(world, human(), walking(-kDt), walking(0), kDt), muscles(world, body), modes(world, body, muscles) {
        modes.setBranch(0, kLed, 0);
    }
    void run(double seconds) {
        for (int i = 0; i < std::lround(seconds / kDt); ++i) step();
    }
    void step() {
        body.partPoses(before);
        for (std::size_t i = 0; i < 16; ++i) {
            velocity[i] = world.velocityAt(body.bodies()[i], before[i].position);
            spin[i] = world.angularVelocity(body.bodies()[i]);
        }
        modes.follow(walking(time += kDt), kDt);
        muscles.step(kDt);
        world.step(kDt);
        EXPECT_EQ(world.validate(), "");
        body.partPoses(after);
        const auto dt = static_cast<float>(kDt);
        for (std::size_t i = 0; i < 16; ++i) {
            shift = std::max(shift, length(relative(after[i].position, before[i].position) - dt * velocity[i]));
            const Quat expected = rotationAbout(spin[i], dt * length(spin[i])) * before[i].rotation;
            turn = std::max(turn, length(rotationVector(after[i].rotation * conjugate(expected))));
        }
        for (const JointId joint : body.joints()) gap = std::max(gap, world.state(joint).gap);
    }
    float gap = 0;  ///< m, the most that a joint was open
    float farthest(int root) const {
        const std::vector<Pose> wanted = walking(time);
        float most = 0;
        for (std::size_t i = 0; i < human().parts.size(); ++i) {
            int at = static_cast<int>(i);
            while (at > 0 && at != root) at = parentOf(at);
            if (at != root) continue;
            const Pose& goal = wanted[static_cast<std::size_t>(human().parts[i].bone)];
            most = std::max(most, length(relative(world.pose(body.bodies()[i]).position, goal.position)));
        }
        return most;
    }
    static int parentOf(int part) {
        for (const RagdollJoint& joint : human().joints)
            if (joint.child == part) return joint.parent;
        return -1;
    }
};

TEST(PartModes, KinematicPartsAreWhereTheAnimationHasThem) {
    Walker walker;
    for (int i = 0; i < 90; ++i) {
        walker.step();
        EXPECT_LT(walker.farthest(0), 1e-4f);
    }
}

/// The arm of a body that walks hangs down under its own weight, whole, and moves nothing else.
TEST(PartModes, AnArmHangsLimpOnABodyThatWalks) {
    Walker walker;
    walker.run(0.5);
    const int arm = partOf(humanRig().upperArm[0]), hand = partOf(humanRig().hand[0]);
    walker.modes.setBranch(arm, kLimp);
    walker.run(4);
    const Pose upper = walker.world.pose(walker.body.bodies()[static_cast<std::size_t>(arm)]);
    const Pose end = walker.world.pose(walker.body.bodies()[static_cast<std::size_t>(hand)]);
    const Vec3 way = relative(end.position, upper.position);
    EXPECT_LT(way.y, -0.8f * length(way));
    EXPECT_LT(walker.gap, 2e-3f);
    EXPECT_LT(walker.farthest(partOf(humanRig().thigh[0])), 1e-4f);
    EXPECT_LT(walker.farthest(partOf(humanRig().upperArm[1])), 1e-4f);
}

/// In the step in which parts go over no part moves by more than a centimetre or two degrees beside its velocity, and
/// what comes back to the animation is with it in time.
TEST(PartModes, NoChangeIsAJump) {
    Walker walker;
    walker.run(0.5);
    const int arm = partOf(humanRig().upperArm[0]), leg = partOf(humanRig().thigh[1]), chest = partOf(humanRig().chest);
    const PartState states[] = {kLimp, kLed, kPowered, kLed, kLimp, kPowered, kLed};
    for (const int root : {arm, leg, chest})
        for (const PartState& state : states) {
            walker.shift = walker.turn = 0;
            walker.modes.setBranch(root, state, 0.3f);
            walker.step();
            EXPECT_LT(walker.shift, 0.01f) << root << ' ' << nameOf(state.mode);
            EXPECT_LT(walker.turn, 2 * kDegree) << root << ' ' << nameOf(state.mode);
            walker.run(3);
            if (state.mode == PartMode::kinematic) {
                EXPECT_LT(walker.farthest(root), 1e-4f);
            }
        }
    EXPECT_LT(walker.farthest(0), 1e-4f);
    EXPECT_LT(walker.gap, 2e-3f);
}

/// What the animation lets go has its velocity: the centre of mass of a body that is thrown goes on as the walk had it.
TEST(PartModes, WhatIsLetGoKeepsItsMomentum) {
    Walker walker;
    walker.run(0.5);
    const auto momentum = [&] {
        Vec3 sum;
        for (const BodyId part : walker.body.bodies())
            sum += walker.world.mass(part).mass * walker.world.linearVelocity(part);
        return sum;
    };
    const Vec3 before = momentum();
    walker.modes.setBranch(0, kLimp, 0.2f);
    EXPECT_LT(length(momentum() - before), 1e-5f * length(before));
    for (int i = 1; i <= 12; ++i) {
        walker.step();
        const Vec3 fallen = before + Vec3{0, -75 * 9.81f * static_cast<float>(i) / 60, 0};
        EXPECT_LT(length(momentum() - fallen), 1e-4f * length(before) * static_cast<float>(i));
    }
}

/// A powered arm takes the pose of the animation by its muscles.
TEST(PartModes, APoweredArmFollows) {
    Walker walker;
    const int arm = partOf(humanRig().upperArm[0]);
    walker.modes.setBranch(arm, kPowered, 0);
    walker.run(2);
    for (std::size_t j = 0; j < human().joints.size(); ++j)
        if (human().joints[j].child == arm) {
            EXPECT_LT(walker.muscles.error(static_cast<int>(j)), 10 * kDegree);
        }
    EXPECT_LT(walker.gap, 2e-3f);
}

TEST(PartModes, SharesOfTheDrawnPoseAreEased) {
    Walker walker;
    const int arm = partOf(humanRig().upperArm[0]);
    walker.modes.set(arm, {.mode = PartMode::kinematic, .physics = 0}, 0.5f);
    float before = 1;
    for (int i = 0; i < 30; ++i) {
        walker.step();
        const float now = walker.modes.shares()[static_cast<std::size_t>(humanRig().upperArm[0])];
        EXPECT_NEAR(before - now, 1.0f / 30, 1e-3f);
        before = now;
    }
    EXPECT_NEAR(before, 0, 1e-5f);
    EXPECT_EQ(walker.modes.shares()[static_cast<std::size_t>(humanRig().thigh[0])], 1);
}

TEST(PartModes, WrongCallsAreToldAndChangeNothing) {
    Walker walker;
    const auto told = [&](auto&& call) {
        try {
            call();
        } catch (const std::exception& wrong) {
            return std::string(wrong.what());
        }
        return std::string();
    };
    EXPECT_NE(told([&] { walker.modes.set(0, {.strength = 2}); }).find("strength is 2"), std::string::npos);
    EXPECT_NE(told([&] { walker.modes.set(0, {.physics = std::nanf("")}); }).find("physics"), std::string::npos);
    EXPECT_NE(told([&] { walker.modes.set(0, {.mode = static_cast<PartMode>(9)}); }).find("mode is 9"),
              std::string::npos);
    EXPECT_NE(told([&] { walker.modes.set(0, kLimp, -1); }).find("seconds"), std::string::npos);
    EXPECT_THROW(walker.modes.set(16, kLimp), std::out_of_range);
    EXPECT_THROW(walker.modes.set(-1, kLimp), std::out_of_range);
    std::vector<Pose> bones = walking(0);
    EXPECT_NE(told([&] { walker.modes.follow(bones, 0); }).find("dt is"), std::string::npos);
    bones[3].position.y = std::numeric_limits<double>::infinity();
    EXPECT_NE(told([&] { walker.modes.follow(bones, kDt); }).find("bone 3"), std::string::npos);
    bones.pop_back();
    bones[3] = {};
    EXPECT_NE(told([&] { walker.modes.follow(bones, kDt); }).find("poses of bones"), std::string::npos);
    EXPECT_EQ(walker.modes.state(0).mode, PartMode::kinematic);
    walker.run(0.1);
    EXPECT_LT(walker.farthest(0), 1e-4f);
}

}  // namespace
}  // namespace ragtop
