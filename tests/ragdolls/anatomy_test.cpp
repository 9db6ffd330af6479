#include "ragtop/anatomy.h"

#include <gtest/gtest.h>

#include <array>
#include <stdexcept>
#include <vector>

#include "bone_names.h"
#include "human.h"

namespace ragtop {
namespace {

const Segment* find(const Anatomy& anatomy, BodyRole role, BodySide side) {
    for (const Segment& segment : anatomy.segments)
        if (segment.role == role && segment.side == side) return &segment;
    return nullptr;
}

void expectHuman(const Anatomy& anatomy, const HumanRig& rig) {
    ASSERT_TRUE(anatomy.isHuman()) << anatomy.note;
    EXPECT_EQ(anatomy.segments.size(), 16u);
    EXPECT_EQ(anatomy.segments.front().bone, rig.hips);
    for (int side = 0; side < 2; ++side) {
        const BodySide body = side == 0 ? BodySide::left : BodySide::right;
        const auto expect = [&](BodyRole role, int bone) {
            const Segment* segment = find(anatomy, role, body);
            ASSERT_NE(segment, nullptr) << nameOf(role) << " " << nameOf(body);
            EXPECT_EQ(segment->bone, bone) << nameOf(role) << " " << nameOf(body);
        };
        expect(BodyRole::upperArm, rig.upperArm[side]);
        expect(BodyRole::forearm, rig.forearm[side]);
        expect(BodyRole::hand, rig.hand[side]);
        expect(BodyRole::thigh, rig.thigh[side]);
        expect(BodyRole::shank, rig.shank[side]);
        expect(BodyRole::foot, rig.foot[side]);
    }
    EXPECT_EQ(find(anatomy, BodyRole::abdomen, BodySide::middle)->bone, rig.spine);
    EXPECT_EQ(find(anatomy, BodyRole::chest, BodySide::middle)->bone, rig.chest);
    EXPECT_EQ(find(anatomy, BodyRole::head, BodySide::middle)->bone, rig.neck);
}

TEST(Anatomy, FindsAHumanWithoutNames) {
    const HumanRig rig;
    const Anatomy anatomy = recognise(rig.skeleton);
    expectHuman(anatomy, rig);
    EXPECT_GT(anatomy.up.y, 0.99f);
    EXPECT_GT(anatomy.forward.z, 0.99f);
    EXPECT_GT(anatomy.left.x, 0.99f);
}

TEST(Anatomy, FindsAHumanInAnyDirectionAndSize) {
    for (const Vec3& axis : {Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}, Vec3{1, 2, 3}})
        for (const float angle : {0.5f, 1.5707963f, 3.0f})
            for (const float scale : {0.01f, 1.0f, 100.0f}) {
                HumanRig rig;
                const Quat rotation = rotationAbout(axis, angle);
                rig.transform(rotation, scale);
                const Anatomy anatomy = recognise(rig.skeleton);
                expectHuman(anatomy, rig);
                EXPECT_GT(dot(anatomy.up, rotate(rotation, {0, 1, 0})), 0.99f);
                EXPECT_GT(dot(anatomy.forward, rotate(rotation, {0, 0, 1})), 0.99f);
            }
}

TEST(Anatomy, SkipsTwistBonesWithinTheLimbs) {
    HumanRig rig;
    // A twist bone halfway down each thigh and forearm, in line with the chain.
    Skeleton& skeleton = rig.skeleton;
    for (int side = 0; side < 2; ++side)
        for (const int child : {rig.shank[side], rig.hand[side]}) {
            Bone& below = skeleton.bones[static_cast<std::size_t>(child)];
            const int above = below.parent;
            const Vec3 middle = 0.5f * (below.bind.position + rig.at(above));
            const auto place = skeleton.bones.begin() + child;
            skeleton.bones.insert(place, Bone{"twist", above, {middle, {}}});
            for (std::size_t i = 0; i < skeleton.bones.size(); ++i)
                if (static_cast<int>(i) != child && skeleton.bones[i].parent >= child) ++skeleton.bones[i].parent;
            skeleton.bones[static_cast<std::size_t>(child) + 1].parent = child;
            for (int* index : {&rig.clavicle[0], &rig.clavicle[1], &rig.upperArm[0], &rig.upperArm[1], &rig.forearm[0],
                               &rig.forearm[1], &rig.hand[0], &rig.hand[1], &rig.thigh[0], &rig.thigh[1], &rig.shank[0],
                               &rig.shank[1], &rig.foot[0], &rig.foot[1]})
                if (*index >= child) ++*index;
        }
    ASSERT_EQ(whyInvalid(skeleton), "");
    expectHuman(recognise(skeleton), rig);
}

TEST(Anatomy, WithoutToesNamedSidesTellForward) {
    HumanRig rig;
    Skeleton feetless = rig.skeleton;
    for (int side = 0; side < 2; ++side) {
        feetless.bones[static_cast<std::size_t>(rig.toe[side])].bind.position = rig.at(rig.foot[side]);
        feetless.bones[static_cast<std::size_t>(rig.thigh[side])].name = side == 0 ? "Thigh.R" : "Thigh.L";
    }
    // The sides are named the other way round, so the person faces the other way.
    const Anatomy anatomy = recognise(feetless);
    ASSERT_TRUE(anatomy.isHuman());
    EXPECT_LT(anatomy.forward.z, -0.99f);
    EXPECT_EQ(anatomy.note, "");
}

TEST(Anatomy, FourLegsOfEqualLengthAreAQuadruped) {
    Skeleton dog;
    const auto add = [&](int parent, Vec3 position) {
        dog.bones.push_back({"b", parent, {position, {}}});
        return static_cast<int>(dog.bones.size()) - 1;
    };
    const int pelvis = add(-1, {0, 0.6f, -0.4f});
    const int chest = add(add(pelvis, {0, 0.62f, 0}), {0, 0.6f, 0.4f});
    add(add(chest, {0, 0.7f, 0.6f}), {0, 0.75f, 0.8f});
    for (const int from : {pelvis, chest})
        for (const float x : {0.1f, -0.1f}) {
            const float z = from == pelvis ? -0.4f : 0.4f;
            add(add(add(from, {x, 0.55f, z}), {x, 0.3f, z + 0.05f}), {x, 0.05f, z});
        }
    const Anatomy anatomy = recognise(dog);
    EXPECT_EQ(anatomy.plan, BodyPlan::quadruped) << anatomy.note;
    EXPECT_EQ(anatomy.segments.front().bone, pelvis);
    EXPECT_EQ(anatomy.segments.front().role, BodyRole::pelvis);
    EXPECT_GT(anatomy.forward.z, 0.99f);
    EXPECT_GT(anatomy.up.y, 0.99f);
    for (const BodyRole role :
         {BodyRole::thigh, BodyRole::shank, BodyRole::upperArm, BodyRole::forearm, BodyRole::chest})
        EXPECT_TRUE(anatomy.find(role, role == BodyRole::chest ? BodySide::middle : BodySide::left) >= 0)
            << nameOf(role);
}

TEST(Anatomy, RolesOfAMapAreTakenForGranted) {
    const HumanRig rig;
    const auto name = [&](int bone) { return rig.skeleton.bones[static_cast<std::size_t>(bone)].name; };
    // The clavicle for the upper arm, and the other side for the left.
    const std::vector<BoneRole> roles{{name(rig.clavicle[0]), BodyRole::upperArm, BodySide::right},
                                      {name(rig.forearm[0]), BodyRole::forearm, BodySide::right},
                                      {name(rig.spine), BodyRole::pelvis}};
    const Anatomy anatomy = recognise(rig.skeleton, roles);
    ASSERT_TRUE(anatomy.isHuman());
    const int arm = anatomy.find(BodyRole::upperArm, BodySide::right);
    ASSERT_GE(arm, 0);
    EXPECT_EQ(anatomy.segments[static_cast<std::size_t>(arm)].bone, rig.clavicle[0]);
    EXPECT_EQ(anatomy.segments[static_cast<std::size_t>(arm)].confidence, 1);
    EXPECT_EQ(anatomy.segments[static_cast<std::size_t>(anatomy.find(BodyRole::pelvis))].bone, rig.spine);
}

TEST(Anatomy, RefusesRolesThatCannotBe) {
    const HumanRig rig;
    const auto message = [&](const BoneRole& role) -> std::string {
        try {
            recognise(rig.skeleton, std::array{role});
        } catch (const std::invalid_argument& error) {
            return error.what();
        }
        return {};
    };
    EXPECT_EQ(message({"nobody", BodyRole::head}),
              "roles[0].bone is \"nobody\", must be the name of a bone of the skeleton");
    const std::string head = rig.skeleton.bones[static_cast<std::size_t>(rig.head)].name;
    EXPECT_EQ(message({head, BodyRole::foot, BodySide::left}),
              "roles[0]: bone \"" + head + "\" cannot be the left foot of this human");
}

TEST(Anatomy, NamesAndProportionsThatAgreeAreSurerThanProportionsAlone) {
    const HumanRig nameless;
    HumanRig named;
    const auto call = [&](int bone, const char* name) {
        named.skeleton.bones[static_cast<std::size_t>(bone)].name = name;
    };
    call(named.thigh[0], "LeftThigh");
    call(named.shank[0], "LeftShin");
    const Anatomy with = recognise(named.skeleton), without = recognise(nameless.skeleton);
    for (const Anatomy* anatomy : {&with, &without}) {
        EXPECT_GT(anatomy->confidence, 0.5f);
        EXPECT_LE(anatomy->confidence, 1.0f);
    }
    const auto sure = [](const Anatomy& anatomy) {
        return anatomy.segments[static_cast<std::size_t>(anatomy.find(BodyRole::thigh, BodySide::left))].confidence;
    };
    EXPECT_GT(sure(with), sure(without));
}

TEST(Anatomy, HairOfSixtyThousandBonesHidesNoHuman) {
    HumanRig rig;
    const int scalp = rig.head;
    for (int strand = 0; strand < 3000; ++strand) {
        int bone = scalp;
        const float angle = 0.01f * static_cast<float>(strand);
        for (int i = 0; i < 20; ++i) {
            const Vec3 out{sinCos(angle).sin, 0.2f - 0.05f * static_cast<float>(i), sinCos(angle).cos};
            bone = rig.add(bone, rig.at(scalp) + 0.1f * out);
        }
    }
    ASSERT_GT(rig.skeleton.bones.size(), 60000u);
    expectHuman(recognise(rig.skeleton), rig);
}

TEST(Anatomy, AThousandLegsAreLookedThroughAndNoHuman) {
    Skeleton centipede;
    int spine = -1;
    for (int i = 0; i < 500; ++i) {
        const float z = 0.1f * static_cast<float>(i);
        centipede.bones.push_back({"s", spine, {{0, 0.1f, z}, {}}});
        spine = static_cast<int>(centipede.bones.size()) - 1;
        for (const float x : {6.0f, -6.0f}) {
            int leg = spine;
            for (int k = 1; k <= 3; ++k) {
                centipede.bones.push_back({"l", leg, {{x * static_cast<float>(k), 0.1f, z}, {}}});
                leg = static_cast<int>(centipede.bones.size()) - 1;
            }
        }
    }
    const Anatomy anatomy = recognise(centipede);
    EXPECT_FALSE(anatomy.isHuman());
    EXPECT_LE(anatomy.segments.size(), 100u);
}

TEST(Anatomy, SegmentMassesSumToTheBody) {
    for (const double female : {0.0, 0.5, 1.0}) {
        double sum = 0;
        for (const BodyRole role : {BodyRole::pelvis, BodyRole::abdomen, BodyRole::chest, BodyRole::head})
            sum += massShare(role, female);
        for (const BodyRole role :
             {BodyRole::upperArm, BodyRole::forearm, BodyRole::hand, BodyRole::thigh, BodyRole::shank, BodyRole::foot})
            sum += 2 * massShare(role, female);
        // The table's columns of two decimals sum to 100.00 and 99.99.
        EXPECT_NEAR(sum, 1.0, 2e-4);
    }
}

TEST(Anatomy, RefusesBrokenSkeletons) {
    Skeleton none;
    EXPECT_THROW(recognise(none), std::invalid_argument);
    Skeleton loop;
    loop.bones = {{"a", -1, {}}, {"b", 1, {}}};
    EXPECT_NE(whyInvalid(loop).find("bones[1] (b).parent is 1"), std::string::npos);
    Skeleton turned;
    turned.bones = {{"a", -1, {{}, {0, 0, 0, 2}}}};
    EXPECT_NE(whyInvalid(turned).find("must be 1"), std::string::npos);
    Skeleton skinned;
    skinned.bones = {{"a", -1, {}}};
    skinned.skin.resize(2);
    EXPECT_NE(whyInvalid(skinned).find("one per bone"), std::string::npos);
    // Squares of what is finite may not be: a search for a capsule about such a vertex would not end.
    for (const float far : {2e6f, 1e20f, 3e38f}) {
        Skeleton vast = HumanRig().skeleton;
        vast.bones[1].bind.position.y = far;
        EXPECT_NE(whyInvalid(vast).find("bones[1] (b1).bind.position is more than 1e6 m"), std::string::npos);
        vast = HumanRig().skeleton;
        vast.skin.assign(vast.bones.size(), std::vector<Vec3>(20, {0, 1, 0}));
        vast.skin[2][7].z = -far;
        EXPECT_NE(whyInvalid(vast).find("skin[2] has a vertex that is more than 1e6 m"), std::string::npos);
        EXPECT_THROW(makeRagdoll(vast), std::invalid_argument);
    }
}

TEST(BoneNames, SpeakOfJoints) {
    const auto hintOf = [](const char* name) { return readName(name).hint; };
    const auto sideOf = [](const char* name) { return readName(name).side; };
    EXPECT_EQ(hintOf("LeftForeArm"), NameHint::elbow);
    EXPECT_EQ(hintOf("lowerarm.l"), NameHint::elbow);
    EXPECT_EQ(hintOf("Bip01 L Thigh"), NameHint::hip);
    EXPECT_EQ(hintOf("B_Ankle_Left"), NameHint::ankle);
    EXPECT_EQ(hintOf("LeftHip"), NameHint::hip);
    EXPECT_EQ(hintOf("Hips"), NameHint::pelvis);
    EXPECT_EQ(hintOf("Joint10"), NameHint::none);
    EXPECT_EQ(hintOf("Armature"), NameHint::none);
    EXPECT_EQ(sideOf("Bip01 L Thigh"), -1);
    EXPECT_EQ(sideOf("foot.r"), 1);
    EXPECT_EQ(sideOf("RightFoot"), 1);
    EXPECT_EQ(sideOf("skull"), 0);
    EXPECT_EQ(readName("FrontLeg_L").end, 1);
    EXPECT_EQ(readName("ForeArm").end, 0);
    EXPECT_EQ(readName("hind_leg.r").end, -1);
    EXPECT_TRUE(readName("cape.003").loose);
    EXPECT_TRUE(readName("foot_ik.l").loose);
    EXPECT_FALSE(readName("bear_chest").loose);
}

TEST(BoneNames, MeanWhatTheOthersOfTheLimbLeaveOpen) {
    const auto hints = [](std::initializer_list<const char*> names) {
        std::vector<NameHint> read;
        for (const char* name : names) read.push_back(readName(name).hint);
        return jointHints(read);
    };
    using enum NameHint;
    const auto list = [](std::initializer_list<NameHint> values) { return std::vector<NameHint>(values); };
    EXPECT_EQ(hints({"LeftUpLeg", "LeftLeg", "LeftFoot"}), list({hip, knee, ankle}));
    EXPECT_EQ(hints({"leg.l", "shin.l", "foot.l"}), list({hip, knee, ankle}));
    EXPECT_EQ(hints({"leg1", "leg2", "leg3"}), list({none, none, none}));
    EXPECT_EQ(hints({"LeftShoulder", "LeftArm", "LeftForeArm", "LeftHand"}), list({clavicle, shoulder, elbow, wrist}));
    EXPECT_EQ(hints({"L_Collar", "L_Shoulder", "L_Elbow"}), list({clavicle, shoulder, elbow}));
}

}  // namespace
}  // namespace ragtop
