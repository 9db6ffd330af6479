#include "ragtop/packed_pose.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <string>
#include <vector>

#include "human.h"
#include "ragtop/world.h"

namespace ragtop {
namespace {

/// Bodies that fall, lie and are dragged by a hand, near the origin and far away.
TEST(PackedPose, RealBodiesAreWithinAMillimetreAndHalfADegree) {
    ASSERT_EQ(human().parts.size(), 16u);
    std::vector<std::byte> bytes(packedSize(human()));
    EXPECT_LE(bytes.size(), 120u);
    for (const double place : {0.0, 100000.0}) {
        World world;
        world.create(StaticBody{.shape = Box{{50, 1, 50}}, .position = {place, -1, 0}});
        const Ragdoll ragdoll(world, human(), {{place, 0.5, 0}, rotationAbout({1, 0, 0.3f}, 0.6f)});
        std::vector<Pose> parts(16), unpacked(16);
        float off = 0, turned = 0;
        for (int step = 0; step < 240; ++step) {
            if (step % 60 == 30)
                world.applyImpulse(ragdoll.bodies()[2], {100, 150, 50}, world.centerOfMass(ragdoll.bodies()[2]));
            world.step(1.0 / 60);
            ragdoll.partPoses(parts);
            ASSERT_TRUE(pack(human(), parts, bytes));
            ASSERT_TRUE(unpack(human(), bytes, unpacked));
            for (std::size_t i = 0; i < parts.size(); ++i) {
                off = std::max(off, length(relative(parts[i].position, unpacked[i].position)));
                turned = std::max(turned, angleBetween(parts[i].rotation, unpacked[i].rotation));
            }
        }
        RecordProperty("off_mm", std::to_string(1000 * off));
        RecordProperty("turned_degrees", std::to_string(turned * 180 / kPi));
        EXPECT_LT(off, 0.001f);
        EXPECT_LT(turned, 0.5f * kPi / 180);
    }
}

TEST(PackedPose, PackingWhatWasUnpackedGivesTheSameBytes) {
    World world;
    const Ragdoll ragdoll(world, human(), {{1, 2, 3}, rotationAbout({1, 2, 3}, 1)});
    for (int step = 0; step < 30; ++step) world.step(1.0 / 60);
    std::vector<Pose> parts(16);
    ragdoll.partPoses(parts);
    std::vector<std::byte> bytes(packedSize(human())), again(bytes.size());
    ASSERT_TRUE(pack(human(), parts, bytes));
    ASSERT_TRUE(unpack(human(), bytes, parts));
    ASSERT_TRUE(pack(human(), parts, again));
    EXPECT_EQ(bytes, again);
}

TEST(PackedPose, BonesFollowTheirParts) {
    World world;
    const Ragdoll ragdoll(world, human(), {{1, 2, 3}, {}});
    std::vector<Pose> parts(human().parts.size()), bones(human().bones.size());
    ragdoll.partPoses(parts);
    ASSERT_TRUE(poseOfBones(human(), parts, bones));
    EXPECT_EQ(bones, ragdoll.pose());
}

TEST(PackedPose, AnyBytesAreAPoseAndWhatDoesNotFitIsRefused) {
    std::vector<std::byte> bytes(packedSize(human()));
    std::vector<Pose> parts(16);
    for (unsigned seed = 0; seed < 256; ++seed) {
        for (std::size_t i = 0; i < bytes.size(); ++i) bytes[i] = static_cast<std::byte>(seed * (i * i + 1) >> 2);
        ASSERT_TRUE(unpack(human(), bytes, parts));
        for (const Pose& part : parts) ASSERT_TRUE(isFinite(part.position) && isFinite(part.rotation));
    }
    parts.assign(16, {});
    EXPECT_FALSE(pack(human(), parts, std::span(bytes).first(bytes.size() - 1)));
    EXPECT_FALSE(unpack(human(), bytes, std::span(parts).first(15)));
    EXPECT_FALSE(pack(human(), std::span<const Pose>(parts).first(15), bytes));
    const std::vector<std::byte> before = bytes;
    parts[3].position.x = std::numeric_limits<double>::quiet_NaN();
    EXPECT_FALSE(pack(human(), parts, bytes));
    parts[3].position.x = 1e6;
    EXPECT_FALSE(pack(human(), parts, bytes));
    EXPECT_EQ(bytes, before);
}

}  // namespace
}  // namespace ragtop
