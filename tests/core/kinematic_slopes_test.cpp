#include <algorithm>
#include <cmath>
#include <vector>

#include "world_support.h"

// A kinematic body whose velocity is given anew in each step speeds up evenly within it (model/kinematic_slopes.h).

namespace ragtop {
namespace {

using namespace test;

double asDouble(float x) { return x; }

BodyId addPlatform(World& world, float friction) {
    return world.create(bodyDef(Box{{20, 1, 20}}, {0, -1, 0}, surface(friction), BodyType::kinematic));
}

/// Speeds up by a for a second, goes evenly for one and brakes for one, after half a second of rest; then calls `look`.
template <class Look>
void ride(World& world, BodyId platform, const Vec3& a, int rate, Look&& look) {
    const double dt = 1.0 / rate;
    for (int i = 0; i < 4 * rate; ++i) {
        const double t = (i + 0.5) * dt - 0.5;
        const double along = std::clamp(t, 0.0, 1.0) - std::clamp(t - 2, 0.0, 1.0);
        world.setVelocity(platform, static_cast<float>(along) * a, {});
        world.step(dt);
        look();
    }
}

/// What remains are the jumps by which the first steps of each change speed up: Δv = a dt in the first and half as much
/// in the second and at the end. A jump slides by Δv²/2(μ g − a) at most; with a = 0.9 μ g all of a change
/// make ½ Δv²/μg + 2 (½ Δv)²/2(0.1 μ g) = 3 Δv²/μg.
TEST(KinematicSlopes, CarryWhatFrictionHolds) {
    for (const int rate : {30, 60, 120})
        for (const float friction : {0.2f, 0.5f, 0.8f}) {
            World world{withoutSleep()};
            const BodyId platform = addPlatform(world, friction);
            const BodyId box = world.create(bodyDef(Box{{0.5f, 0.2f, 0.5f}}, {0, 0.2, 0}, surface(friction)));
            const float a = 0.9f * friction * kGravity;
            double farthest = 0;
            ride(world, platform, {a, 0, 0}, rate, [&] {
                const DVec3 at = world.pose(box).position - world.pose(platform).position;
                farthest = std::max(farthest, std::abs(at.x));
            });
            const double jump = asDouble(a) / rate;
            EXPECT_LE(farthest, 2 * 3 * jump * jump / asDouble(friction * kGravity)) << rate << " Hz, " << friction;
        }
}

/// a − μ g for a second, and as much slower until friction has it along again.
TEST(KinematicSlopes, LeaveBehindWhatFrictionDoesNotHold) {
    constexpr float kFriction = 0.2f;
    World world{withoutSleep()};
    const BodyId platform = addPlatform(world, kFriction);
    const BodyId box = world.create(bodyDef(Box{{0.5f, 0.2f, 0.5f}}, {0, 0.2, 0}, surface(kFriction)));
    const double held = asDouble(kFriction * kGravity), a = 1.25 * held;
    double farthest = 0;
    ride(world, platform, {static_cast<float>(a), 0, 0}, 60,
         [&] { farthest = std::max(farthest, -(world.pose(box).position - world.pose(platform).position).x); });
    const double slower = (a - held) * 1, path = slower * slower / 2 * (1 / (a - held) + 1 / held);
    // Friction grows to its bound within two substeps of 1/240 s; what is lost of it lasts until the box has caught up.
    EXPECT_NEAR(farthest, path, held * 2 / 240 * (1 + slower / held));
}

TEST(KinematicSlopes, EndEachStepWhereTheMeanTakesThem) {
    World world{withoutSleep()};
    const BodyId platform = addPlatform(world, 0.5f);
    double x = 0;
    for (int i = 0; i < 120; ++i) {
        const float speed = 3 * std::sin(0.05f * static_cast<float>(i));
        x += asDouble(speed) * kDt;
        world.setVelocity(platform, {speed, 0, 0}, {});
        world.step(kDt);
        EXPECT_EQ(world.linearVelocity(platform).x, speed);
        // Four substeps round to single precision.
        EXPECT_NEAR(world.pose(platform).position.x, x, (i + 1) * 4 * 3 * kDt * asDouble(kEpsilon));
    }
}

/// The friction of a table that speeds up, α r + ω² r ≤ 0.9 μ g, takes along what lies on it.
TEST(KinematicSlopes, ATableThatIsTurnedEverFasterCarriesWhatLiesOnIt) {
    World world{withoutSleep()};
    const BodyId table = addPlatform(world, 0.5f);
    const BodyId box = world.create(bodyDef(Box{{0.3f, 0.1f, 0.3f}}, {2, 0.1, 0}, surface(0.5f)));
    constexpr float kAlpha = 0.8f;
    for (int i = 0; i < 90; ++i) {
        const float turned = kAlpha * static_cast<float>(std::max(0, i - 29)) / 60;
        world.setVelocity(table, {}, {0, turned, 0});
        world.step(kDt);
        const DVec3 at = world.pose(box).position - world.pose(table).position;
        const Vec3 seen = inverseRotate(world.pose(table).rotation, toVec3(at));
        // Along the circle what the jumps of v = α r dt slide, 3 Δv²/μg. Outwards ½ dt ω² r in a second too, since rows
        // keep the arms that they have when a step begins.
        const float t = static_cast<float>(std::max(0, i - 29)) / 60;
        EXPECT_NEAR(seen.z, 0, 0.5e-3f) << i;
        EXPECT_NEAR(seen.x, 2, 0.5e-3f + kAlpha * kAlpha * t * t * t / 3 / 60) << i;
    }
}

/// What starts at once has no slope: it strikes as what has always been as fast.
TEST(KinematicSlopes, APistonThatStartsAtOnceDoesNotOvershoot) {
    constexpr float kSpeed = 5;
    std::vector<float> speeds;
    for (const bool startsAtOnce : {false, true}) {
        World world{withoutGravity()};
        BodyDef def = bodyDef(Box{{0.5f, 0.5f, 0.5f}}, {}, surface(0), BodyType::kinematic);
        if (!startsAtOnce) def.linearVelocity = {kSpeed, 0, 0};
        const BodyId piston = world.create(def);
        const BodyId box = world.create(bodyDef(Box{{0.5f, 0.5f, 0.5f}}, {1.25, 0, 0}, surface(0)));
        world.setVelocity(piston, {kSpeed, 0, 0}, {});
        for (int i = 0; i < 30; ++i) world.step(kDt);
        speeds.push_back(world.linearVelocity(box).x);
    }
    EXPECT_GE(speeds[0], kSpeed);
    EXPECT_EQ(speeds[0], speeds[1]);
}

TEST(KinematicSlopes, AreSavedAndRestored) {
    World world{withoutSleep()};
    const BodyId platform = addPlatform(world, 0.5f);
    world.create(bodyDef(Box{{0.5f, 0.5f, 0.5f}}, {0, 0.5, 0}, surface(0.5f)));
    const auto go = [&](int from, int to) {
        for (int i = from; i < to; ++i) {
            world.setVelocity(platform, {0.05f * static_cast<float>(i), 0, 0}, {});
            world.step(kDt);
        }
    };
    go(0, 20);
    std::vector<std::byte> kept(world.saveSize());
    kept.resize(world.save(kept));
    go(20, 40);
    const std::uint64_t straight = world.hash();
    world.restore(kept);
    go(20, 40);
    EXPECT_EQ(world.hash(), straight);
}

}  // namespace
}  // namespace ragtop
