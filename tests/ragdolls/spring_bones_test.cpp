#include "ragtop/spring_bones.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <stdexcept>
#include <string>
#include <vector>

#include "core/heap_counter.h"

namespace ragtop {
namespace {

/// A head and a tail of bones along x behind it, each of them `length` long.
Skeleton tail(int bones, float length) {
    Skeleton skeleton;
    skeleton.bones.push_back({"root", -1, {}});
    skeleton.bones.push_back({"head", 0, {}});
    for (int i = 0; i < bones; ++i)
        skeleton.bones.push_back({"tail" + std::to_string(i), i + 1, {{length * static_cast<float>(i + 1), 0, 0}, {}}});
    return skeleton;
}

std::vector<Pose> posed(const Skeleton& skeleton, const Pose& placement) {
    std::vector<Pose> pose;
    for (const Bone& bone : skeleton.bones) pose.push_back(placement * bone.bind);
    return pose;
}

/// The tail of `bones` bones, all in one chain.
SpringBonesDef chainOf(int bones, const SpringChain& like = {}) {
    SpringBonesDef def;
    def.chains.push_back(like);
    def.chains[0].first = 2;
    def.chains[0].last = bones + 1;
    return def;
}

using Motion = std::function<Pose(double time, float size)>;

/// Where the last bone points, in each twentieth of a second.
std::vector<Vec3> course(const SpringChain& like, int bones, float size, int rate, const Motion& motion) {
    const Skeleton skeleton = tail(bones, 0.1f * size);
    SpringBones springs(skeleton, chainOf(bones, like));
    std::vector<Vec3> result;
    for (int frame = 0; frame <= 3 * rate; ++frame) {
        std::vector<Pose> pose = posed(skeleton, motion(static_cast<double>(frame) / rate, size));
        springs.step(pose, frame == 0 ? 0.0 : 1.0 / rate);
        if (frame % (rate / 20) == 0) result.push_back(rotate(pose.back().rotation, {1, 0, 0}));
    }
    return result;
}

/// Largest distance of two courses over the larger's largest distance to its beginning.
float apart(const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
    float most = 0, swing = 0;
    for (std::size_t i = 0; i < a.size(); ++i) {
        most = std::max(most, length(a[i] - b[i]));
        swing = std::max(swing, length(a[i] - a[0]));
    }
    return most / swing;
}

/// A dance: sways, bobs, nods and turns that begin softly.
Pose dance(double time, float size) {
    const auto t = static_cast<float>(time);
    const float begun = std::min(t, 1.0f), soft = begun * begun * (3 - 2 * begun);
    const float step = soft * std::sin(2 * kPi * 0.7f * t), bob = soft * std::sin(2 * kPi * 0.5f * t);
    const Vec3 place = size * Vec3{0.05f * step, 0.04f * bob, 0};
    return {DVec3(place), rotationAbout({0.3f, 1, 0.2f}, 0.5f * bob) * rotationAbout({0, 0, 1}, 0.3f * step)};
}

/// rad below level, of the bone of a tail of one.
float droop(const std::vector<Pose>& pose) {
    const Vec3 along = rotate(pose[2].rotation, {1, 0, 0});
    return arcTan2(-along.y, along.x);
}

TEST(SpringBones, SwingsAsTheDampedOscillatorDoes) {
    const double w = 4 * M_PI, start = 0.02;
    for (const double ratio : {0.0, 0.2, 1.0, 3.0}) {
        for (const int rate : {4, 20, 60, 300}) {
            const Skeleton skeleton = tail(1, 0.1f);
            SpringChain chain{.frequency = 2, .dampingRatio = static_cast<float>(ratio)};
            chain.sag = static_cast<float>(start);
            SpringBones springs(skeleton, chainOf(1, chain));
            std::vector<Pose> pose = posed(skeleton, {});
            springs.step(pose, 0);
            EXPECT_NEAR(droop(pose), start, 1e-6);
            // Without gravity it is let go: θ̈ = −ω² θ − 2ζω θ̇.
            for (int frame = 1; frame <= rate; ++frame) {
                pose = posed(skeleton, {});
                springs.step(pose, 1.0 / rate, {});
                const double t = static_cast<double>(frame) / rate, fade = std::exp(-ratio * w * t);
                const double rest = std::sqrt(std::abs(1 - ratio * ratio)), x = rest * w * t;
                double exact = fade * (1 + w * t);
                if (ratio < 1) exact = fade * (std::cos(x) + ratio / rest * std::sin(x));
                if (ratio > 1) exact = fade * (std::cosh(x) + ratio / rest * std::sinh(x));
                // A pendulum's period is longer by θ²/16; a second is two of them.
                EXPECT_NEAR(droop(pose), start * exact, start * (4 * M_PI * start * start / 16 + 3e-4))
                    << "ratio " << ratio << " at " << rate << " after " << t;
            }
        }
    }
}

/// T = T₀ (1 + θ²/16 + 11 θ⁴/3072 + 173 θ⁶/737280 + …)
TEST(SpringBones, LargeSwingsHaveThePeriodOfThePendulum) {
    const Skeleton skeleton = tail(1, 0.1f);
    SpringBones springs(skeleton, chainOf(1, {.frequency = 1, .dampingRatio = 0, .sag = 1, .swingLimit = 3}));
    std::vector<Pose> pose = posed(skeleton, {});
    springs.step(pose, 0);
    float before = droop(pose), most = 0;
    std::vector<double> crossings;
    for (int frame = 1; frame <= 660; ++frame) {
        pose = posed(skeleton, {});
        springs.step(pose, 1 / 60.0, {});
        const float now = droop(pose);
        if (before < 0 && now >= 0) crossings.push_back((frame - static_cast<double>(now / (now - before))) / 60);
        before = now;
        if (frame > 600) most = std::max(most, now);
    }
    ASSERT_GE(crossings.size(), 10u);
    EXPECT_NEAR((crossings[9] - crossings[0]) / 9, 1 + 1 / 16.0 + 11 / 3072.0 + 173 / 737280.0, 0.002);
    // Second order in (ω h)² = 0.01: no swing is lost or won.
    EXPECT_NEAR(most, 1.0f, 0.01f);
}

TEST(SpringBones, LeansBackAsTheCarrierAccelerates) {
    for (const float inertia : {0.0f, 0.5f, 1.0f}) {
        const Skeleton skeleton = tail(1, 0.1f);
        SpringBones springs(skeleton, chainOf(1, {.frequency = 2, .dampingRatio = 1, .sag = 0, .inertia = inertia}));
        std::vector<Pose> pose;
        for (int frame = 0; frame <= 120; ++frame) {
            const double t = frame / 60.0;
            pose = posed(skeleton, {{0, 2.5 * t * t, 0}, {}});
            springs.step(pose, frame == 0 ? 0.0 : 1 / 60.0);
        }
        // tan θ = (a/L)/ω²
        EXPECT_NEAR(droop(pose), std::atan(inertia * 50 / (16 * kPi * kPi)), 1e-4);
    }
}

TEST(SpringBones, MovesAlikeAtAnyFrameRate) {
    for (const int bones : {1, 3, 8}) {
        for (const float frequency : {1.0f, 2.0f, 5.0f}) {
            const SpringChain chain{.frequency = frequency};
            const auto exact = course(chain, bones, 1, 4800, dance);
            for (const int rate : {20, 40, 60, 120, 300}) {
                // The tip of eight adds up what frames at 20 Hz do not tell of the dance.
                const float most = bones == 8 && rate == 20 ? 0.03f : 0.01f;
                EXPECT_LT(apart(exact, course(chain, bones, 1, rate, dance)), most)
                    << bones << " bones of " << frequency << " Hz at " << rate;
            }
        }
    }
}

/// Steps are of second order: half as long, a quarter of the error.
TEST(SpringBones, ErrorsFallWithTheSquareOfTheFrame) {
    const auto exact = course({}, 3, 1, 4800, dance);
    const float coarse = apart(exact, course({}, 3, 1, 60, dance)), fine = apart(exact, course({}, 3, 1, 240, dance));
    EXPECT_LT(fine, coarse / 10);
}

TEST(SpringBones, MovesAlikeAtAnySize) {
    const auto usual = course({}, 3, 1, 60, dance);
    for (const float size : {0.1f, 10.0f}) EXPECT_LT(apart(usual, course({}, 3, size, 60, dance)), 1e-3f);
}

TEST(SpringBones, MovesAlikeFarFromTheOrigin) {
    const auto far = [](double time, float size) {
        Pose pose = dance(time, size);
        // Of a size that doubles hold to 2⁻³³ m.
        pose.position = pose.position + DVec3{1048576, -1048576, 524288};
        return pose;
    };
    EXPECT_LT(apart(course({}, 3, 1, 60, dance), course({}, 3, 1, 60, far)), 1e-3f);
}

TEST(SpringBones, IsQuietInItsFirstFramesAndAtRest) {
    const Skeleton skeleton = tail(4, 0.1f);
    SpringBones springs(skeleton, chainOf(4));
    std::vector<Pose> first = posed(skeleton, {{3, 2, 1}, rotationAbout({1, 2, 3}, 1)});
    const std::vector<Pose> still = first;
    springs.step(first, 0);
    for (int frame = 0; frame < 240; ++frame) {
        std::vector<Pose> pose = still;
        springs.step(pose, 1 / 60.0);
        for (std::size_t i = 0; i < pose.size(); ++i)
            EXPECT_LT(length(relative(pose[i].position, first[i].position)), 2e-6f);
    }
}

TEST(SpringBones, ARunnersTeleportIsNoMotion) {
    const Skeleton skeleton = tail(4, 0.1f);
    for (const bool told : {false, true}) {
        SpringBones springs(skeleton, chainOf(4));
        std::vector<Pose> bent;
        for (int frame = 0; frame <= 120; ++frame) {
            // Runs at 5 m/s along x; from frame 100 elsewhere, further than it is large or told so.
            const bool moved = frame >= 100;
            const DVec3 there{0, moved ? (told ? 0.1 : 30.0) : 0.0, 0};
            if (told && frame == 100) springs.teleport();
            std::vector<Pose> pose = posed(skeleton, {there + DVec3{5 * frame / 60.0, 0, 0}, {}});
            springs.step(pose, frame == 0 ? 0.0 : 1 / 60.0);
            if (frame == 99) bent = pose;
            for (std::size_t i = 0; frame > 99 && i < pose.size(); ++i) {
                const Vec3 ran{5 * static_cast<float>(frame - 99) / 60, 0, 0};
                EXPECT_LT(length(relative(pose[i].position, bent[i].position) - toVec3(there) - ran), 1e-4f) << frame;
            }
        }
    }
}

TEST(SpringBones, APauseKeepsTheSwing) {
    const Skeleton skeleton = tail(3, 0.1f);
    SpringBones paused(skeleton, chainOf(3)), going(skeleton, chainOf(3));
    for (int frame = 0; frame <= 60; ++frame) {
        std::vector<Pose> a = posed(skeleton, dance(frame / 60.0, 1)), b = a;
        going.step(b, frame == 0 ? 0.0 : 1 / 60.0);
        paused.step(a, frame == 0 ? 0.0 : 1 / 60.0);
        if (frame % 7 == 0) {
            a = posed(skeleton, dance(frame / 60.0, 1));
            paused.step(a, 0);
        }
        for (std::size_t i = 0; i < a.size(); ++i) EXPECT_LT(length(relative(a[i].position, b[i].position)), 2e-5f);
    }
}

TEST(SpringBones, WeightsStayOutsideOfColliders) {
    const Skeleton skeleton = tail(4, 0.1f);
    SpringBonesDef def = chainOf(4, {.sag = 1.2f, .radius = 0.02f});
    def.colliders.push_back({.bone = 1, .frame = {{0.2f, -0.12f, 0}, {}}, .shape = Sphere{0.1f}});
    def.colliders.push_back(
        {.frame = {{0.35f, -0.2f, 0}, rotationAbout({1, 0, 0}, 1.57f)}, .shape = Capsule{0.05f, 0.3f}});
    def.colliders.push_back({.frame = {{0, -0.25f, 0}, {}}, .shape = SpringPlane{}});
    SpringBones springs(skeleton, def);
    bool touched = false;
    for (int frame = 0; frame <= 600; ++frame) {
        const double t = frame / 60.0;
        const auto sway = static_cast<float>(0.03 * std::sin(5 * t));
        std::vector<Pose> pose = posed(skeleton, {{static_cast<double>(sway), 0, 0}, {}});
        springs.step(pose, frame == 0 ? 0.0 : 1 / 60.0);
        for (std::size_t i = 2; i < pose.size(); ++i) {
            const Vec3 weight = toVec3(transformPoint(pose[i], {0.1f, 0, 0}));
            const float ball = length(weight - Vec3{0.2f + sway, -0.12f, 0}) - 0.12f;
            const float rod = std::hypot(weight.x - 0.35f, weight.y + 0.2f) - 0.07f;
            const float floor = weight.y + 0.25f - 0.02f;
            // One pushes into another where both are: the last one is obeyed to rounding.
            EXPECT_GT(floor, -1e-5f) << frame;
            EXPECT_GT(std::min(ball, rod), -0.005f) << frame;
            touched |= ball < 1e-3f;
        }
    }
    EXPECT_TRUE(touched);
}

TEST(SpringBones, CarriesWhatHangsOnIt) {
    Skeleton skeleton = tail(3, 0.1f);
    skeleton.bones.push_back({"bell", 3, {{0.25f, 0, 0.05f}, {}}});
    skeleton.bones.push_back({"ribbon", 5, {{0.3f, 0, 0.05f}, {}}});
    SpringBonesDef def = chainOf(3, {.sag = 0.8f});
    def.chains.push_back({.first = 6, .last = 6, .tip = {0, 0, 0.1f}, .frequency = 30, .sag = 0});
    SpringBones springs(skeleton, def);
    std::vector<Pose> pose = posed(skeleton, {});
    springs.step(pose, 0);
    const Frame bell = relative(pose[3], pose[5]), ribbon = relative(pose[5], pose[6]);
    EXPECT_LT(length(bell.position - Vec3{0.05f, 0, 0.05f}), 1e-6f);
    EXPECT_LT(length(ribbon.position - Vec3{0.05f, 0, 0}), 1e-6f);
    EXPECT_LT(pose[3].position.y, -0.05);
    for (const Pose& each : pose) {
        const Quat& q = each.rotation;
        EXPECT_NEAR(q.x * q.x + q.y * q.y + q.z * q.z + q.w * q.w, 1, 1e-6);
    }
}

TEST(SpringBones, StaysBoundedThroughAnything) {
    const Skeleton skeleton = tail(4, 0.1f);
    for (const float frequency : {0.05f, 2.0f, 30.0f}) {
        SpringBones springs(skeleton, chainOf(4, {.frequency = frequency, .dampingRatio = 0, .sag = 1.5f}));
        for (int frame = 0; frame < 600; ++frame) {
            // Strokes of 4 m, spins of half turns, frames from 1 µs to a minute.
            const double dt = frame % 7 == 3 ? 60.0 : frame % 5 == 0 ? 1e-6 : 1 / 60.0;
            const Pose wild{{(frame % 2) * 0.1, frame % 3 * 2.0, 0},
                            rotationAbout({1, 1, 0}, 3.0f * static_cast<float>(frame % 4))};
            std::vector<Pose> pose = posed(skeleton, wild);
            springs.step(pose, dt);
            for (std::size_t i = 3; i < pose.size(); ++i) {
                ASSERT_TRUE(isFinite(pose[i].position) && isFinite(pose[i].rotation)) << frame;
                ASSERT_NEAR(length(relative(pose[i].position, pose[i - 1].position)), 0.1f, 1e-5f) << frame;
            }
        }
    }
}

TEST(SpringBones, StepsWithoutMemory) {
    const Skeleton skeleton = tail(8, 0.1f);
    SpringBonesDef def = chainOf(8);
    def.colliders.push_back({.bone = 1, .shape = Sphere{0.05f}});
    SpringBones springs(skeleton, def);
    std::vector<Pose> pose = posed(skeleton, {});
    springs.step(pose, 0);
    const long before = heapCalls();
    for (int frame = 0; frame < 30; ++frame) springs.step(pose, frame == 20 ? 0.5 : 1 / 60.0);
    EXPECT_EQ(heapCalls(), before);
}

/// What a definition is told, broken in one place.
std::string told(const std::function<void(SpringBonesDef&)>& breakIt) {
    const Skeleton skeleton = tail(3, 0.1f);
    SpringBonesDef def = chainOf(3);
    def.colliders.push_back({.bone = 1, .shape = Sphere{0.05f}});
    EXPECT_EQ(whyInvalid(def, skeleton), "");
    breakIt(def);
    EXPECT_THROW(SpringBones(skeleton, def), std::invalid_argument);
    return whyInvalid(def, skeleton);
}

TEST(SpringBones, ABrokenDefinitionIsToldInOneLine) {
    EXPECT_EQ(told([](SpringBonesDef& d) { d.chains[0].frequency = 0; }),
              "chains[0].frequency is 0 Hz, must be in [0.05, 30]");
    EXPECT_EQ(told([](SpringBonesDef& d) { d.chains[0].dampingRatio = -1; }),
              "chains[0].dampingRatio is -1, must be in [0, 10]");
    EXPECT_EQ(told([](SpringBonesDef& d) { d.chains[0].sag = 1.6f; }), "chains[0].sag is 1.6 rad, must be in [0, 1.5]");
    EXPECT_EQ(told([](SpringBonesDef& d) { d.chains[0].first = 0; }),
              "chains[0].first is 0, must be the index of a bone below the root");
    EXPECT_EQ(told([](SpringBonesDef& d) { d.chains[0].last = 9; }),
              "chains[0].last is 9, must be the index of a bone below the root");
    EXPECT_EQ(told([](SpringBonesDef& d) { std::swap(d.chains[0].first, d.chains[0].last); }),
              "chains[0].first is bones[4] (tail2), must be last or above it, bones[2] (tail0)");
    EXPECT_EQ(told([](SpringBonesDef& d) { d.chains.push_back(d.chains[0]); }),
              "chains[1].moves bones[2] (tail0), which another chain moves already");
    EXPECT_EQ(told([](SpringBonesDef& d) {
                  d.chains[0].tip = {1e-9f, 0, 0};
              }),
              "chains[0].tip of bones[4] (tail2) is where it begins, must be apart");
    EXPECT_EQ(told([](SpringBonesDef& d) { d.colliders[0].bone = 3; }),
              "colliders[0].bone is bones[3] (tail1), must be one that no chain moves");
    EXPECT_EQ(told([](SpringBonesDef& d) { d.colliders[0].shape = Sphere{-1}; }),
              "colliders[0].shape.radius is -1 m, must be in [0.0001, 100000]");
    EXPECT_EQ(told([](SpringBonesDef& d) {
                  d.colliders[0].frame.rotation = {0, 0, 0, 2};
              }),
              "colliders[0].frame is not finite or its rotation has not length 1");
    EXPECT_EQ(told([](SpringBonesDef& d) { d.jump = 0; }), "jump is 0, must be in [0.001, 1e+06]");
}

}  // namespace
}  // namespace ragtop
