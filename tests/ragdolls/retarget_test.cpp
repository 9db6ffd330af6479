#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "human.h"
#include "ragtop/pose.h"
#include "ragtop/retarget.h"
#include "ragtop/world.h"

namespace ragtop {
namespace {

/// A person with other legs and arms, whose bones lie any way in their joints, and who looks elsewhere.
HumanRig otherHuman() {
    HumanRig rig;
    const auto move = [&](int bone, const Vec3& by) {
        rig.skeleton.bones[static_cast<std::size_t>(bone)].bind.position += by;
    };
    for (int side = 0; side < 2; ++side) {
        const float x = side == 0 ? 1.0f : -1.0f;
        for (const int bone : {rig.thigh[side], rig.shank[side], rig.foot[side], rig.toe[side]})
            move(bone, {0.03f * x, 0, 0});
        move(rig.shank[side], {0, 0.05f, 0});
        move(rig.hand[side], {0.03f * x, 0, 0});
    }
    rig.transform(rotationAbout({0, 1, 0}, -0.5f * kPi), 0.8f);
    std::mt19937 random(7);
    const auto any = [&] { return static_cast<float>(random()) / 4294967296.0f - 0.5f; };
    for (Bone& bone : rig.skeleton.bones) bone.bind.rotation = normalized(Quat{any(), any(), any(), any() + 0.1f});
    return rig;
}

/// Model space turns by `by` of some bones from rest, and a shift of the root, at each key.
struct Move {
    int bone;
    Vec3 axis;
    float angle;
};

class ClipOfMoves {
public:
    explicit ClipOfMoves(const Skeleton& skeleton) : skeleton_(skeleton) {
        clip_.name = "moves";
        for (std::size_t i = 0; i < skeleton.bones.size(); ++i) clip_.tracks.push_back({static_cast<int>(i), {}, {}});
    }

