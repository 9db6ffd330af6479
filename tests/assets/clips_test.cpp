#include <array>
#include <cmath>
#include <limits>

#include "import_support.h"
#include "ragtop/character.h"
#include "ragtop/compressed_clip.h"
#include "ragtop/retarget.h"
#include "ragtop/world.h"

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

TEST(Clips, OfRealFilesAreEachCompressedToASixthWithinAMillimetre) {
    const std::filesystem::path folder = std::filesystem::path(RAGTOP_SHARED_DIR) / "data" / "characters";
    if (!std::filesystem::exists(folder)) GTEST_SKIP() << "no samples in " << folder;
    for (const std::filesystem::path& file :
         {folder / "arnaud_walk.fbx", folder / "cesium_man.gltf", folder / "knight.glb",
          std::filesystem::path("/usr/share/assimp/models/X/BCN_Epileptic.X")}) {
        if (!std::filesystem::exists(file)) continue;
        const Character character = loadCharacter(file);
        const LocalPose rest = restPose(character.skeleton);
        LocalPose exact = rest, read = rest;
        for (const Clip& clip : character.clips) {
            const CompressedClip made(clip, character.skeleton);
            EXPECT_LE(made.error(), 0.001f) << file << " " << clip.name;
            std::size_t before = 0;
            for (const ClipTrack& track : clip.tracks) before += track.times.size() * (sizeof(float) + sizeof(Frame));
            EXPECT_LE(6 * made.bytes(), before) << file << " " << clip.name;
            // Between the times at which it is measured, too.
            double worst = 0;
            for (float time = 0; time <= clip.seconds; time += 0.011f) {
                sample(clip, time, exact);
                sample(made, rest, time, read);
                const std::vector<Pose> a = writePose(character.skeleton, exact),
                                        b = writePose(character.skeleton, read);
                for (std::size_t i = 0; i < a.size(); ++i)
                    worst = std::max(worst, static_cast<double>(length(relative(a[i].position, b[i].position))));
            }
            EXPECT_LE(worst, 0.0011) << file << " " << clip.name;
        }
    }
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

/// How far points of a foot that are on the ground move along it until they leave it, at most, m.
class Slide {
public:
    explicit Slide(float ground) : ground_(ground) {}
    void see(const Vec3& point) {
        const bool stands = point.y < ground_;
        if (stands && !stood_) first_ = point;
        if (stands) most_ = std::max(most_, length(Vec3{point.x - first_.x, 0, point.z - first_.z}));
        stood_ = stands;
    }
    float most() const { return most_; }

private:
    float ground_, most_ = 0;
    bool stood_ = false;
    Vec3 first_;
};

struct FootPoint {
    int bone;
    Vec3 inBone, atRest;
};

/// Of feet that stand on four corners, on the middle of the sole: its heel, and where toes begin or, without any, its
/// tip.
std::vector<FootPoint> solesOf(const RagdollDef& def) {
    std::vector<FootPoint> points;
    for (std::size_t k = 0; k < def.parts.size(); ++k) {
        const RagdollPart& part = def.parts[k];
        if (part.role != BodyRole::foot) continue;
        const Vec3 ankle = part.bind.position;
        std::vector<Vec3> corners;
        if (const auto* hull = std::get_if<ConvexHull>(&part.shape)) {
            corners.assign(hull->vertices().begin(), hull->vertices().end());
        } else {
            const Vec3 half = std::get<Box>(part.shape).halfExtents;
            for (int i = 0; i < 8; ++i)
                corners.push_back(scale(half, {i & 1 ? 1.0f : -1.0f, i & 2 ? 1.0f : -1.0f, i & 4 ? 1.0f : -1.0f}));
        }
        for (Vec3& corner : corners) corner = transformPoint(part.bind * part.frame, corner);
        std::sort(corners.begin(), corners.end(), [](const Vec3& a, const Vec3& b) { return a.y < b.y; });
        corners.resize(4);
        const auto away = [&](const Vec3& a) { return length(Vec3{a.x - ankle.x, 0, a.z - ankle.z}); };
        std::sort(corners.begin(), corners.end(), [&](const Vec3& a, const Vec3& b) { return away(a) < away(b); });
        const Vec3 heel = 0.5f * (corners[0] + corners[1]), tip = 0.5f * (corners[2] + corners[3]);
        Vec3 front = tip;
        for (const RagdollBone& bone : def.bones) {
            if (bone.parent != part.bone || bone.part != static_cast<int>(k)) continue;
            const Vec3 toe = transformPoint(part.bind, bone.inPart.position);
            const float share = dot(toe - heel, tip - heel) / lengthSquared(tip - heel);
            front = tip + (1 - share) * (heel - tip);
            break;
        }
        for (const Vec3& point : {heel, front})
            points.push_back({part.bone, inverseTransformPoint(part.bind, point), point});
    }
    return points;
}

TEST(Clips, OfAWalkAreWalkedByOtherBodiesOnFeetThatStand) {
    const std::filesystem::path folder = std::filesystem::path(RAGTOP_SHARED_DIR) / "data" / "characters";
    const std::filesystem::path models = "/usr/share/assimp/models/X/BCN_Epileptic.X";
    if (!std::filesystem::exists(folder / "arnaud_walk.fbx")) GTEST_SKIP() << "no samples in " << folder;
    const Character walker = loadCharacter(folder / "arnaud_walk.fbx");
    const RagdollDef from = makeRagdoll(walker);
    for (const auto& file : {folder / "arnaud.fbx", folder / "cesium_man.gltf", folder / "knight.glb", models}) {
        if (!std::filesystem::exists(file)) continue;
        const Character other = loadCharacter(file);
        const RagdollDef to = makeRagdoll(other);
        const Retargeted made = retarget(walker.clips[0], from, to);
        EXPECT_EQ(made.stances, 3) << file;
        const std::vector<FootPoint> points = solesOf(to);
        float ground = std::numeric_limits<float>::infinity();
        for (const FootPoint& point : points) ground = std::min(ground, point.atRest.y);
        std::vector<Slide> slides(points.size(), Slide(ground + 0.002f));
        World world;
        LocalPose pose = restPose(other.skeleton);
        for (float time = 0; time <= made.clip.seconds; time += 1.0f / 240) {
            sample(made.clip, time, pose);
            const std::vector<Pose> bones = writePose(other.skeleton, pose);
            const Ragdoll body(world, to, bones);
            EXPECT_TRUE(body.beyondLimits(2e-3f).empty()) << file << " at " << time;
            for (std::size_t k = 0; k < points.size(); ++k)
                slides[k].see(
                    toVec3(transformPoint(bones[static_cast<std::size_t>(points[k].bone)], points[k].inBone)));
        }
        for (const Slide& slide : slides) EXPECT_LT(slide.most(), 0.01f) << file;
        // It goes on where it began.
        sample(made.clip, 0, pose);
        LocalPose last = restPose(other.skeleton);
        sample(made.clip, made.clip.seconds, last);
        for (std::size_t i = 1; i < pose.bones.size(); ++i)
            EXPECT_LT(length(rotationVector(conjugate(pose.bones[i].rotation) * last.bones[i].rotation)), 0.03f)
                << file << " " << i;
    }
}

}  // namespace
}  // namespace ragtop
