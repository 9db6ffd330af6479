#include "ragtop/ragdoll_lod.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <set>
#include <stdexcept>

#include "human.h"
#include "ragtop/world.h"

namespace ragtop {
namespace {

constexpr RagdollLevel kLevels[] = {
    RagdollLevel::reduced, RagdollLevel::single, RagdollLevel::asleep, RagdollLevel::single, RagdollLevel::reduced,
    RagdollLevel::full,    RagdollLevel::single, RagdollLevel::full,   RagdollLevel::asleep, RagdollLevel::full};

double norm(const DVec3& a) { return std::sqrt(a.x * a.x + a.y * a.y + a.z * a.z); }

DVec3 cross(const DVec3& a, const DVec3& b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

/// What a world's bodies that take part have together.
struct Whole {
    double mass = 0, kinetic = 0;
    DVec3 center, momentum, spin;  ///< kg m/s, and kg m²/s about the centre

    explicit Whole(const World& world, std::span<const BodyId> bodies) {
        for (const BodyId body : bodies) {
            const double m = static_cast<double>(world.mass(body).mass);
            mass += m;
            center = center + m * world.centerOfMass(body);
            momentum = momentum + m * DVec3(world.linearVelocity(body));
        }
        center = (1 / mass) * center;
        for (const BodyId body : bodies) {
            const MassProperties own = world.mass(body);
            const Quat turn = world.pose(body).rotation;
            const Vec3 v = world.linearVelocity(body), w = world.angularVelocity(body);
            const Vec3 turning = rotate(turn, own.inertia * inverseRotate(turn, w));
            spin = spin + DVec3(turning) +
                   cross(world.centerOfMass(body) - center, static_cast<double>(own.mass) * DVec3(v));
            kinetic += 0.5 * static_cast<double>(own.mass * dot(v, v) + dot(w, turning));
        }
    }
};

/// A human in the air, all of whose joints move.
struct Thrown {
    World world;
    Ragdoll ragdoll;

    explicit Thrown(unsigned seed, const Vec3& gravity = {}) : world({.gravity = gravity}), ragdoll(world, human()) {
        std::mt19937 random(seed);
        const auto number = [&] { return static_cast<float>(random() % 2001) * 1e-3f - 1; };
        for (const BodyId body : ragdoll.bodies()) {
            const float x = number(), y = number(), z = number();
            world.setVelocity(body, {1, 2, 0.5f}, 4.0f * Vec3{x, y, z});
        }
        for (int i = 0; i < 20; ++i) world.step(kDt);
    }
};

TEST(RagdollLod, ChangesKeepMomentumAndGiveNoEnergy) {
    for (unsigned seed = 1; seed <= 8; ++seed) {
        Thrown thrown(seed);
        RagdollLod lod(thrown.world, thrown.ragdoll);
        Whole before(thrown.world, lod.bodies());
        for (const RagdollLevel level : kLevels) {
            const bool sleeps = level == RagdollLevel::asleep;
            lod.setLevel(level);
            if (sleeps) {
                EXPECT_FALSE(thrown.world.isEnabled(lod.bodies().front()));
                for (int i = 0; i < 30; ++i) thrown.world.step(kDt);
                continue;
            }
            const Whole after(thrown.world, lod.bodies());
            EXPECT_NEAR(after.mass, before.mass, 1e-5 * before.mass);
            EXPECT_LT(norm(after.momentum - before.momentum), 1e-5 * norm(before.momentum)) << nameOf(level);
            EXPECT_LT(norm(after.spin - before.spin), 1e-5 * norm(before.spin)) << nameOf(level);
            EXPECT_LE(after.kinetic, before.kinetic * (1 + 1e-6)) << nameOf(level);
            EXPECT_LT(norm(after.center - before.center), 1e-6) << nameOf(level);
            for (int i = 0; i < 10; ++i) thrown.world.step(kDt);
            before = Whole(thrown.world, lod.bodies());
        }
        EXPECT_TRUE(thrown.world.validate().empty()) << thrown.world.validate();
    }
}

/// What goes stiff as one body moves as the rigid body that it is: its energy is that of V = P/M and Ω = I⁻¹ L.
TEST(RagdollLod, OneBodyHasTheEnergyOfAPlasticImpact) {
    Thrown thrown(3);
    RagdollLod lod(thrown.world, thrown.ragdoll);
    const Whole before(thrown.world, lod.bodies());
    lod.setLevel(RagdollLevel::single);
    const Whole after(thrown.world, lod.bodies());
    const Vec3 w = thrown.world.angularVelocity(lod.bodies().front());
    const double moving = 0.5 * norm(before.momentum) * norm(before.momentum) / before.mass;
    const double spinning = 0.5 * (before.spin.x * static_cast<double>(w.x) + before.spin.y * static_cast<double>(w.y) +
                                   before.spin.z * static_cast<double>(w.z));
    EXPECT_NEAR(after.kinetic, moving + spinning, 1e-5 * before.kinetic);
    EXPECT_LT(after.kinetic, before.kinetic);
}

/// A float of a quaternion of length 1 turns by 1e-7 rad: that is well below a micrometre at the ends of a human.
TEST(RagdollLod, NoBoneMovesWhereTheLevelChanges) {
    Thrown thrown(5);
    RagdollLod lod(thrown.world, thrown.ragdoll);
    std::vector<Pose> before(human().bones.size()), after(before.size());
    for (const RagdollLevel level : kLevels) {
        lod.pose(before);
        lod.setLevel(level);
        lod.pose(after);
        for (std::size_t i = 0; i < before.size(); ++i) {
            EXPECT_LT(norm(after[i].position - before[i].position), 1e-5) << nameOf(level) << i;
            EXPECT_LT(length(rotationVector(after[i].rotation * conjugate(before[i].rotation))), 1e-5f)
                << nameOf(level);
        }
        for (int i = 0; i < 5; ++i) thrown.world.step(kDt);
    }
}

TEST(RagdollLod, JointsOfWhatMovesLeastGoStiffFirst) {
    const RagdollDef& def = human();
    for (int most = 1; most <= static_cast<int>(def.parts.size()); ++most) {
        const std::vector<int> groups = stiffGroups(def, most);
        EXPECT_EQ(std::set<int>(groups.begin(), groups.end()).size(), static_cast<std::size_t>(most));
    }
    // A hand moves less than an arm, so it goes stiff before.
    const std::vector<int> groups = stiffGroups(def, 12);
    for (const RagdollJoint& joint : def.joints) {
        const RagdollPart& child = def.parts[static_cast<std::size_t>(joint.child)];
        const bool together =
            groups[static_cast<std::size_t>(joint.child)] == groups[static_cast<std::size_t>(joint.parent)];
        EXPECT_TRUE(together || (child.role != BodyRole::hand && child.role != BodyRole::foot));
        EXPECT_TRUE(!together || child.role != BodyRole::thigh);
    }
}

/// In less detail it still hangs from what held it, falls on the ground, and comes to rest.
TEST(RagdollLod, GroupsStayJoinedToEachOtherAndToOthers) {
    World world;
    Ragdoll ragdoll(world, human(), {{0, 3, 0}, {}});
    const auto hand =
        static_cast<std::size_t>(std::find_if(human().parts.begin(), human().parts.end(),
                                              [](const RagdollPart& part) { return part.role == BodyRole::hand; }) -
                                 human().parts.begin());
    BallDef hold;
    hold.bodies.b = ragdoll.bodies()[hand];
    hold.bodies.frameA.position = toVec3(world.pose(ragdoll.bodies()[hand]).position);
    world.create(hold);
    RagdollLod lod(world, ragdoll);
    for (const RagdollLevel level :
         {RagdollLevel::reduced, RagdollLevel::single, RagdollLevel::reduced, RagdollLevel::full}) {
        lod.setLevel(level);
        for (int i = 0; i < 120; ++i) world.step(kDt);
        for (const JointId joint : world.joints()) {
            const BodyId b = std::visit([](const auto& def) { return def.bodies.b; }, world.def(joint));
            EXPECT_TRUE(!world.isEnabled(b) || world.state(joint).gap < 2e-3f) << nameOf(level);
        }
        EXPECT_LT(norm(lod.partPose(static_cast<int>(hand)).position - DVec3(hold.bodies.frameA.position)), 2e-3);
    }
}

TEST(RagdollLod, LevelsFollowTheHeightOnTheScreenWithSlack) {
    World world;
    Ragdoll ragdoll(world, human(), {{0, 3, 0}, {}});
    RagdollLod lod(world, ragdoll);
    const auto at = [&](float share) {
        lod.setHeightOnScreen(share);
        return lod.level();
    };
    EXPECT_EQ(at(0.5f), RagdollLevel::full);
    EXPECT_EQ(at(0.149f), RagdollLevel::reduced);
    EXPECT_EQ(at(0.16f), RagdollLevel::reduced);
    EXPECT_EQ(at(0.19f), RagdollLevel::full);
    EXPECT_EQ(at(0.05f), RagdollLevel::single);
    EXPECT_EQ(at(0.07f), RagdollLevel::single);
    EXPECT_EQ(at(0), RagdollLevel::asleep);
    EXPECT_EQ(at(0.1f), RagdollLevel::reduced);
    EXPECT_EQ(at(0.009f), RagdollLevel::asleep);
    EXPECT_EQ(at(1), RagdollLevel::full);
}

TEST(RagdollLod, WrongOptionsAreTold) {
    World world;
    Ragdoll ragdoll(world, human());
    EXPECT_THROW(RagdollLod(world, ragdoll, {.groups = 0}), std::invalid_argument);
    EXPECT_THROW(RagdollLod(world, ragdoll, {.slack = 0.5f}), std::invalid_argument);
    EXPECT_THROW(RagdollLod(world, ragdoll, {.single = -1}), std::invalid_argument);
    RagdollLod lod(world, ragdoll);
    EXPECT_THROW(lod.partPose(99), std::out_of_range);
}

/// Nothing is left of the groups.
TEST(RagdollLod, EndsInFullDetail) {
    World world;
    Ragdoll ragdoll(world, human());
    const std::size_t bodies = world.bodies().size(), joints = world.joints().size();
    {
        RagdollLod lod(world, ragdoll);
        lod.setLevel(RagdollLevel::asleep);
        EXPECT_EQ(world.bodies().size(), bodies + 1);
    }
    EXPECT_EQ(world.bodies().size(), bodies);
    EXPECT_EQ(world.joints().size(), joints);
    for (const BodyId body : ragdoll.bodies()) EXPECT_TRUE(world.isEnabled(body));
}

}  // namespace
}  // namespace ragtop
