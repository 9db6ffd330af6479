#include <cmath>

#include "import_support.h"
#include "ragtop/character.h"
#include "ragtop/compressed_clip.h"

namespace ragtop {
namespace {

std::filesystem::path rig(const std::string& name) {
    return std::filesystem::path(RAGTOP_SOURCE_DIR) / "tests" / "data" / "rigs" / name;
}

/// A chain of three bones, 100 units each, that bends by a right angle in its middle within a second, below a root that
/// makes centimetres of metres.
std::string bendingMotion() {
    return "HIERARCHY\nROOT a\n{\n OFFSET 0 0 0\n CHANNELS 6 Xposition Yposition Zposition Zrotation Xrotation "
           "Yrotation\n"
           " JOINT b\n {\n  OFFSET 0 100 0\n  CHANNELS 3 Zrotation Xrotation Yrotation\n  JOINT c\n  {\n"
           "   OFFSET 0 100 0\n   CHANNELS 3 Zrotation Xrotation Yrotation\n   End Site\n   {\n    OFFSET 0 100 0\n   "
           "}\n"
           "  }\n }\n}\nMOTION\nFrames: 3\nFrame Time: 0.5\n0 0 0 0 0 0 0 0 0 0 0 0\n0 0 50 0 0 0 45 0 0 0 0 0\n"
           "0 0 100 0 0 0 90 0 0 0 0 0\n";
}

TEST(Clips, MoveTheBonesOfTheirFileInMetres) {
    const TemporaryFile file("bending.bvh", bendingMotion());
    const Character character = loadCharacter(file.path(), {.metersPerUnit = 0.01f, .upAxis = UpAxis::y});
    ASSERT_EQ(character.clips.size(), 1u);
    const Clip& clip = character.clips[0];
    EXPECT_EQ(whyInvalid(clip, character.skeleton), "");
    EXPECT_NEAR(clip.seconds, 1.0f, 1e-5f);
    LocalPose pose = restPose(character.skeleton);
    // b turns about z, which leads c towards −x; a goes along z.
    for (const float time : {0.0f, 0.25f, 0.5f, 0.7f, 1.0f}) {
        sample(clip, time, pose);
        const std::vector<Pose> world = writePose(character.skeleton, pose);
        const float angle = 0.5f * kPi * time;
        const Vec3 c = toVec3(world[static_cast<std::size_t>(character.skeleton.find("c"))].position);
        EXPECT_NEAR(c.x, -std::sin(angle), 1e-5f);
        EXPECT_NEAR(c.y, 1 + std::cos(angle), 1e-5f);
        EXPECT_NEAR(c.z, time, 1e-5f);
    }
}

TEST(Clips, TurnUpWithTheirSkeleton) {
    const TemporaryFile file("bending.bvh", bendingMotion());
    const Character character = loadCharacter(file.path(), {.metersPerUnit = 0.01f, .upAxis = UpAxis::z});
    LocalPose pose = restPose(character.skeleton);
    sample(character.clips[0], 1, pose);
    // The z of the file is up.
    EXPECT_NEAR(pose.root.position.y, 1.0, 1e-5);
}

TEST(Clips, OfRealFilesAreCompressedToASixthWithinAMillimetre) {
    std::size_t before = 0, after = 0;
    for (const char* name : {"characters/arnaud_walk.fbx", "characters/cesium_man.gltf", "characters/knight.glb"}) {
        const std::filesystem::path file = std::filesystem::path(RAGTOP_SHARED_DIR) / "data" / name;
        if (!std::filesystem::exists(file)) GTEST_SKIP() << "no sample " << file;
        Character character = loadCharacter(file);
        character.clips.resize(std::min<std::size_t>(character.clips.size(), 24));
        for (const Clip& clip : character.clips) {
            const CompressedClip made(clip, character.skeleton);
            EXPECT_LE(made.error(), 0.001f) << name << " " << clip.name;
            for (const ClipTrack& track : clip.tracks) before += track.times.size() * (sizeof(float) + sizeof(Frame));
            after += made.bytes();
        }
    }
    EXPECT_LE(6 * after, before);
}

TEST(Clips, OfRealFilesBeginNearTheBodyAndKeepItsBonesLong) {
    for (const char* name : {"characters/arnaud_walk.fbx", "characters/cesium_man.gltf", "characters/knight.glb"}) {
        const std::filesystem::path file = std::filesystem::path(RAGTOP_SHARED_DIR) / "data" / name;
        if (!std::filesystem::exists(file)) GTEST_SKIP() << "no sample " << file;
        const Character character = loadCharacter(file);
        ASSERT_FALSE(character.clips.empty()) << name;
        const Anatomy anatomy = recognise(character.skeleton);
        for (const Clip& clip : character.clips) {
            EXPECT_EQ(whyInvalid(clip, character.skeleton), "") << name << " " << clip.name;
            LocalPose pose = restPose(character.skeleton);
            sample(clip, 0.5f * clip.seconds, pose);
            const std::vector<Pose> world = writePose(character.skeleton, pose);
            EXPECT_LT(length(toVec3(world[0].position) - character.skeleton.bones[0].bind.position),
                      5 * character.height)
                << name << " " << clip.name;
            for (const Segment& segment : anatomy.segments) {
                if (segment.role != BodyRole::shank && segment.role != BodyRole::forearm) continue;
                const auto bone = static_cast<std::size_t>(segment.bone);
                const auto upper = static_cast<std::size_t>(character.skeleton.bones[bone].parent);
                const float rest = length(character.skeleton.bones[bone].bind.position -
                                          character.skeleton.bones[upper].bind.position);
                const float now = length(toVec3(world[bone].position - world[upper].position));
                EXPECT_NEAR(now, rest, 0.02f * rest) << name << " " << clip.name;
            }
        }
    }
}

TEST(Clips, OfARigAtRestKeepItWhereItIs) {
    const Character character = loadCharacter(rig("human_motion_centimetres.bvh"));
    ASSERT_EQ(character.clips.size(), 1u);
    LocalPose pose = restPose(character.skeleton);
    sample(character.clips[0], 0, pose);
    const std::vector<Pose> world = writePose(character.skeleton, pose);
    for (std::size_t i = 0; i < world.size(); ++i)
        EXPECT_LT(length(toVec3(world[i].position) - character.skeleton.bones[i].bind.position), 1e-4f)
            << character.skeleton.bones[i].name;
}

}  // namespace
}  // namespace ragtop
