// Humans of any build stand.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <string>
#include <tuple>
#include <vector>

#include "human.h"
#include "ragtop/balance.h"
#include "ragtop/world.h"

namespace ragtop {
namespace {

BodyDef floorOf(BodyType type) {
    return {.type = type,
            .shapes = {{.geometry = Box{{100, 1, 100}}, .material = {.friction = 0.8f}}},
            .pose = {{0, -1, 0}, {}}};
}

/// A person drawn by chance: legs, trunk, arms, feet and clothes of other lengths and widths than those of HumanRig,
/// whose feet, trunk and head have skin.
class DrawnHuman {
public:
    explicit DrawnHuman(unsigned seed) : random_(seed) {
        const float legs = between(0.55f, 1.15f), trunk = between(0.8f, 1.3f), arms = between(0.8f, 1.2f);
        const Vec3 hips = rig_.at(rig_.hips);
        for (std::size_t i = 0; i < rig_.skeleton.bones.size(); ++i) {
            Vec3& at = rig_.skeleton.bones[i].bind.position;
            const bool isLeg = isOneOf(static_cast<int>(i), rig_.thigh, rig_.shank, rig_.foot, rig_.toe);
            if (isLeg) {
                at.y *= legs;
                continue;
            }
            // Arms are level: what is beyond the shoulders is stretched.
            constexpr float kShoulder = 0.19f;
            const float out = std::max(std::abs(at.x) - kShoulder, 0.0f);
            at.x += std::copysign((arms - 1) * out, at.x);
            at.y = legs * hips.y + trunk * (at.y - hips.y);
        }
        rig_.skeleton.skin.resize(rig_.skeleton.bones.size());
        const float stretch = between(0.75f, 1.5f), width = between(0.8f, 1.6f), ahead = between(-0.02f, 0.04f);
        for (int side = 0; side < 2; ++side) {
            const Vec3 ankle = rig_.at(rig_.foot[side]);
            const Vec3 half{0.05f * width, 0.5f * ankle.y + 0.01f, 0.13f * stretch};
            cover(rig_.foot[side], {ankle.x, half.y, ankle.z + 0.4f * half.z + ahead}, half);
        }
        for (int side = 0; side < 2; ++side)
            for (const auto& [bone, next, thick] : {std::tuple{rig_.thigh[side], rig_.shank[side], 0.07f},
                                                    {rig_.shank[side], rig_.foot[side], 0.05f},
                                                    {rig_.upperArm[side], rig_.forearm[side], 0.05f},
                                                    {rig_.forearm[side], rig_.hand[side], 0.04f}})
                coverLimb(bone, rig_.at(next), thick);
        for (int side = 0; side < 2; ++side)
            coverLimb(rig_.hand[side], rig_.at(rig_.hand[side]) + Vec3{side == 0 ? 0.17f : -0.17f, 0, 0}, 0.035f);
        cover(rig_.hips, rig_.at(rig_.hips), {0.16f, 0.09f, 0.11f});
        const Vec3 chest = rig_.at(rig_.chest), head = rig_.at(rig_.head), spine = rig_.at(rig_.spine);
        const float wide = between(0.8f, 1.8f), skull = between(0.8f, 1.6f);
        cover(rig_.spine, 0.5f * (spine + chest), {0.16f * wide, 0.1f * trunk, 0.11f * wide});
        cover(rig_.chest, chest + Vec3{0, 0.1f * trunk, 0}, {0.17f * wide, 0.14f * trunk, 0.12f * wide});
        cover(rig_.head, head + Vec3{0, 0.11f * skull, 0}, {0.09f * skull, 0.12f * skull, 0.1f * skull});
        def_ = makeRagdoll(rig_.skeleton, {.bodyMass = between(40, 130)});
    }
    const RagdollDef& def() const { return def_; }
    float between(float a, float b) {
        return a + (b - a) * static_cast<float>(random_()) / static_cast<float>(std::mt19937::max());
    }

private:
    template <class... Pairs>
    static bool isOneOf(int bone, const Pairs&... pairs) {
        return ((bone == pairs[0] || bone == pairs[1]) || ...);
    }
    /// Points of a body between a box and an ellipsoid, flat below.
    void cover(int bone, const Vec3& middle, const Vec3& half) {
        for (int i = 0; i < 400; ++i) {
            Vec3 p{between(-1, 1), between(-1, 1), between(-1, 1)};
            const float most = std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)}), size = ragtop::length(p);
            p = (1 / (0.5f * (most + size))) * p;
            p.y = std::max(p.y, -0.9f);
            rig_.skeleton.skin[static_cast<std::size_t>(bone)].push_back(middle + scale(half, p));
        }
    }

    void coverLimb(int bone, const Vec3& end, float thick) {
        const Vec3 start = rig_.at(bone);
        cover(bone, 0.5f * (start + end), 0.5f * abs(end - start) + Vec3{thick, thick, thick});
    }

    std::mt19937 random_;
    HumanRig rig_;
    RagdollDef def_;
};

