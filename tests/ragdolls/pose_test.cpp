#include "ragtop/pose.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <stdexcept>
#include <utility>
#include <vector>

#include "human.h"

namespace ragtop {
namespace {

const Skeleton& humanBones() {
    static const Skeleton skeleton = HumanRig().skeleton;
    return skeleton;
}

class Numbers {
public:
    explicit Numbers(unsigned seed) : random_(seed) {}
    float next() { return static_cast<float>(random_()) / 2147483648.0f - 1.0f; }
    Quat turn(float most) { return rotationAbout({next(), next(), next()}, most * next()); }

private:
    std::mt19937 random_;
};

/// Every bone turned by up to `most` rad and stretched a little.
LocalPose anyPose(unsigned seed, float most = 1.5f) {
    Numbers numbers(seed);
    LocalPose pose = restPose(humanBones(), {{3, 2, 1}, numbers.turn(3)});
    for (Frame& bone : pose.bones) {
        bone.rotation = normalized(bone.rotation * numbers.turn(most));
        bone.position += 0.01f * Vec3{numbers.next(), numbers.next(), numbers.next()};
    }
    return pose;
}

/// Largest distance of two world poses, m and rad alike.
float apart(const std::vector<Pose>& a, const std::vector<Pose>& b) {
    float most = 0;
    for (std::size_t i = 0; i < a.size(); ++i)
        most = std::max(
            {most, length(relative(a[i].position, b[i].position)), angleBetween(a[i].rotation, b[i].rotation)});
    return most;
}
float apart(const LocalPose& a, const LocalPose& b) {
    return apart(writePose(humanBones(), a), writePose(humanBones(), b));
}

/// Unit quaternions of single precision hold 1e-7; a chain of ten of them, and an angle from them, some times that.
constexpr float kRounding = 5e-6f;

TEST(Pose, WhatIsWrittenIsRead) {
    for (unsigned seed = 1; seed <= 20; ++seed) {
        const LocalPose pose = anyPose(seed);
        EXPECT_LT(apart(pose, readPose(humanBones(), writePose(humanBones(), pose))), kRounding);
    }
    std::vector<Pose> rest;
    for (const Bone& bone : humanBones().bones) rest.push_back(Pose{{1, 2, 3}, {}} * bone.bind);
    EXPECT_LT(apart(rest, writePose(humanBones(), restPose(humanBones(), {{1, 2, 3}, {}}))), kRounding);
}

TEST(Pose, ABlendGoesFromOneToTheOtherByTheShortWay) {
    const LocalPose a = anyPose(1), b = anyPose(2);
    EXPECT_LT(apart(blend(a, b, 0), a), kRounding);
    EXPECT_LT(apart(blend(a, b, 1), b), kRounding);
    const LocalPose quarter = blend(a, b, 0.25f);
    for (std::size_t i = 1; i < a.bones.size(); ++i) {
        const float way = angleBetween(a.bones[i].rotation, b.bones[i].rotation);
        EXPECT_NEAR(angleBetween(a.bones[i].rotation, quarter.bones[i].rotation), 0.25f * way, kRounding);
        EXPECT_NEAR(angleBetween(quarter.bones[i].rotation, b.bones[i].rotation), 0.75f * way, kRounding);
    }
    // The other cover of the same turn is the same pose.
    LocalPose covered = b;
    for (Frame& bone : covered.bones)
        bone.rotation = {-bone.rotation.x, -bone.rotation.y, -bone.rotation.z, -bone.rotation.w};
    EXPECT_LT(apart(blend(a, covered, 0.25f), quarter), kRounding);
}

TEST(Pose, ABlendOfSomeBonesLeavesTheOthers) {
    const LocalPose a = anyPose(1), b = anyPose(2);
    std::vector<float> shares(a.bones.size(), 0.0f);
    shares[5] = 1;
    const LocalPose mixed = blend(a, b, shares);
    for (std::size_t i = 1; i < shares.size(); ++i) EXPECT_EQ(mixed.bones[i], (i == 5 ? b : a).bones[i]);
    EXPECT_EQ(mixed.root, a.root);
}

TEST(Pose, AddingADifferenceUndoesSubtracting) {
    for (unsigned seed = 1; seed <= 20; ++seed) {
        const LocalPose pose = anyPose(seed), base = anyPose(seed + 100);
        const PoseDifference difference = subtract(pose, base);
        EXPECT_LT(apart(add(base, difference), pose), kRounding);
        EXPECT_LT(apart(add(base, difference, 0), base), kRounding);
        EXPECT_LT(apart(add(pose, subtract(pose, pose)), pose), kRounding);
    }
}

TEST(Pose, AGestureOfOneBoneIsTheSameOnAnyBase) {
    LocalPose waving = restPose(humanBones());
    const Quat wave = rotationAbout({0, 0, 1}, 0.5f);
    waving.bones[8].rotation = waving.bones[8].rotation * wave;
    const LocalPose base = anyPose(3), both = add(base, subtract(waving, restPose(humanBones())));
    for (std::size_t i = 1; i < base.bones.size(); ++i) {
        const Quat expected = i == 8 ? normalized(base.bones[i].rotation * wave) : base.bones[i].rotation;
        EXPECT_LT(angleBetween(both.bones[i].rotation, expected), kRounding);
    }
}

TEST(Pose, AMirrorSwapsTheSidesAndTwiceIsNone) {
    const HumanRig rig;
    const PoseMirror mirror(humanBones());
    EXPECT_EQ(mirror.twin(rig.head), rig.head);
    for (const auto& pair : {rig.hand, rig.foot, rig.upperArm, rig.toe}) {
        EXPECT_EQ(mirror.twin(pair[0]), pair[1]);
        EXPECT_EQ(mirror.twin(pair[1]), pair[0]);
    }
    const Pose placement{{10, 0, -5}, rotationAbout({0, 1, 0}, 0.8f)};
    for (unsigned seed = 1; seed <= 20; ++seed) {
        const LocalPose pose = anyPose(seed);
        EXPECT_LT(apart(mirror(mirror(pose, placement), placement), pose), 2 * kRounding);
    }
    EXPECT_LT(apart(mirror(restPose(humanBones())), restPose(humanBones())), kRounding);
}

/// On a symmetric body every bone is where the reflection of its twin is.
TEST(Pose, AMirroredPoseIsTheReflectionInTheWorld) {
    for (const Quat& turned : {Quat{}, rotationAbout({1, 2, 3}, 1.0f)}) {
        HumanRig rig;
        rig.transform(turned, 1);
        const Vec3 left = rotate(turned, {1, 0, 0});
        const PoseMirror mirror(rig.skeleton, left);
        LocalPose pose = restPose(rig.skeleton);
        Numbers numbers(7);
        for (Frame& bone : pose.bones) bone.rotation = normalized(bone.rotation * numbers.turn(1));
        const auto world = writePose(rig.skeleton, pose), mirrored = writePose(rig.skeleton, mirror(pose));
        for (std::size_t i = 0; i < world.size(); ++i) {
            const Vec3 at = toVec3(world[i].position);
            const auto other = static_cast<std::size_t>(mirror.twin(static_cast<int>(i)));
            EXPECT_LT(length(toVec3(mirrored[other].position) - (at - 2 * dot(at, left) * left)), 2 * kRounding) << i;
        }
    }
}

TEST(Pose, ADefinitionKnowsItsSkeleton) {
    const Skeleton skeleton = skeletonOf(makeRagdoll(humanBones()));
    EXPECT_EQ(whyInvalid(skeleton), "");
    for (std::size_t i = 0; i < skeleton.bones.size(); ++i) {
        EXPECT_EQ(skeleton.bones[i].name, humanBones().bones[i].name);
        EXPECT_EQ(skeleton.bones[i].parent, humanBones().bones[i].parent);
        EXPECT_LT(length(skeleton.bones[i].bind.position - humanBones().bones[i].bind.position), 1e-6f);
    }
}

TEST(Pose, AnotherNumberOfBonesIsRefused) {
    const LocalPose pose = anyPose(1);
    LocalPose shorter = pose;
    shorter.bones.pop_back();
    std::vector<Pose> world(humanBones().bones.size() - 1);
    EXPECT_THROW(readPose(humanBones(), world), std::invalid_argument);
    EXPECT_THROW(writePose(humanBones(), pose, world), std::invalid_argument);
    EXPECT_THROW(blend(pose, shorter, 0.5f), std::invalid_argument);
    EXPECT_THROW(subtract(pose, shorter), std::invalid_argument);
    EXPECT_THROW(PoseMirror{humanBones()}(shorter), std::invalid_argument);
    EXPECT_THROW(PoseMirror{Skeleton{}}, std::invalid_argument);
}

}  // namespace
}  // namespace ragtop
