#include "ragtop/compressed_clip.h"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

#include "core/heap_counter.h"
#include "human.h"

namespace ragtop {
namespace {

/// Two seconds at 30 Hz of a human who goes along z: every bone swings by harmonics, as in walking.
Clip walk(const HumanRig& rig) {
    const LocalPose rest = restPose(rig.skeleton);
    Clip clip{"walk", 2, {}};
    for (int bone = 0; bone < static_cast<int>(rig.skeleton.bones.size()); ++bone) {
        ClipTrack track{bone, {}, {}};
        const auto b = static_cast<std::size_t>(bone);
        for (int k = 0; k <= 60; ++k) {
            const float t = static_cast<float>(k) / 30, phase = 6.0f * t + static_cast<float>(bone);
            Frame frame = bone == 0 ? rig.skeleton.bones[0].bind : rest.bones[b];
            if (bone == 0) frame.position += Vec3{0, 0.02f * std::sin(2 * phase), 1.4f * t};
            frame.rotation = frame.rotation * rotationAbout(normalized(Vec3{1, 0.2f, 0.1f}), 0.4f * std::sin(phase)) *
                             rotationAbout({0, 1, 0}, 0.05f * std::sin(3 * phase));
            track.times.push_back(t);
            track.keys.push_back(frame);
        }
        clip.tracks.push_back(track);
    }
    return clip;
}

std::size_t bytesOf(const Clip& clip) {
    std::size_t sum = 0;
    for (const ClipTrack& track : clip.tracks) sum += track.times.size() * (sizeof(float) + sizeof(Frame));
    return sum;
}

double farthestApart(const HumanRig& rig, const Clip& clip, const CompressedClip& made) {
    const LocalPose rest = restPose(rig.skeleton);
    LocalPose a = rest, b = a;
    double worst = 0;
    for (float t = -0.1f; t < clip.seconds + 0.2f; t += 0.0037f) {
        sample(clip, t, a);
        sample(made, rest, t, b);
        const std::vector<Pose> p = writePose(rig.skeleton, a), q = writePose(rig.skeleton, b);
        for (std::size_t i = 0; i < p.size(); ++i) {
            const DVec3 d = p[i].position - q[i].position;
            worst = std::max(worst, std::sqrt(d.x * d.x + d.y * d.y + d.z * d.z));
        }
    }
    return worst;
}

TEST(CompressedClip, KeepsToItsErrorInASixthOfTheMemory) {
    const HumanRig rig;
    const Clip clip = walk(rig);
    const CompressedClip made(clip, rig.skeleton);
    EXPECT_LE(6 * made.bytes(), bytesOf(clip)) << made.error();
    EXPECT_LE(made.error(), 0.001f);
    // Between the times at which it is measured it is hardly more.
    EXPECT_LE(farthestApart(rig, clip, made), 0.0011);
    EXPECT_EQ(made.name(), "walk");
    EXPECT_EQ(made.seconds(), 2);
}

TEST(CompressedClip, TakesMoreMemoryForLessError) {
    const HumanRig rig;
    const Clip clip = walk(rig);
    std::size_t before = 0;
    for (const float error : {0.1f, 0.01f, 0.002f, 0.0007f}) {
        const CompressedClip made(clip, rig.skeleton, error);
        EXPECT_LE(farthestApart(rig, clip, made), 1.2 * static_cast<double>(error));
        EXPECT_GT(made.bytes(), before);
        before = made.bytes();
    }
}

TEST(CompressedClip, OfBonesThatStayKeepsThreeNumbersEach) {
    const HumanRig rig;
    Clip clip = walk(rig);
    for (ClipTrack& track : clip.tracks) std::fill(track.keys.begin(), track.keys.end(), track.keys[0]);
    const CompressedClip made(clip, rig.skeleton, 0.002f);
    EXPECT_LE(farthestApart(rig, clip, made), 0.002);
    constexpr std::size_t kOfTrack = 8;  // 14 bits, and thrice 16 at most
    EXPECT_LE(made.bytes(), kOfTrack * clip.tracks.size());
}

/// The first key of each bone alone.
Clip poseOf(Clip clip) {
    for (ClipTrack& track : clip.tracks) {
        track.times.resize(1);
        track.keys.resize(1);
    }
    clip.seconds = 0;
    return clip;
}

TEST(CompressedClip, OfAPoseTakesASixthAndOfTheBodyAtRestNextToNothing) {
    const HumanRig rig;
    Clip pose = poseOf(walk(rig));
    const CompressedClip made(pose, rig.skeleton);
    EXPECT_LE(6 * made.bytes(), bytesOf(pose));
    EXPECT_LE(farthestApart(rig, pose, made), 0.001);
    const LocalPose rest = restPose(rig.skeleton);
    for (ClipTrack& track : pose.tracks)
        track.keys[0] = track.bone == 0 ? rig.skeleton.bones[0].bind : rest.bones[static_cast<std::size_t>(track.bone)];
    EXPECT_LE(CompressedClip(pose, rig.skeleton).bytes(), pose.tracks.size());
}

TEST(CompressedClip, OfBonesThatHaveKeysAtTimesOfTheirOwnKeepsThose) {
    const HumanRig rig;
    Clip clip = walk(rig);
    for (ClipTrack& track : clip.tracks) {
        ClipTrack few{track.bone, {}, {}};
        for (std::size_t k = 0; k < track.keys.size(); k += 6) {
            few.times.push_back(k == 0 ? 0 : track.times[k] - 0.004f * static_cast<float>(track.bone % 7));
            few.keys.push_back(track.keys[k]);
        }
        track = few;
    }
    const CompressedClip made(clip, rig.skeleton);
    EXPECT_LE(farthestApart(rig, clip, made), 0.0015);
    EXPECT_LE(3 * made.bytes(), bytesOf(clip));
}

/// The same with few keys, which are listed, and with many times, of which blocks are counted.
TEST(CompressedClip, FindsKeysAmongManyTimes) {
    const HumanRig rig;
    Clip clip{"long", 0, {}};
    for (const int bone : {0, 2, 5}) {
        ClipTrack track{bone, {}, {}};
        const int every = bone == 0 ? 1 : bone == 2 ? 3 : 150;
        const LocalPose rest = restPose(rig.skeleton);
        for (int k = 0; k <= 600; k += every) {
            Frame frame = bone == 0 ? rig.skeleton.bones[0].bind : rest.bones[static_cast<std::size_t>(bone)];
            const float t = static_cast<float>(k) / 60;
            frame.rotation =
                frame.rotation * rotationAbout({1, 0, 0}, 0.5f * std::sin(t * t + static_cast<float>(bone)));
            track.times.push_back(t);
            track.keys.push_back(frame);
        }
        clip.tracks.push_back(track);
    }
    clip.seconds = 10;
    const CompressedClip made(clip, rig.skeleton);
    EXPECT_LE(farthestApart(rig, clip, made), 0.0012);
    EXPECT_LE(6 * made.bytes(), bytesOf(clip));
}

TEST(CompressedClip, GoesRoundAsOftenAsTheClip) {
    const HumanRig rig;
    Clip clip = walk(rig);
    for (std::size_t k = 0; k < clip.tracks[0].keys.size(); ++k)
        clip.tracks[0].keys[k].rotation = rotationAbout({0.3f, 1, 0}, 0.7f * static_cast<float>(k));
    const CompressedClip made(clip, rig.skeleton);
    EXPECT_LE(made.error(), 0.001f);
    EXPECT_LE(farthestApart(rig, clip, made), 0.0011);
}

TEST(CompressedClip, OfABodyFarAwayKeepsToItsErrorOrIsRefused) {
    const HumanRig rig;
    Clip clip = walk(rig);
    const auto moved = [&](float far) {
        Clip other = clip;
        for (Frame& key : other.tracks[0].keys) key.position.x += far;
        return other;
    };
    EXPECT_LE(farthestApart(rig, moved(500), CompressedClip(moved(500), rig.skeleton)), 0.0012);
    EXPECT_THROW(CompressedClip(moved(9e5f), rig.skeleton), std::invalid_argument);
    EXPECT_THROW(CompressedClip(poseOf(moved(9e5f)), rig.skeleton), std::invalid_argument);
}

TEST(CompressedClip, IsSampledWithoutMemoryWhereItIsPut) {
    const HumanRig rig;
    const Clip clip = walk(rig);
    const CompressedClip made(clip, rig.skeleton);
    const LocalPose rest = restPose(rig.skeleton);
    LocalPose pose = rest, exact = pose;
    const Pose placement{{100, 0, -5}, rotationAbout({0, 1, 0}, 1)};
    const long before = heapCalls();
    for (int i = 0; i < 100; ++i) sample(made, rest, 0.02f * static_cast<float>(i), pose, placement);
    EXPECT_EQ(heapCalls(), before);
    sample(clip, 0.02f * 99, exact, placement);
    EXPECT_NEAR(pose.root.position.x, exact.root.position.x, 1e-3);
    EXPECT_NEAR(pose.root.position.z, exact.root.position.z, 1e-3);
}

TEST(CompressedClip, SaysWhyNot) {
    const HumanRig rig;
    Clip clip = walk(rig);
    const auto complaint = [&](float error) {
        try {
            CompressedClip(clip, rig.skeleton, error);
        } catch (const std::invalid_argument& e) {
            return std::string(e.what());
        }
        return std::string();
    };
    EXPECT_NE(complaint(0).find("maxError is 0"), std::string::npos);
    EXPECT_NE(complaint(std::nanf("")).find("maxError is nan"), std::string::npos);
    EXPECT_NE(complaint(1e-7f).find("must be more"), std::string::npos);
    clip.tracks[3].bone = 999;
    EXPECT_NE(complaint(0.001f).find("tracks[3].bone is 999"), std::string::npos);
    LocalPose pose = restPose(rig.skeleton);
    sample(CompressedClip(), pose, 1, pose);  // nothing moves
    EXPECT_EQ(CompressedClip().bytes(), 0u);
}

}  // namespace
}  // namespace ragtop
