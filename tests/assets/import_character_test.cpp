#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "import_support.h"
#include "ragtop/character.h"
#include "ragtop/world.h"

namespace ragtop {
namespace {

/// A face for each three corners of a hull that have no other corner before them.
bool insideHull(const ConvexHull& hull, const Vec3& point, float slack) {
    static std::map<const HullData*, std::pair<ConvexHull, std::vector<std::pair<Vec3, float>>>> known;
    const auto [at, isNew] = known.emplace(&hull.data(), std::pair{hull, std::vector<std::pair<Vec3, float>>{}});
    auto& planes = at->second.second;
    const std::span<const Vec3> v = hull.vertices();
    for (std::size_t i = 0; isNew && i < v.size(); ++i)
        for (std::size_t j = 0; j < v.size(); ++j)
            for (std::size_t k = 0; k < v.size(); ++k) {
                const Vec3 normal = normalized(cross(v[j] - v[i], v[k] - v[i]));
                const float offset = dot(normal, v[i]) + slack;
                if (length(cross(v[j] - v[i], v[k] - v[i])) > 0 &&
                    std::ranges::all_of(v, [&](const Vec3& each) { return dot(normal, each) <= offset; }))
                    planes.emplace_back(normal, offset);
            }
    return std::ranges::all_of(planes, [&](const auto& plane) { return dot(plane.first, point) <= plane.second; });
}

bool inside(const RagdollPart& part, const Vec3& point) {
    const Vec3 local = inverseTransformPoint(part.bind * part.frame, point);
    constexpr float kSlack = 1e-4f;
    if (const auto* capsule = std::get_if<Capsule>(&part.shape)) {
        const float y = local.y - std::clamp(local.y, -capsule->halfHeight, capsule->halfHeight);
        return length({local.x, y, local.z}) <= capsule->radius + kSlack;
    }
    if (const auto* hull = std::get_if<ConvexHull>(&part.shape)) return insideHull(*hull, local, kSlack);
    const Vec3 out = abs(local) - std::get<Box>(part.shape).halfExtents;
    return out.x <= kSlack && out.y <= kSlack && out.z <= kSlack;
}

enum class Build { human, stylised };

/// The part whose shape holds a vertex of another: itself, or, of a shank, its foot, since trousers end over shoes, and
/// shanks above the ground; −1 where neither does.
int holderOf(const RagdollDef& def, std::size_t part, const Vec3& vertex) {
    if (inside(def.parts[part], vertex)) return static_cast<int>(part);
    for (const RagdollJoint& joint : def.joints) {
        const RagdollPart& child = def.parts[static_cast<std::size_t>(joint.child)];
        if (static_cast<std::size_t>(joint.parent) == part && child.role == BodyRole::foot && inside(child, vertex))
            return joint.child;
    }
    return -1;
}

/// What holds for the ragdoll of every human: parts, mass, fit, no limit violated at rest.
void expectSoundHuman(const Character& character, Build build) {
    const RagdollDef def = build == Build::human ? makeRagdoll(character, {.bodyMass = 75}) : makeRagdoll(character);
    EXPECT_EQ(whyInvalid(def), "");
    EXPECT_GE(def.parts.size(), 12u);
    EXPECT_LE(def.parts.size(), 22u);
    double sum = 0;
    for (const RagdollPart& part : def.parts) {
        sum += static_cast<double>(part.mass);
        EXPECT_NE(part.role, BodyRole::other);
        const float density = part.mass / massOf(part.shape, 1.0f).mass;
        EXPECT_GE(density, 0.999f * 300) << part.name;
        EXPECT_LE(density, 1.001f * 2000) << part.name;
        if (build == Build::stylised) continue;
        EXPECT_NEAR(part.mass, 75 * massShare(part.role, 0), 0.01 * 75 * massShare(part.role, 0)) << part.name;
    }
    if (build == Build::human) {
        EXPECT_NEAR(sum, 75.0, 75e-5);
    }

    std::vector<int> owned(def.parts.size(), 0), contained(def.parts.size(), 0);
    std::vector<std::vector<Vec3>> skin(def.parts.size());
    for (std::size_t bone = 0; bone < character.skeleton.bones.size(); ++bone) {
        const auto part = static_cast<std::size_t>(def.bones[bone].part);
        for (const Vec3& vertex : character.skeleton.skin[bone]) {
            const int holder = holderOf(def, part, vertex);
            ++owned[part];
            contained[part] += holder >= 0;
            skin[part].push_back(vertex);
            if (holder >= 0 && holder != static_cast<int>(part))
                skin[static_cast<std::size_t>(holder)].push_back(vertex);
        }
    }
    for (std::size_t i = 0; i < owned.size(); ++i) EXPECT_GE(10 * contained[i], 9 * owned[i]) << def.parts[i].name;
    // Shanks in trousers end over what hangs lower: a ring of cloth about the shoe, whose shape holds both.
    for (std::size_t i = 0; i < skin.size(); ++i) {
        const RagdollPart& part = def.parts[i];
        if (owned[i] < 12 || part.role == BodyRole::shank) continue;
        // One shape for both feet, whose skins differ a little, takes a hundredth more.
        const float whole = part.role == BodyRole::foot ? 1.26f : 1.25f;
        const float most = static_cast<int>(skin[i].size()) > owned[i] ? 1.5f : whole;
        EXPECT_LE(massOf(part.shape, 1).mass, most * massOf(ConvexHull(skin[i]), 1).mass) << part.name;
    }

    for (const RagdollJoint& joint : def.joints) {
        const std::string name = def.parts[static_cast<std::size_t>(joint.child)].name;
        const JointBodies& bodies =
            std::visit([](const auto& each) -> const JointBodies& { return each.bodies; }, joint.joint);
        const Frame a = def.parts[static_cast<std::size_t>(joint.parent)].bind * bodies.frameA;
        const Frame b = def.parts[static_cast<std::size_t>(joint.child)].bind * bodies.frameB;
        EXPECT_LT(length(a.position - b.position), 1e-5f * character.height) << name;
        const Quat q = conjugate(a.rotation) * b.rotation;
        const float along = dot(rotate(a.rotation, {1, 0, 0}), rotate(b.rotation, {1, 0, 0}));
        EXPECT_NEAR(2 * std::atan2(q.x, q.w), 0, 1e-4f) << name;
        if (const auto* ball = std::get_if<BallDef>(&joint.joint)) {
            EXPECT_LT(std::acos(std::min(along, 1.0f)), *ball->swingLimit) << name;
        } else {
            EXPECT_NEAR(along, 1.0f, 1e-5f) << name;
        }
    }
}

const RagdollPart& partOf(const RagdollDef& def, BodyRole role, BodySide side) {
    for (const RagdollPart& part : def.parts)
        if (part.role == role && part.side == side) return part;
    throw std::out_of_range("no such part");
}

TEST(LoadCharacter, BcnEpilepticIsAHumanOf54Bones) {
    RAGTOP_MODEL(file, "X/BCN_Epileptic.X");
    const Character character = loadCharacter(file);
    EXPECT_EQ(character.skeleton.bones.size(), 54u);
    EXPECT_GE(character.height, 1.80f);
    EXPECT_LE(character.height, 1.95f);
    EXPECT_EQ(character.skin.triangles, 5126);
    EXPECT_EQ(character.clips.size(), 1u);
    expectSoundHuman(character, Build::human);
    const RagdollDef def = makeRagdoll(character);
    const RagdollPart& foot = partOf(def, BodyRole::foot, BodySide::left);
    const RagdollPart& head = partOf(def, BodyRole::head, BodySide::middle);
    EXPECT_EQ(foot.name, "B_Ankle_Left");
    EXPECT_LT(foot.bind.position.y, boundsOf(character.skeleton).lower.y + 0.1f * character.height);
    EXPECT_GT(head.bind.position.y - foot.bind.position.y, 0.7f * character.height);
}

TEST(LoadCharacter, FbxCentimetresBecomeMetresOnce) {
    RAGTOP_SAMPLE(file, "characters/arnaud.fbx");
    const Character character = loadCharacter(file);
    EXPECT_EQ(character.skeleton.bones.size(), 53u);
    EXPECT_FLOAT_EQ(character.metersPerUnit, 0.01f);
    EXPECT_NEAR(character.height, 1.83f, 0.0183f);
    expectSoundHuman(character, Build::human);
    const RagdollDef def = makeRagdoll(character);
    EXPECT_EQ(partOf(def, BodyRole::upperArm, BodySide::left).name, "LeftArm");
    EXPECT_EQ(partOf(def, BodyRole::upperArm, BodySide::right).name, "RightArm");
    EXPECT_EQ(partOf(def, BodyRole::shank, BodySide::right).name, "RightLeg");
}

TEST(LoadCharacter, CesiumManHasUnnamedJointsAndWeightsThatDoNotSumToOne) {
    RAGTOP_SAMPLE(file, "characters/cesium_man.gltf");
    const Character character = loadCharacter(file);
    EXPECT_EQ(character.skeleton.bones.size(), 19u);
    EXPECT_NEAR(character.height, 1.51f, 0.0151f);
    EXPECT_EQ(character.skin.vertices, 3273);
    EXPECT_EQ(character.skin.renormalized, 210);
    EXPECT_NEAR(character.skin.leastSum, 0.185f, 1e-3f);
    EXPECT_TRUE(warns(character, "normalised"));
    // Its head is a third of it.
    expectSoundHuman(character, Build::stylised);
}

TEST(LoadCharacter, KnightLosesItsControlBones) {
    RAGTOP_SAMPLE(file, "characters/knight.glb");
    const Character character = loadCharacter(file);
    EXPECT_EQ(character.skeleton.bones.size(), 20u);
    EXPECT_EQ(character.skeleton.find("kneeIK.l"), -1);
    EXPECT_TRUE(warns(character, "move no vertex"));
    EXPECT_EQ(character.clips.size(), 76u);
    const int walk = character.findClip("Walking_A");
    ASSERT_GE(walk, 0);
    EXPECT_GT(character.clips[static_cast<std::size_t>(walk)].seconds, 0.2f);
    EXPECT_GT(character.height, 2.2f);
    EXPECT_LT(character.height, 2.7f);
    expectSoundHuman(character, Build::stylised);
}

TEST(LoadCharacter, ABeastThatIsRiggedFromTheChestIsAQuadruped) {
    RAGTOP_MODEL(file, "X/Testwuson.X");
    const Character character = loadCharacter(file);
    const Anatomy anatomy = recognise(character.skeleton);
    EXPECT_EQ(anatomy.plan, BodyPlan::quadruped) << anatomy.note;
    EXPECT_EQ(anatomy.segments.front().role, BodyRole::chest);
    const RagdollDef def = makeRagdoll(character, {.bodyMass = 200});
    EXPECT_EQ(whyInvalid(def), "");
    EXPECT_GE(def.parts.size(), 12u);
    EXPECT_LE(def.parts.size(), 24u);
}

TEST(LoadCharacter, PosedNodesDoNotChangeTheBindPose) {
    RAGTOP_MODEL(file, "FBX/animation_with_skeleton.fbx");
    const Character character = loadCharacter(file);
    EXPECT_TRUE(warns(character, "bind pose"));
    EXPECT_TRUE(warns(character, "normalised"));
    // A straight row of bones at rest; its nodes are bent by metres.
    const Bounds bounds = boundsOf(character.skeleton);
    EXPECT_LT(bounds.upper.y - bounds.lower.y, 2.0f);
}

TEST(LoadCharacter, MotionAloneIsASkeletonWhoseUnitIsGuessedAndSaid) {
    RAGTOP_MODEL(file, "BVH/01_01.bvh");
    const Character raw = loadCharacter(file);
    EXPECT_TRUE(warns(raw, "does not say its units"));
    EXPECT_GT(raw.height, 1.2f);
    EXPECT_LT(raw.height, 2.2f);
    const Character character = loadCharacter(file, {.metersPerUnit = 0.0564f});
    EXPECT_FALSE(warns(character, "units"));
    EXPECT_TRUE(character.skeleton.skin.empty());
    EXPECT_NEAR(character.height, 0.0564f / raw.metersPerUnit * raw.height, 1e-4f);
    const RagdollDef def = makeRagdoll(character);
    EXPECT_EQ(def.parts.size(), 16u);
    // Its hip joints are in the middle of the pelvis, and its thighs begin where they end.
    EXPECT_EQ(partOf(def, BodyRole::thigh, BodySide::left).name, "LeftUpLeg");
}

/// A stick figure of 17 joints with the axes of a format whose z points up.
std::string zUpMotion() {
    std::string text = "HIERARCHY\nROOT Hips\n{\n OFFSET 0 0 1.0\n CHANNELS 3 Zrotation Xrotation Yrotation\n";
    int open = 0;
    const auto joint = [&](const char* name, const char* offset) {
        text += std::string("JOINT ") + name + "\n{\n OFFSET " + offset;
        text += "\n CHANNELS 3 Zrotation Xrotation Yrotation\n";
        ++open;
    };
    const auto end = [&](const char* offset) {
        text += std::string("End Site\n{\n OFFSET ") + offset + "\n}\n";
        for (; open > 0; --open) text += "}\n";
    };
    for (const char* x : {"0.1", "-0.1"}) {
        joint("a", (std::string(x) + " 0 -0.05").c_str());
        joint("b", "0 0 -0.42");
        joint("c", "0 0.02 -0.42");
        end("0 -0.15 -0.06");
    }
    joint("d", "0 0 0.12");
    joint("e", "0 0 0.15");
    open = 0;
    for (const char* x : {"", "-"}) {
        const std::string sign(x);
        joint("f", (sign + "0.19 0 0.22").c_str());
        joint("g", (sign + "0.31 0 0").c_str());
        joint("h", (sign + "0.25 0 0").c_str());
        end((sign + "0.15 0 0").c_str());
    }
    joint("i", "0 0 0.26");
    end("0 0 0.25");
    text += "}\n}\n}\nMOTION\nFrames: 1\nFrame Time: 0.033\n";
    for (int i = 0; i < 3 * 16; ++i) text += "0 ";
    return text + "\n";
}

TEST(LoadCharacter, SaysOnceWhatIsWrongWithSeveralBones) {
    RAGTOP_MODEL(file, "X/anim_test.x");
    const Character character = loadCharacter(file);
    EXPECT_TRUE(warns(character, "2 bones have no node and are left out, such as 'joint3'"));
}

TEST(LoadCharacter, CamerasAndTheirTargetsAreNoBones) {
    RAGTOP_SAMPLE(file, "characters/arnaud_walk.fbx");
    const Character character = loadCharacter(file);
    EXPECT_EQ(recognise(character.skeleton).plan, BodyPlan::human);
    EXPECT_NEAR(character.height, 1.83f, 0.1f);
    for (const Bone& bone : character.skeleton.bones)
        EXPECT_EQ(bone.name.find("amera"), std::string::npos) << bone.name;
}

TEST(LoadCharacter, AHumanThatStandsAlongZIsTurnedUpright) {
    const TemporaryFile file("z_up.bvh", zUpMotion());
    const Character character = loadCharacter(file.path());
    EXPECT_EQ(character.upAxis, UpAxis::z);
    EXPECT_TRUE(warns(character, "stands along z"));
    EXPECT_NEAR(character.height, 0.95f + 0.78f, 1e-4f);
    const Anatomy anatomy = recognise(character.skeleton);
    ASSERT_TRUE(anatomy.isHuman()) << anatomy.note;
    EXPECT_GT(anatomy.up.y, 0.99f);
    // Toes point along −y of the file, which is +z once z is up no more.
    EXPECT_GT(anatomy.forward.z, 0.99f);
    const Character lying = loadCharacter(file.path(), {.upAxis = UpAxis::y});
    EXPECT_LT(lying.height, 0.5f);
}

TEST(LoadCharacter, RefusesBrokenFilesInOneLine) {
    const auto failure = [](const std::filesystem::path& path) {
        return importError(path, [&] { loadCharacter(path); });
    };
    EXPECT_NE(failure("no_such_file.fbx").find("no such file"), std::string::npos);
    EXPECT_NE(failure(std::filesystem::temp_directory_path()).find("is not a file"), std::string::npos);
    const TemporaryFile garbage("garbage.glb", "glTF and then nothing that makes sense");
    EXPECT_NE(failure(garbage.path()).find("cannot be imported"), std::string::npos);
    const TemporaryFile unknown("unknown.xyzzy", "hello");
    EXPECT_NE(failure(unknown.path()), "");
    const TemporaryFile cube("cube.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    EXPECT_NE(failure(cube.path()).find("no bones"), std::string::npos);
}

/// A motion of as many fingers of three joints on one root.
std::string motionOfFingers(int fingers) {
    const std::string channels = "CHANNELS 3 Zrotation Xrotation Yrotation\n";
    std::string text = "HIERARCHY\nROOT r\n{\nOFFSET 0 0 0\n" + channels;
    for (int i = 0; i < fingers; ++i) {
        for (const char* joint : {"a", "b", "c"})
            text += std::string("JOINT ") + joint + std::to_string(i) + "\n{\nOFFSET 0 1 0\n" + channels;
        text += "}\n}\n}\n";
    }
    text += "}\nMOTION\nFrames: 1\nFrame Time: 0.1\n";
    for (int i = 0; i < 9 * fingers + 3; ++i) text += "0 ";
    return text + "\n";
}

TEST(LoadCharacter, TellsHowManyBonesAreAllowedWhereThereAreMore) {
    const TemporaryFile file("bones.bvh", motionOfFingers(22'000));
    const std::string error = importError(file.path(), [&] { loadCharacter(file.path()); });
    EXPECT_NE(error.find("bones has 66001 entries, at most 65535 are allowed"), std::string::npos) << error;
}

TEST(LoadCharacter, SurvivesTruncatedFiles) {
    RAGTOP_SAMPLE(file, "characters/knight.glb");
    std::ifstream stream(file, std::ios::binary);
    const std::string whole{std::istreambuf_iterator<char>(stream), {}};
    for (const double share : {0.001, 0.1, 0.5, 0.99}) {
        const auto size = static_cast<std::size_t>(share * static_cast<double>(whole.size()));
        const TemporaryFile part("truncated.glb", whole.substr(0, size));
        EXPECT_NE(importError(part.path(), [&] { loadCharacter(part.path()); }), "") << share;
    }
}

TEST(LoadCharacter, RagdollsOfRealRigsSpawnAtRest) {
    RAGTOP_MODEL(human, "X/BCN_Epileptic.X");
    RAGTOP_MODEL(beast, "X/Testwuson.X");
    std::vector<std::filesystem::path> files{human, beast};
    for (const char* name : {"arnaud.fbx", "arnaud_walk.fbx", "cesium_man.gltf", "knight.glb"}) {
        const std::filesystem::path file = std::filesystem::path(RAGTOP_SHARED_DIR) / "data" / "characters" / name;
        if (std::filesystem::exists(file)) files.push_back(file);
    }
    for (const auto& file : files) {
        SCOPED_TRACE(file);
        World world(WorldSettings{.gravity = {0, 0, 0}, .sleeping = false});
        const Ragdoll ragdoll(world, makeRagdoll(loadCharacter(file)));
        for (int i = 0; i < 10; ++i) world.step(1.0 / 60);
        // Nothing acts, so only rounding moves it: a rotation is off by 1e-7 rad, and 1/240 s is a substep.
        for (const BodyId body : ragdoll.bodies()) {
            EXPECT_LT(length(world.linearVelocity(body)), 240 * 1e-6f);
            EXPECT_LT(length(world.angularVelocity(body)), 240 * 1e-6f);
        }
    }
}

TEST(DescribeAsset, NamesUnitsSizeBonesAndWarnings) {
    RAGTOP_SAMPLE(file, "characters/arnaud.fbx");
    const Character character = loadCharacter(file);
    const std::string text = describeAsset(character) + describeAsset(makeRagdoll(character, {.bodyMass = 75}));
    for (const char* word :
         {"human", "% sure", "0.01 m per unit", "1.831 m", "53", "LeftUpLeg", "hull of", "hinge", "75.000 kg"})
        EXPECT_NE(text.find(word), std::string::npos) << word << "\n" << text;
}

TEST(FindAsset, NamesWhatToInstall) {
    EXPECT_THROW(findAsset("assimp-testmodels:no/such/file"), AssetError);
    EXPECT_THROW(findAsset("no/such/file"), AssetError);
    const TemporaryFile file("found.txt", "x");
    EXPECT_EQ(findAsset(file.path().string()), file.path());
}

}  // namespace
}  // namespace ragtop