    /// Each bone turns with the ones that it hangs on. `lifted`: the lower foot is where it was at rest, plus this.
    void add(float time, std::span<const Move> moves, const Vec3& shift, bool stands, const HumanRig& rig) {
        std::vector<Pose> world;
        std::vector<Quat> turned(skeleton_.bones.size());
        for (std::size_t i = 0; i < skeleton_.bones.size(); ++i) {
            const Bone& bone = skeleton_.bones[i];
            if (bone.parent >= 0) turned[i] = turned[static_cast<std::size_t>(bone.parent)];
            for (const Move& move : moves)
                if (move.bone == static_cast<int>(i)) turned[i] = turned[i] * rotationAbout(move.axis, move.angle);
            Pose at{DVec3(bone.bind.position + shift), {}};
            if (bone.parent >= 0) {
                const auto parent = static_cast<std::size_t>(bone.parent);
                const Vec3 off = bone.bind.position - skeleton_.bones[parent].bind.position;
                at.position = world[parent].position + rotate(turned[parent], off);
            }
            at.rotation = normalized(turned[i] * bone.bind.rotation);
            world.push_back(at);
        }
        if (stands) {
            const Vec3 by = relative(DVec3(rig.at(rig.foot[0])), world[static_cast<std::size_t>(rig.foot[0])].position);
            for (Pose& pose : world) pose.position = pose.position + by;
        }
        const LocalPose pose = readPose(skeleton_, world);
        clip_.seconds = time;
        for (ClipTrack& track : clip_.tracks) {
            track.times.push_back(time);
            const auto bone = static_cast<std::size_t>(track.bone);
            track.keys.push_back(bone == 0 ? relative(Pose{}, pose.root) : pose.bones[bone]);
        }
    }
    const Clip& clip() const { return clip_; }

private:
    const Skeleton& skeleton_;
    Clip clip_;
};

/// Someone who bows, lifts the arms, bends elbows and knees, and goes forwards and up.
Clip gestures(const HumanRig& rig) {
    ClipOfMoves clip(rig.skeleton);
    for (int i = 0; i <= 4; ++i) {
        const float a = 0.25f * static_cast<float>(i);
        const std::vector<Move> moves{{rig.hips, {0, 1, 0}, 0.3f * a},         {rig.spine, {1, 0, 0}, 0.2f * a},
                                      {rig.chest, {0, 1, 0}, -0.2f * a},       {rig.head, {0, 0, 1}, 0.3f * a},
                                      {rig.upperArm[0], {0, 0, 1}, -0.9f * a}, {rig.forearm[0], {0, 1, 0}, -1.2f * a},
                                      {rig.upperArm[1], {0, 1, 0}, 0.7f * a},  {rig.forearm[1], {0, 1, 0}, 0.8f * a},
                                      {rig.thigh[0], {1, 0, 0}, -0.8f * a},    {rig.shank[0], {1, 0, 0}, 1.1f * a},
                                      {rig.thigh[1], {1, 0, 0}, -0.2f * a},    {rig.shank[1], {1, 0, 0}, 0.4f * a}};
        clip.add(0.5f * a, moves, {0.1f * a, 0.3f * a, 0.8f * a}, false, rig);
    }
    return clip.clip();
}

std::vector<Pose> posed(const Skeleton& skeleton, const Clip& clip, float time) {
    LocalPose pose = restPose(skeleton);
    sample(clip, time, pose);
    return writePose(skeleton, pose);
}

Vec3 wayOf(const std::vector<Pose>& pose, int from, int to) {
    return relative(pose[static_cast<std::size_t>(to)].position, pose[static_cast<std::size_t>(from)].position);
}

float angleBetween(const Vec3& a, const Vec3& b) { return std::atan2(length(cross(a, b)), dot(a, b)); }

TEST(Retarget, ToTheSameBodyIsTheSameClip) {
    const HumanRig rig;
    const Clip clip = gestures(rig);
    const Retargeted same = retarget(clip, human(), human(), {.keepFeet = false});
    EXPECT_FLOAT_EQ(same.scale, 1);
    EXPECT_TRUE(same.still.empty());
    EXPECT_EQ(whyInvalid(same.clip, rig.skeleton), "");
    for (const float time : {0.0f, 0.125f, 0.25f, 0.375f, 0.5f}) {
        const std::vector<Pose> was = posed(rig.skeleton, clip, time), is = posed(rig.skeleton, same.clip, time);
        for (std::size_t i = 0; i < was.size(); ++i)
            EXPECT_LT(length(relative(was[i].position, is[i].position)), 1e-3f) << i << " at " << time;
    }
}

TEST(Retarget, PointsLimbsTheSameWayHoweverBonesLieAndBodiesLook) {
    const HumanRig rig, other = otherHuman();
    const RagdollDef to = makeRagdoll(other.skeleton, {.bodyMass = 60});
    const Clip clip = gestures(rig);
    const Retargeted made = retarget(clip, human(), to, {.keepFeet = false});
    const Quat turn = rotationAbout({0, 1, 0}, -0.5f * kPi);
    for (const float time : {0.0f, 0.25f, 0.5f}) {
        const std::vector<Pose> was = posed(rig.skeleton, clip, time), is = posed(other.skeleton, made.clip, time);
        for (int side = 0; side < 2; ++side) {
            const std::pair<int, int> limbs[] = {{rig.thigh[side], rig.shank[side]},
                                                 {rig.shank[side], rig.foot[side]},
                                                 {rig.upperArm[side], rig.forearm[side]},
                                                 {rig.forearm[side], rig.hand[side]}};
            for (const auto& [from, end] : limbs)
                EXPECT_LT(angleBetween(rotate(turn, wayOf(was, from, end)), wayOf(is, from, end)), 0.01f)
                    << from << " at " << time;
        }
        EXPECT_LT(angleBetween(rotate(turn, wayOf(was, rig.neck, rig.head)), wayOf(is, rig.neck, rig.head)), 0.02f);
    }
    // As many lengths of its legs as the other one of its own.
    const Vec3 was = relative(posed(rig.skeleton, clip, 0.5f)[0].position, posed(rig.skeleton, clip, 0)[0].position);
    const Vec3 is =
        relative(posed(other.skeleton, made.clip, 0.5f)[0].position, posed(other.skeleton, made.clip, 0)[0].position);
    EXPECT_NEAR(is.x, -made.scale * was.z, 0.02f);
}

/// Knees bent by up to 1.2 rad and back, twice, on feet that stay.
Clip squats(const HumanRig& rig) {
    ClipOfMoves clip(rig.skeleton);
    for (int i = 0; i <= 40; ++i) {
        const float bend = 0.3f * (1 - std::cos(0.1f * kPi * static_cast<float>(i)));
        std::vector<Move> moves;
        for (int side = 0; side < 2; ++side) {
            moves.push_back({rig.thigh[side], {1, 0, 0}, -bend});
            moves.push_back({rig.shank[side], {1, 0, 0}, 2 * bend});
            moves.push_back({rig.foot[side], {1, 0, 0}, -bend});
        }
        clip.add(0.05f * static_cast<float>(i), moves, {}, true, rig);
    }
    return clip.clip();
}

TEST(Retarget, HoldsFeetThatStandOnOneSpot) {
    const HumanRig rig, other = otherHuman();
    const RagdollDef to = makeRagdoll(other.skeleton, {.bodyMass = 60});
    const Retargeted made = retarget(squats(rig), human(), to);
    EXPECT_EQ(made.stances, 2);
    const std::vector<Pose> first = posed(other.skeleton, made.clip, 0);
    float lowest = 1e9f, highest = -1e9f;
    for (int i = 0; i <= 100; ++i) {
        const std::vector<Pose> now = posed(other.skeleton, made.clip, 0.02f * static_cast<float>(i));
        for (const int foot : {other.foot[0], other.foot[1], other.toe[0], other.toe[1]}) {
            const auto at = static_cast<std::size_t>(foot);
            EXPECT_LT(length(relative(now[at].position, first[at].position)), 3e-3f) << foot << " at " << i;
        }
        lowest = std::min(lowest, static_cast<float>(now[0].position.y));
        highest = std::max(highest, static_cast<float>(now[0].position.y));
    }
    EXPECT_GT(highest - lowest, 0.08f);
}

TEST(Retarget, KeepsJointsWithinTheLimitsOfTheOtherBody) {
    const HumanRig rig, other = otherHuman();
    const RagdollDef stiff = makeRagdoll(other.skeleton, {.bodyMass = 60, .limitScale = 0.4f});
    const Retargeted made = retarget(gestures(rig), human(), stiff);
    World world;
    for (const float time : {0.0f, 0.2f, 0.4f, 0.5f}) {
        const Ragdoll body(world, stiff, posed(other.skeleton, made.clip, time));
        EXPECT_TRUE(body.beyondLimits(2e-3f).empty()) << time;
    }
}

TEST(Retarget, RefusesWhatIsNoClipOfABodyWithLegs) {
    const HumanRig rig;
    Clip clip = gestures(rig);
    const auto problem = [](auto make) {
        try {
            make();
        } catch (const std::invalid_argument& error) {
            return std::string(error.what());
        }
        return std::string();
    };
    EXPECT_EQ(problem([&] { retarget(clip, human(), human(), {.rate = 1}); }),
              "retarget: rate is 1 1/s, must be in [5, 1000]");
    Clip wrong = clip;
    wrong.tracks[2].bone = 400;
    EXPECT_NE(problem([&] { retarget(wrong, human(), human()); }).find("clip: tracks[2].bone is 400"),
              std::string::npos);
    RagdollDef legless = human();
    for (RagdollPart& part : legless.parts)
        if (part.role == BodyRole::thigh) part.role = BodyRole::other;
    EXPECT_EQ(problem([&] { retarget(clip, human(), legless); }), "body: needs a pelvis, a left and a right thigh");
}

TEST(RootMotion, AndWhatIsLeftAreTheClip) {
    const HumanRig rig;
    const Clip clip = gestures(rig);
    Clip left = clip;
    const RootMotion motion = takeRootMotion(left, rig.skeleton);
    ASSERT_EQ(motion.keys.size(), 5u);
    for (std::size_t i = 0; i < motion.keys.size(); ++i) {
        const std::vector<Pose> was = posed(rig.skeleton, clip, motion.times[i]),
                                is = posed(rig.skeleton, left, motion.times[i]);
        for (std::size_t bone = 0; bone < was.size(); ++bone)
            EXPECT_LT(
                length(relative(was[bone].position, (Pose{} * motion.keys[i] * relative(Pose{}, is[bone])).position)),
                1e-5f);
        // What is left neither goes anywhere nor heads elsewhere.
        EXPECT_NEAR(is[0].position.x, posed(rig.skeleton, clip, 0)[0].position.x, 1e-5);
        EXPECT_NEAR(is[0].position.y, was[0].position.y, 1e-5);
        const Vec3 ahead = rotate(is[0].rotation, {0, 0, 1});
        EXPECT_NEAR(ahead.x, 0, 1e-5f);
        EXPECT_EQ(motion.keys[i].position.y, 0);
    }
    EXPECT_NEAR(motion.keys.back().position.z, 0.8f, 0.05f);
}

}  // namespace
}  // namespace ragtop
