#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "world_support.h"

namespace ragtop {
namespace {

using namespace test;

constexpr float kRadius = 0.1f, kOffset = 0.03f;

/// A ball of 1 kg whose centre of mass is below its middle, with equal moments.
BodyDef eccentricBall(const DVec3& middle, float friction) {
    const float moment = 0.4f * kRadius * kRadius;
    BodyDef def = bodyDef(Sphere{kRadius}, middle, surface(friction));
    def.mass = MassProperties{1, {0, -kOffset, 0}, {{moment, 0, 0}, {0, moment, 0}, {0, 0, moment}}};
    return def;
}

// L · (from the centre of mass to the contact) is kept by forces at the contact [Jellett 1872], while a tippe top turns by a
// radian per step; Coriolis and gravity of ten seconds leave what the substeps round.
TEST(RoundArms, TippeTopKeepsJellettsConstant) {
    World world(withoutSleep());
    addFloor(world, surface(0.3f));
    BodyDef def = eccentricBall({0, 0.1, 0}, 0.3f);
    def.pose.rotation = rotationAbout({0, 0, 1}, 0.1f);
    def.angularVelocity = {0, 60, 0};
    const BodyId top = world.create(def);
    const auto jellett = [&] {
        const Vec3 stem = rotate(world.pose(top).rotation, {0, 1, 0});
        return asDouble(dot(kOffset * stem - Vec3{0, kRadius, 0}, angularMomentum(world, top)));
    };
    const double start = jellett();
    double worst = 0;
    run(world, 10, kDt, [&] { worst = std::max(worst, std::abs(jellett() / start - 1)); });
    EXPECT_LT(worst, 0.01);
    EXPECT_LT(rotate(world.pose(top).rotation, {0, 1, 0}).y, -0.9f);
}

// Two such balls that press on each other as they spin share the point of every impulse: what one loses the other gains.
TEST(RoundArms, BallsThatSpinOnEachOtherKeepTheirMomenta) {
    World world(withoutGravity());
    BodyDef left = eccentricBall({-0.1, 0, 0}, 0.5f), right = eccentricBall({0.1, 0, 0}, 0.5f);
    left.linearVelocity = {0.5f, 0, 0};
    left.angularVelocity = {0, 20, 35};
    right.angularVelocity = {10, -30, 5};
    const BodyId bodies[] = {world.create(left), world.create(right)};
    const auto total = [&] {
        DVec3 sum{};
        for (const BodyId body : bodies) {
            const Pose pose = world.pose(body);
            const DVec3 x = pose.position + DVec3{rotate(pose.rotation, {0, -kOffset, 0})};
            const DVec3 v{world.linearVelocity(body)}, own{angularMomentum(world, body)};
            sum = sum + DVec3{x.y * v.z - x.z * v.y, x.z * v.x - x.x * v.z, x.x * v.y - x.y * v.x} + own;
        }
        return sum;
    };
    const DVec3 start = total();
    double worst = 0, change = 0;
    const DVec3 own{angularMomentum(world, bodies[0])};
    run(world, 0.5, kDt, [&] {
        worst = std::max(worst, distanceBetween(total(), start));
        change = std::max(change, distanceBetween(DVec3{angularMomentum(world, bodies[0])}, own));
    });
    EXPECT_GT(change, 1e-3);  // they have met
    // Positions may leave the line of velocities by ½ h Δv (docs/adr/0004), Δv up to half of what they close with.
    EXPECT_LT(worst, 0.5 / 240 * 0.25 * 0.25);
}

}  // namespace
}  // namespace ragtop
