#include "ragtop/clip.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <stdexcept>

#include "core/heap_counter.h"
#include "human.h"

namespace ragtop {
namespace {

constexpr float kAngle = 2.0f;  ///< rad, that the arm of the clip turns about z

/// A second in which the left upper arm turns and the root goes 3 m along z.
Clip armClip(const HumanRig& rig) {
    const LocalPose rest = restPose(rig.skeleton);
    const Frame arm = rest.bones[static_cast<std::size_t>(rig.upperArm[0])];
    Clip clip{"wave", 1, {}};
    clip.tracks.push_back({rig.upperArm[0], {0, 1}, {arm, {arm.position, rotationAbout({0, 0, 1}, kAngle)}}});
    const Frame root = rig.skeleton.bones[0].bind;
    clip.tracks.push_back({0, {0, 0.5f, 1}, {root, root, {root.position + Vec3{0, 0, 3}, root.rotation}}});
    return clip;
}

float angleAboutZ(const Quat& q) { return 2 * std::atan2(q.z, q.w); }

TEST(Clip, TurnsAtAConstantRateBetweenKeysAndStaysBeyondThem) {
    const HumanRig rig;
    const Clip clip = armClip(rig);
    ASSERT_EQ(whyInvalid(clip, rig.skeleton), "");
    LocalPose pose = restPose(rig.skeleton);
    for (const float time : {-1.0f, 0.0f, 0.1f, 0.25f, 0.5f, 0.9f, 1.0f, 7.0f}) {
        sample(clip, time, pose);
        const float share = std::min(1.0f, std::max(0.0f, time));
        EXPECT_NEAR(angleAboutZ(pose.bones[static_cast<std::size_t>(rig.upperArm[0])].rotation), share * kAngle, 1e-6f);
        EXPECT_NEAR(pose.root.position.z, 3 * std::max(0.0f, 2 * share - 1), 1e-6);
    }
}

TEST(Clip, GoesTheShortWayWhateverTheSignOfItsKeys) {
    const HumanRig rig;
    Clip clip = armClip(rig);
    Quat& last = clip.tracks[0].keys[1].rotation;
    last = {-last.x, -last.y, -last.z, -last.w};
    LocalPose pose = restPose(rig.skeleton);
    sample(clip, 0.5f, pose);
    const Quat q = pose.bones[static_cast<std::size_t>(rig.upperArm[0])].rotation;
    EXPECT_NEAR(std::abs(q.w), std::cos(kAngle / 4), 1e-6f);
}

TEST(Clip, LeavesBonesWithoutKeysAloneAndStandsWhereItIsPut) {
    const HumanRig rig;
    const Clip clip = armClip(rig);
    LocalPose pose = restPose(rig.skeleton);
    pose.bones[static_cast<std::size_t>(rig.shank[1])].rotation = rotationAbout({1, 0, 0}, 1);
    const LocalPose before = pose;
    const Pose placement{{100, 0, -5}, rotationAbout({0, 1, 0}, 1.5707963f)};
    sample(clip, 1, pose, placement);
    EXPECT_EQ(pose.bones[static_cast<std::size_t>(rig.shank[1])].rotation.x,
              before.bones[static_cast<std::size_t>(rig.shank[1])].rotation.x);
    // z of the model is x of the world there.
    EXPECT_NEAR(pose.root.position.x, 103, 1e-5);
    EXPECT_NEAR(pose.root.position.z, -5, 1e-5);
}

TEST(Clip, RepeatsWithItsLength) {
    const HumanRig rig;
    const Clip clip = armClip(rig);
    for (const float time : {0.0f, 0.3f, 0.99f})
        for (const float times : {-2.0f, 1.0f, 5.0f}) EXPECT_NEAR(wrapped(clip, time + times), time, 1e-5f);
    EXPECT_EQ(wrapped(Clip{}, 3), 0);
}

TEST(Clip, IsSampledAndBlendedWithoutMemory) {
    const HumanRig rig;
    const Clip clip = armClip(rig);
    LocalPose pose = restPose(rig.skeleton), other = pose;
    const long before = heapCalls();
    for (int i = 0; i < 100; ++i) {
        sample(clip, 0.01f * static_cast<float>(i), pose);
        blendInto(pose, other, 0.5f);
    }
    EXPECT_EQ(heapCalls(), before);
}

TEST(Clip, BlendsHalfWayToHalfTheAngle) {
    const HumanRig rig;
    const Clip clip = armClip(rig);
    LocalPose pose = restPose(rig.skeleton), turned = pose;
    sample(clip, 1, turned);
    blendInto(pose, turned, 0.5f);
    EXPECT_NEAR(angleAboutZ(pose.bones[static_cast<std::size_t>(rig.upperArm[0])].rotation), kAngle / 2, 1e-6f);
    EXPECT_NEAR(pose.root.position.z, 1.5, 1e-6);
    blendInto(pose, turned, 9);
    EXPECT_NEAR(angleAboutZ(pose.bones[static_cast<std::size_t>(rig.upperArm[0])].rotation), kAngle, 1e-6f);
    LocalPose shorter;
    EXPECT_THROW(blendInto(pose, shorter, 0.5f), std::invalid_argument);
}

TEST(Clip, SaysWhatIsWrongWithIt) {
    const HumanRig rig;
    const auto problem = [&](auto change) {
        Clip clip = armClip(rig);
        change(clip);
        return whyInvalid(clip, rig.skeleton);
    };
    EXPECT_EQ(problem([](Clip& clip) { clip.tracks[0].bone = 999; }),
              "tracks[0].bone is 999, must be an index of the skeleton's " + std::to_string(rig.skeleton.bones.size()) +
                  " bones");
    EXPECT_NE(problem([](Clip& clip) { clip.tracks[1].times[1] = 2; }).find("tracks[1].times[1] is 2"),
              std::string::npos);
    EXPECT_NE(problem([](Clip& clip) { clip.tracks[1].times[2] = 0.5f; }).find("must rise"), std::string::npos);
    EXPECT_NE(problem([](Clip& clip) { clip.tracks[0].keys.pop_back(); }).find("as many of each"), std::string::npos);
    EXPECT_NE(problem([](Clip& clip) { clip.tracks[1].bone = clip.tracks[0].bone; }).find("another track"),
              std::string::npos);
    EXPECT_NE(problem([](Clip& clip) { clip.seconds = std::numeric_limits<float>::quiet_NaN(); }), "");
    EXPECT_NE(problem([](Clip& clip) {
                  clip.tracks[0].keys[0].rotation = {0, 0, 0, 2};
              }).find("length 1"),
              std::string::npos);
}

}  // namespace
}  // namespace ragtop
