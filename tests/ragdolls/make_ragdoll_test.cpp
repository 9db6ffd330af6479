#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <stdexcept>
#include <utility>

#include "fit.h"
#include "human.h"
#include "ragtop/ragdoll.h"
#include "ragtop/world.h"

namespace ragtop {
namespace {

const RagdollPart& part(const RagdollDef& def, BodyRole role, BodySide side) {
    for (const RagdollPart& each : def.parts)
        if (each.role == role && each.side == side) return each;
    throw std::out_of_range("no such part");
}

const RagdollJoint& jointOf(const RagdollDef& def, BodyRole role, BodySide side) {
    for (const RagdollJoint& each : def.joints) {
        const RagdollPart& child = def.parts[static_cast<std::size_t>(each.child)];
        if (child.role == role && child.side == side) return each;
    }
    throw std::out_of_range("no such joint");
}

struct RestState {
    float gap, swing, twist, hinge;
};

/// Angles of a joint with both parts at rest, by the definition of swing and twist: q = q_swing · q_twist about x.
RestState atRest(const RagdollDef& def, const RagdollJoint& joint) {
    const JointBodies& bodies =
        std::visit([](const auto& each) -> const JointBodies& { return each.bodies; }, joint.joint);
    const Frame a = def.parts[static_cast<std::size_t>(joint.parent)].bind * bodies.frameA;
    const Frame b = def.parts[static_cast<std::size_t>(joint.child)].bind * bodies.frameB;
    const Quat q = conjugate(a.rotation) * b.rotation;
    const float swing = std::acos(std::min(1.0f, dot(rotate(a.rotation, {1, 0, 0}), rotate(b.rotation, {1, 0, 0}))));
    const float twist = 2 * std::atan2(q.x, q.w);
    return {length(a.position - b.position), swing, twist, twist};
}

TEST(MakeRagdoll, GivesAHumanSixteenPartsWithTheMassesOfTheTable) {
    const HumanRig rig;
    const RagdollDef def = makeRagdoll(rig.skeleton, {.bodyMass = 75});
    ASSERT_EQ(def.parts.size(), 16u);
    EXPECT_EQ(def.joints.size(), 15u);
    EXPECT_EQ(whyInvalid(def), "");
    float sum = 0;
    for (const RagdollPart& each : def.parts) sum += each.mass;
    EXPECT_NEAR(sum, 75.0f, 75e-4f);
    EXPECT_NEAR(part(def, BodyRole::thigh, BodySide::left).mass, 0.1416f * 75, 0.01f * 0.1416f * 75);
    EXPECT_NEAR(part(def, BodyRole::head, BodySide::middle).mass, 0.0694f * 75, 0.01f * 0.0694f * 75);
}

TEST(MakeRagdoll, SpawnsWithinAllLimits) {
    for (const float turn : {0.0f, 1.0f, 2.5f}) {
        HumanRig rig;
        rig.transform(rotationAbout({1, 2, -1}, turn), 1.0f);
        const RagdollDef def = makeRagdoll(rig.skeleton);
        for (const RagdollJoint& joint : def.joints) {
            const RestState state = atRest(def, joint);
            EXPECT_LT(state.gap, 1e-6f);
            if (const auto* ball = std::get_if<BallDef>(&joint.joint)) {
                EXPECT_LT(state.swing, *ball->swingLimit);
                EXPECT_NEAR(state.twist, 0, 1e-5f);
                EXPECT_LT(ball->twistLimit->lower, 0);
                EXPECT_GT(ball->twistLimit->upper, 0);
            } else {
                const auto& hinge = std::get<HingeDef>(joint.joint);
                EXPECT_NEAR(state.hinge, 0, 1e-5f);
                EXPECT_LE(hinge.limit->lower, 0);
                EXPECT_GT(hinge.limit->upper, 0);
            }
        }
    }
}

TEST(MakeRagdoll, KneesBendBackwardsAndElbowsForwards) {
    const HumanRig rig;
    const RagdollDef def = makeRagdoll(rig.skeleton);
    for (const BodySide side : {BodySide::left, BodySide::right})
        for (const BodyRole role : {BodyRole::shank, BodyRole::forearm}) {
            const RagdollJoint& joint = jointOf(def, role, side);
            const auto& hinge = std::get<HingeDef>(joint.joint);
            const Frame frame = def.parts[static_cast<std::size_t>(joint.parent)].bind * hinge.bodies.frameA;
            // Where the far end goes when the hinge turns by a small positive angle.
            const int side01 = side == BodySide::left ? 0 : 1;
            const Vec3 end = rig.at(role == BodyRole::shank ? rig.foot[side01] : rig.hand[side01]);
            const Vec3 motion = cross(rotate(frame.rotation, {1, 0, 0}), end - frame.position);
            EXPECT_GT(role == BodyRole::shank ? -motion.z : motion.z, 0.2f);
            // 130° and 150° from straight; the rig stands with knees bent by about 6°.
            const float range = (hinge.limit->upper - hinge.limit->lower) * 180 / kPi;
            EXPECT_NEAR(range, role == BodyRole::shank ? 130 : 150, 0.01f);
        }
    const auto& knee = std::get<HingeDef>(jointOf(def, BodyRole::shank, BodySide::left).joint);
    const float bent = std::atan2(0.03f, 0.42f) + std::atan2(0.01f, 0.42f);
    EXPECT_NEAR(-knee.limit->lower, bent, 1e-4f);
}

TEST(MakeRagdoll, HipsReachForwardFartherThanBack) {
    const HumanRig rig;
    const RagdollDef def = makeRagdoll(rig.skeleton);
    const RagdollJoint& joint = jointOf(def, BodyRole::thigh, BodySide::left);
    const auto& hip = std::get<BallDef>(joint.joint);
    const Frame a = def.parts[static_cast<std::size_t>(joint.parent)].bind * hip.bodies.frameA;
    const Vec3 axis = rotate(a.rotation, {1, 0, 0});
    const auto allowed = [&](float forwardDegrees) {
        const SinCos s = sinCos(forwardDegrees * kPi / 180);
        return dot(axis, Vec3{0, -s.cos, s.sin}) >= sinCos(*hip.swingLimit).cos;
    };
    EXPECT_TRUE(allowed(124));
    EXPECT_FALSE(allowed(126));
    EXPECT_TRUE(allowed(-14));
    EXPECT_FALSE(allowed(-16));
}

/// Along a unit vector.
float lowestOf(const RagdollPart& each, const Vec3& up) { return bottomOf({each.shape, each.bind * each.frame}, up); }

/// Wide trousers that cover the shoes, and a coat to the ground: what the body stands on are its feet.
TEST(MakeRagdoll, NothingReachesBelowTheSoles) {
    HumanRig rig;
    rig.skeleton.skin.resize(rig.skeleton.bones.size());
    const auto tube = [&](int bone, const Vec3& middle, float radius, float lower, float upper) {
        for (int i = 0; i < 64; ++i) {
            const SinCos around = sinCos(2 * kPi * static_cast<float>(i) / 16);
            const float share = static_cast<float>(i / 16) / 3;
            rig.skeleton.skin[static_cast<std::size_t>(bone)].push_back(
                {middle.x + radius * around.cos, lower + share * (upper - lower), middle.z + radius * around.sin});
        }
    };
    for (int bone = 0; bone < static_cast<int>(rig.skeleton.bones.size()); ++bone)
        tube(bone, rig.at(bone), 0.02f, rig.at(bone).y - 0.02f, rig.at(bone).y + 0.02f);
    tube(rig.hips, rig.at(rig.hips), 0.35f, -0.05f, 1);
    for (int side = 0; side < 2; ++side) {
        tube(rig.shank[side], rig.at(rig.foot[side]), 0.09f, 0, 0.5f);
        tube(rig.foot[side], rig.at(rig.toe[side]), 0.05f, 0, 0.08f);
    }
    const RagdollDef def = makeRagdoll(rig.skeleton);
    const Vec3 up = recognise(rig.skeleton).up;
    const float soles = std::min(lowestOf(part(def, BodyRole::foot, BodySide::left), up),
                                 lowestOf(part(def, BodyRole::foot, BodySide::right), up));
    for (const RagdollPart& each : def.parts) EXPECT_GE(lowestOf(each, up), soles - 1e-5f) << each.name;
    for (const BodySide side : {BodySide::left, BodySide::right}) {
        // Bent at the ankle, a shank still does not.
        const RagdollPart &shank = part(def, BodyRole::shank, side), &foot = part(def, BodyRole::foot, side);
        const Vec3 ankle = foot.bind.position, along = normalized(shank.bind.position - ankle);
        EXPECT_GT(lowestOf(shank, along), dot(ankle, along) - (dot(ankle, up) - lowestOf(foot, up)));
    }
}

/// Skin about the bones of arms and legs, points that no other side has exactly; the right ones `thicker`.
Skeleton skinned(const HumanRig& rig, float thicker) {
    Skeleton skeleton = rig.skeleton;
    skeleton.skin.resize(skeleton.bones.size());
    std::mt19937 random(3);
    const auto any = [&] { return static_cast<float>(random()) / 4294967296.0f; };
    for (int side = 0; side < 2; ++side) {
        const std::pair<int, int> limbs[] = {{rig.thigh[side], rig.shank[side]},
                                             {rig.shank[side], rig.foot[side]},
                                             {rig.upperArm[side], rig.forearm[side]},
                                             {rig.forearm[side], rig.hand[side]}};
        for (const auto& [from, to] : limbs) {
            const Vec3 start = rig.at(from), way = rig.at(to) - start, along = normalized(way);
            const Vec3 x = perpendicular(along), y = cross(along, x);
            const float radius = 0.05f * (side == 1 ? thicker : 1.0f);
            for (int i = 0; i < 400; ++i) {
                const float angle = 2 * kPi * any(), round = radius * (1.2f - 0.4f * any());
                skeleton.skin[static_cast<std::size_t>(from)].push_back(
                    start + any() * way + round * std::cos(angle) * x + round * std::sin(angle) * y);
            }
        }
    }
    return skeleton;
}

TEST(MakeRagdoll, SidesAreAlikeWhereTheSkinIs) {
    const HumanRig rig;
    for (const float thicker : {1.0f, 1.5f}) {
        const RagdollDef def = makeRagdoll(skinned(rig, thicker));
        for (const BodyRole role : {BodyRole::thigh, BodyRole::shank, BodyRole::upperArm, BodyRole::forearm}) {
            const RagdollPart &left = part(def, role, BodySide::left), &right = part(def, role, BodySide::right);
            ASSERT_EQ(left.shape.index(), right.shape.index());
            const MassProperties one = massOf(left.shape, 1), other = massOf(right.shape, 1);
            if (thicker > 1) {
                EXPECT_GT(other.mass, 1.8f * one.mass) << nameOf(role);
                continue;
            }
            EXPECT_NEAR(other.mass, one.mass, 1e-6f * one.mass) << nameOf(role);
            const Vec3 a = transformPoint(left.bind, left.frame.position),
                       b = transformPoint(right.bind, right.frame.position);
            EXPECT_LT(length(a - Vec3{-b.x, b.y, b.z}), 1e-3f) << nameOf(role);
        }
    }
}

TEST(MakeRagdoll, SidesAreAlikeWhereSkinThatIsAlikeFollowsOtherBones) {
    // A fifth of the right upper arm's skin, at the elbow, follows the forearm.
    const HumanRig rig;
    Skeleton skeleton = skinned(rig, 1);
    auto& upper = skeleton.skin[static_cast<std::size_t>(rig.upperArm[1])];
    auto& lower = skeleton.skin[static_cast<std::size_t>(rig.forearm[1])];
    const Vec3 elbow = rig.at(rig.forearm[1]);
    std::sort(upper.begin(), upper.end(),
              [&](const Vec3& a, const Vec3& b) { return length(a - elbow) > length(b - elbow); });
    lower.insert(lower.end(), upper.end() - 80, upper.end());
    upper.resize(upper.size() - 80);
    const RagdollDef def = makeRagdoll(skeleton);
    for (const BodyRole role : {BodyRole::upperArm, BodyRole::forearm}) {
        const RagdollPart &left = part(def, role, BodySide::left), &right = part(def, role, BodySide::right);
        ASSERT_EQ(left.shape.index(), right.shape.index());
        EXPECT_NEAR(massOf(left.shape, 1).mass, massOf(right.shape, 1).mass, 1e-6f) << nameOf(role);
    }
}

TEST(MakeRagdoll, ScalesExactly) {
    const HumanRig small;
    HumanRig big;
    big.transform({}, 4.0f);
    const RagdollDef a = makeRagdoll(small.skeleton, {.bodyMass = 64});
    const RagdollDef b = makeRagdoll(big.skeleton, {.bodyMass = 64 * 64});
    ASSERT_EQ(a.parts.size(), b.parts.size());
    EXPECT_EQ(a.ignored.size(), b.ignored.size());
    for (std::size_t i = 0; i < a.parts.size(); ++i) {
        EXPECT_EQ(64 * a.parts[i].mass, b.parts[i].mass);
        EXPECT_EQ(4.0f * a.parts[i].frame.position, b.parts[i].frame.position);
        if (const auto* capsule = std::get_if<Capsule>(&a.parts[i].shape)) {
            EXPECT_EQ(4 * capsule->radius, std::get<Capsule>(b.parts[i].shape).radius);
            EXPECT_EQ(4 * capsule->halfHeight, std::get<Capsule>(b.parts[i].shape).halfHeight);
        }
    }
}

TEST(MakeRagdoll, EveryBoneFollowsAPartAndRestsWhereItWas) {
    const HumanRig rig;
    const RagdollDef def = makeRagdoll(rig.skeleton);
    ASSERT_EQ(def.bones.size(), rig.skeleton.bones.size());
    for (std::size_t i = 0; i < def.bones.size(); ++i) {
        const Frame rest = def.parts[static_cast<std::size_t>(def.bones[i].part)].bind * def.bones[i].inPart;
        EXPECT_LT(length(rest.position - rig.skeleton.bones[i].bind.position), 1e-6f);
    }
    // Fingers go with the hand, the skull with the neck, the clavicle with the chest.
    const auto partOf = [&](int bone) {
        return def.parts[static_cast<std::size_t>(def.bones[static_cast<std::size_t>(bone)].part)].role;
    };
    EXPECT_EQ(partOf(rig.hand[0] + 1), BodyRole::hand);
    EXPECT_EQ(partOf(rig.head), BodyRole::head);
    EXPECT_EQ(partOf(rig.clavicle[1]), BodyRole::chest);
    EXPECT_EQ(partOf(rig.toe[1]), BodyRole::foot);
}

/// Do two capsules or boxes have a point in common, among a grid of points of the first?
bool shareAPoint(const RagdollPart& a, const RagdollPart& b) {
    const auto half = [](const RagdollPart& part) {
        if (const auto* capsule = std::get_if<Capsule>(&part.shape))
            return Vec3{capsule->radius, capsule->halfHeight + capsule->radius, capsule->radius};
        return std::get<Box>(part.shape).halfExtents;
    };
    const auto holds = [](const RagdollPart& part, const Vec3& point) {
        const Vec3 at = inverseTransformPoint(part.bind * part.frame, point);
        if (const auto* capsule = std::get_if<Capsule>(&part.shape)) {
            const Vec3 core{0, std::clamp(at.y, -capsule->halfHeight, capsule->halfHeight), 0};
            return length(at - core) <= capsule->radius;
        }
        const Vec3 h = std::get<Box>(part.shape).halfExtents;
        return std::abs(at.x) <= h.x && std::abs(at.y) <= h.y && std::abs(at.z) <= h.z;
    };
    constexpr int kPoints = 12;
    const auto at = [](int i) { return 2.0f * static_cast<float>(i) / kPoints - 1; };
    for (int i = 0; i <= kPoints; ++i)
        for (int j = 0; j <= kPoints; ++j)
            for (int k = 0; k <= kPoints; ++k) {
                const Vec3 h = half(a), local{at(i) * h.x, at(j) * h.y, at(k) * h.z};
                const Vec3 point = transformPoint(a.bind * a.frame, local);
                if (holds(a, point) && holds(b, point)) return true;
            }
    return false;
}

TEST(MakeRagdoll, OnlyWhatIsJoinedOrOverlapsAtRestPassesThroughEachOther) {
    const RagdollDef def = makeRagdoll(HumanRig().skeleton);
    const auto isJoined = [&](int a, int b) {
        return std::any_of(def.joints.begin(), def.joints.end(), [&](const RagdollJoint& joint) {
            return (joint.parent == a && joint.child == b) || (joint.parent == b && joint.child == a);
        });
    };
    const auto count = static_cast<int>(def.parts.size());
    int apart = 0;
    for (int i = 0; i < count; ++i)
        for (int j = 0; j < count; ++j) {
            if (i == j) continue;
            const RagdollPart &a = def.parts[static_cast<std::size_t>(i)], &b = def.parts[static_cast<std::size_t>(j)];
            RagdollPart grown = b;
            if (auto* capsule = std::get_if<Capsule>(&grown.shape)) capsule->radius += 0.02f;
            if (auto* box = std::get_if<Box>(&grown.shape)) box->halfExtents += Vec3{0.02f, 0.02f, 0.02f};
            if (isJoined(i, j) || shareAPoint(a, b)) {
                EXPECT_TRUE(ignoreEachOther(def, i, j)) << a.name << b.name;
                continue;
            }
            // Points of a grid are up to 4 cm apart, so overlaps may lie between them, but not those of what is larger.
            EXPECT_TRUE(!ignoreEachOther(def, i, j) || shareAPoint(a, grown)) << a.name << b.name;
            apart += ignoreEachOther(def, i, j) ? 0 : 1;
        }
    EXPECT_GT(apart, count * (count - 1) / 2);
}

/// Two thighs that overlap at rest do not hide one of them from a hand.
TEST(Ragdoll, PartsMeetAllButThoseThatTheyIgnore) {
    RagdollDef def;
    for (int i = 0; i < 3; ++i) {
        def.parts.push_back({.name = std::to_string(i), .bone = i, .shape = Sphere{0.1f}, .mass = 1});
        def.parts.back().bind.position = {0.15f * static_cast<float>(i), 0, 0};
        def.bones.push_back({std::to_string(i), -1, i, {}});
    }
    def.ignored = {{0, 1}};
    World world({.gravity = {}});
    Ragdoll ragdoll(world, def);
    for (int i = 0; i < 30; ++i) world.step(1.0 / 60);
    const auto x = [&](std::size_t part) { return world.pose(ragdoll.bodies()[part]).position.x; };
    EXPECT_EQ(x(0), 0);
    EXPECT_GT(x(2) - x(1), 0.19);
    def.selfCollision = false;
    ragdoll = Ragdoll(world, def);
    for (int i = 0; i < 30; ++i) world.step(1.0 / 60);
    EXPECT_EQ(x(2) - x(1), static_cast<double>(def.parts[2].bind.position.x - def.parts[1].bind.position.x));
    def.ignored = {{0, 3}};
    EXPECT_THROW(Ragdoll(world, def), std::invalid_argument);
    def.ignored = {{1, 1}};
    EXPECT_THROW(Ragdoll(world, def), std::invalid_argument);
}

TEST(MakeRagdoll, SharesMassByVolumeWhereThereIsNoHuman) {
    Skeleton snake;
    for (int i = 0; i < 6; ++i)
        snake.bones.push_back({"s" + std::to_string(i), i - 1, {{0, 0, 0.2f * static_cast<float>(i)}, {}}});
    const RagdollDef def = makeRagdoll(snake, {.bodyMass = 5});
    EXPECT_EQ(whyInvalid(def), "");
    ASSERT_GE(def.parts.size(), 4u);
    EXPECT_NE(def.note, "");
    float sum = 0;
    for (const RagdollPart& each : def.parts) sum += each.mass;
    EXPECT_NEAR(sum, 5.0f, 5e-4f);
    EXPECT_NEAR(def.parts[1].mass, def.parts[2].mass, 1e-3f * def.parts[1].mass);
}

TEST(MakeRagdoll, GivesALongBoneWithADiscOfSkinAShapeAlongItAndAQuarterOfTheMassThatHangsOnIt) {
    Skeleton skeleton;
    for (int i = 0; i < 4; ++i)
        skeleton.bones.push_back({"b" + std::to_string(i), i - 1, {{0.3f * static_cast<float>(i), 1, 0}, {}}});
    skeleton.skin.resize(4);
    for (int i = 0; i < 3; ++i)
        for (int k = 0; k < 64; ++k) {
            const SinCos angle = sinCos(2 * kPi * static_cast<float>(k) / 16);
            const float radius = i == 1 ? 0.02f : 0.1f, along = i == 1 ? 0.004f : 0.1f;
            skeleton.skin[static_cast<std::size_t>(i)].push_back(
                {0.3f * static_cast<float>(i) + along * static_cast<float>(k / 16), 1 + radius * angle.cos,
                 radius * angle.sin});
        }
    const RagdollDef def = makeRagdoll(skeleton);
    ASSERT_EQ(def.parts.size(), 3u);
    const auto& capsule = std::get<Capsule>(def.parts[1].shape);
    EXPECT_GE(2 * (capsule.halfHeight + capsule.radius), 0.9f * 0.3f);
    EXPECT_GE(def.parts[1].mass, 0.249f * def.parts[2].mass);
}

TEST(MakeRagdoll, RefusesOptionsOutOfRange) {
    const HumanRig rig;
    const auto message = [&](const RagdollOptions& options) -> std::string {
        try {
            makeRagdoll(rig.skeleton, options);
        } catch (const std::invalid_argument& error) {
            return error.what();
        }
        return {};
    };
    EXPECT_EQ(message({.bodyMass = -1}), "ragdoll options: bodyMass is -1 kg, must be in [0.001, 1e+06]");
    EXPECT_NE(message({.femaleShare = std::numeric_limits<float>::quiet_NaN()}), "");
    EXPECT_NE(message({.containedShare = 0.2f}), "");
}

TEST(MakeRagdoll, RefusesASkeletonTooSmallForShapes) {
    HumanRig rig;
    rig.transform({}, 1e-8f);
    EXPECT_THROW(makeRagdoll(rig.skeleton), std::invalid_argument);
}

TEST(RagdollDef, SaysWhatIsWrong) {
    const HumanRig rig;
    const RagdollDef sound = makeRagdoll(rig.skeleton);
    RagdollDef def = sound;
    def.joints[3].child = 99;
    EXPECT_NE(whyInvalid(def).find("joints[3].joins parts"), std::string::npos);
    def = sound;
    def.joints[1] = def.joints[0];
    EXPECT_NE(whyInvalid(def).find("another joint carries"), std::string::npos);
    def = sound;
    def.parts[2].mass = 0;
    EXPECT_NE(whyInvalid(def).find(".mass is 0 kg"), std::string::npos);
    def = sound;
    def.parts.clear();
    EXPECT_NE(whyInvalid(def), "");
    def = sound;
    std::get<BallDef>(def.joints[0].joint).swingLimit = -1.0f;
    EXPECT_NE(whyInvalid(def).find("joints[0]."), std::string::npos);
}

}  // namespace
}  // namespace ragtop
