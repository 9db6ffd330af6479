#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "world_support.h"

namespace ragtop {
namespace {

using namespace test;

constexpr double kDrumRadius = 1, kRopeRadius = 0.05, kHalfTurn = 3.141592653589793;

void weigh(World& world, BodyId body, float kg) {
    MassProperties mass = world.mass(body);
    const float scale = kg / mass.mass;
    mass.mass *= scale;
    for (Vec3* column : {&mass.inertia.cx, &mass.inertia.cy, &mass.inertia.cz}) *column *= scale;
    world.setMass(body, mass);
}

/// Links of 0.6 kg half round a fixed drum, each of which touches it half way, and a weight on either side. Where
/// friction bites by the thickness t below the middle of the rope, statics holds weights up to e^{μ π R/(R + t)} : 1.
struct Rope {
    World world{withoutSleep()};
    std::vector<BodyId> bodies;
    std::vector<JointId> joints;
    DVec3 start;

    Rope(float friction, double lighter, double heavier) {
        BodyDef drum = bodyDef(Capsule{static_cast<float>(kDrumRadius), 1}, {});
        drum.type = BodyType::fixed;
        drum.pose.rotation = rotationBetween({0, 1, 0}, {0, 0, 1});
        drum.shapes[0].material.friction = friction;
        world.create(drum);
        constexpr int kAround = 14, kHanging = 3;
        constexpr double kLink = 0.25;
        const double step = kHalfTurn / kAround, r = (kDrumRadius + kRopeRadius) / std::cos(0.5 * step);
        std::vector<DVec3> knots;
        for (int i = kHanging; i > 0; --i) knots.push_back({-r, -i * kLink, 0});
        for (int i = 0; i <= kAround; ++i) knots.push_back({-r * std::cos(step * i), r * std::sin(step * i), 0});
        for (int i = 1; i <= kHanging; ++i) knots.push_back({r, -i * kLink, 0});
        add(Sphere{0.2f}, knots.front() - DVec3{0, 0.2, 0}, lighter, {}, friction, nullptr);
        for (std::size_t i = 0; i + 1 < knots.size(); ++i) {
            const Vec3 way = toVec3(knots[i + 1] - knots[i]);
            add(Capsule{static_cast<float>(kRopeRadius), 0.5f * length(way) - static_cast<float>(kRopeRadius)},
                knots[i] + 0.5 * DVec3{way}, 0.6, rotationBetween({0, 1, 0}, normalized(way)), friction, &knots[i]);
        }
        add(Sphere{0.2f}, knots.back() - DVec3{0, 0.2, 0}, heavier, {}, friction, &knots.back());
        start = world.pose(bodies.back()).position;
    }
    void add(const Shape& shape, const DVec3& at, double kg, const Quat& rotation, float friction, const DVec3* knot) {
        BodyDef def = bodyDef(shape, at);
        def.pose.rotation = rotation;
        def.shapes[0].material.friction = friction;
        const BodyId body = world.create(def);
        weigh(world, body, static_cast<float>(kg));
        if (knot != nullptr) {
            const auto frameIn = [&](BodyId id) {
                const Pose pose = world.pose(id);
                return Frame{inverseRotate(pose.rotation, toVec3(*knot - pose.position)), conjugate(pose.rotation)};
            };
            joints.push_back(world.create(BallDef{
                .bodies = {.a = bodies.back(), .b = body, .frameA = frameIn(bodies.back()), .frameB = frameIn(body)}}));
        }
        bodies.push_back(body);
    }
    /// m, that the heavier weight has come down.
    double sunk() const { return start.y - world.pose(bodies.back()).position.y; }
    float widestGap() const {
        float gap = 0;
        for (const JointId joint : joints) gap = std::max(gap, world.state(joint).gap);
        return gap;
    }
};

double limitOf(float friction) {
    return std::exp(static_cast<double>(friction) * kHalfTurn * kDrumRadius / (kDrumRadius + kRopeRadius));
}

class RopeOverADrum : public testing::TestWithParam<float> {};

TEST_P(RopeOverADrum, HoldsWhatFrictionHolds) {
    for (const double lighter : {60.0, 500.0}) {
        Rope rope(GetParam(), lighter, 0.9 * limitOf(GetParam()) * lighter);
        for (int i = 0; i < 180; ++i) {
            run(rope.world, kDt);
            // Links come to lie on the drum by parts of their thickness.
            ASSERT_LT(rope.sunk(), 0.005) << lighter << " kg, step " << i;
            ASSERT_LT(rope.widestGap(), 1e-3f) << lighter << " kg, step " << i;
        }
        EXPECT_EQ(rope.world.stats().directFailures, 0u);
    }
}

TEST_P(RopeOverADrum, RunsBeyondIt) {
    Rope rope(GetParam(), 60, 1.1 * limitOf(GetParam()) * 60);
    run(rope.world, 3);
    EXPECT_GT(rope.sunk(), 0.1);
}

INSTANTIATE_TEST_SUITE_P(Friction, RopeOverADrum, testing::Values(0.1f, 0.3f));

}  // namespace
}  // namespace ragtop