/// Whatever their proportions: still they come to rest, and a push of 0.8 m d √(g/z) from some side they take.
TEST(Standing, HumansOfAnyBuildStandAndTakeAPush) {
    for (unsigned seed = 1; seed <= 20; ++seed) {
        SCOPED_TRACE("seed " + std::to_string(seed));
        DrawnHuman human(seed);
        World world(WorldSettings{.sleeping = false});
        world.create(floorOf(BodyType::fixed));
        Ragdoll body(world, human.def(), standing(BodyAxes(human.def())));
        Muscles muscles(world, body);
        Balance balance(world, body, muscles);
        InverseDynamics dynamics(world, body);
        const auto run = [&](double seconds) {
            for (int i = 0; i < std::lround(seconds / kDt); ++i) {
                balance.step(kDt);
                muscles.step(kDt);
                world.step(kDt);
            }
            dynamics.look();
        };
        const double upright = dynamics.centerOfMass().y;
        run(6);
        EXPECT_GT(dynamics.centerOfMass().y, 0.85 * upright);
        EXPECT_LT(length(dynamics.velocity()), 0.02f);
        const float angle = human.between(-kPi, kPi);
        const Vec3 way{sinCos(angle).sin, 0, sinCos(angle).cos};
        const auto height = static_cast<float>(dynamics.centerOfMass().y);
        const Vec3 gained = 0.8f * balance.reach(way) * std::sqrt(9.81f / height) * way;
        for (const BodyId part : body.bodies())
            world.setVelocity(part, world.linearVelocity(part) + gained, world.angularVelocity(part));
        run(5);
        EXPECT_GT(dynamics.centerOfMass().y, 0.85 * upright);
    }
}

/// A floor that quickens by a from one step to the next is a slope of a/g for who stands on it: the centre of mass has
/// to be z a/g ahead of the feet, beyond their heels, so that it takes a step on ground that runs on meanwhile.
TEST(Standing, HumansStayOnAFloorThatQuickensToAnySide) {
    for (int side = 0; side < 8; ++side) {
        World world(WorldSettings{.sleeping = false});
        const BodyId floor = world.create(floorOf(BodyType::kinematic));
        Ragdoll body(world, human(), standing(BodyAxes(human())));
        Muscles muscles(world, body);
        Balance balance(world, body, muscles);
        const SinCos angle = sinCos(0.25f * kPi * static_cast<float>(side));
        const DVec3 way(Vec3{angle.sin, 0, angle.cos});
        double ran = 0;
        for (int i = 0; i < 480; ++i) {
            const double time = std::max(0.0, (i + 1) * kDt - 3);
            ran = 0.5 * time * time;
            world.moveTo(floor, {ran * way + DVec3{0, -1, 0}, {}}, kDt);
            balance.step(kDt);
            muscles.step(kDt);
            world.step(kDt);
        }
        InverseDynamics dynamics(world, body);
        EXPECT_GT(dynamics.centerOfMass().y, 0.85) << side;
        EXPECT_LT(length(relative(dynamics.centerOfMass(), ran * way + DVec3{0, dynamics.centerOfMass().y, 0})), 1.0f)
            << side;
    }
}

/// Also who has a trunk that is wider than its shoulders.
TEST(Standing, NobodyIsSetUpWithItsArmsInItsBody) {
    for (const float half : {0.1f, 0.2f, 0.3f}) {
        RagdollDef def = human();
        for (RagdollPart& part : def.parts)
            if (part.role == BodyRole::abdomen || part.role == BodyRole::chest)
                std::get<Box>(part.shape).halfExtents.x = half;
        const std::vector<Pose> bones = standing(BodyAxes(def));
        World world;
        world.create(floorOf(BodyType::fixed));
        Ragdoll body(world, def, bones);
        world.step(kDt);
        const auto own = [&](BodyId id) {
            return std::find(body.bodies().begin(), body.bodies().end(), id) != body.bodies().end();
        };
        for (const BodyId part : body.bodies())
            world.forEachContact(part, [&](const Contact& contact) {
                EXPECT_FALSE(contact.normalForce > 0 && own(contact.bodyA) && own(contact.bodyB)) << half;
            });
    }
}

}  // namespace
}  // namespace ragtop
