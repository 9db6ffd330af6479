#include "measure.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "convex_depth.h"
#include "ragtop/scene.h"
#include "summary.h"

namespace ragtop::demos {
namespace {

double depth(const Shape& a, const Pose& poseA, const Shape& b, const Pose& poseB) {
    const double ab = overlapDepth(solidOf(a, poseA), solidOf(b, poseB));
    const double ba = overlapDepth(solidOf(b, poseB), solidOf(a, poseA));
    EXPECT_NEAR(ab, ba, 1e-9);
    return ab;
}

const Shape kUnitBox = Box{{1, 1, 1}};

TEST(OverlapDepth, OfBoxesIsTheLeastWayOut) {
    EXPECT_NEAR(depth(kUnitBox, {}, kUnitBox, {{0.1, 1.75, 0.3}, {}}), 0.25, 1e-12);
    EXPECT_EQ(depth(kUnitBox, {}, kUnitBox, {{0, 2.001, 0}, {}}), 0);
    // Turned by 45° about y, its edge reaches √2 towards the face at x = 1.
    const Quat turned = rotationAbout({0, 1, 0}, kPi / 4);
    EXPECT_NEAR(depth(kUnitBox, {}, kUnitBox, {{2.3, 0, 0}, turned}), 1 + std::sqrt(2.0) - 2.3, 1e-6);
}

TEST(OverlapDepth, OfCrossedEdgesNeedsTheirProduct) {
    // Two long boxes on their edges, crossed at right angles: edges meet at height √2 of each.
    const Shape bar = Box{{1, 1, 10}};
    const Quat onEdge = rotationAbout({0, 0, 1}, kPi / 4);
    const Quat across = rotationAbout({0, 1, 0}, kPi / 2) * onEdge;
    EXPECT_NEAR(depth(bar, {{0, 0, 0}, onEdge}, bar, {{0, 2.8, 0}, across}), 2 * std::sqrt(2.0) - 2.8, 1e-6);
}

TEST(OverlapDepth, OfRoundShapesIsTheSumOfRadiiLessTheDistance) {
    EXPECT_NEAR(depth(Sphere{1}, {}, Sphere{0.5f}, {{0.6, 0.8, 0}, {}}), 0.5, 1e-12);
    const Shape upright = Capsule{0.5f, 2};
    EXPECT_NEAR(depth(upright, {}, upright, {{0.9, 1, 0}, rotationAbout({0, 0, 1}, kPi / 2)}), 1, 1e-6);
    EXPECT_NEAR(depth(upright, {}, Sphere{0.25f}, {{0, 2.5, 0}, {}}), 0.25, 1e-9);
    EXPECT_NEAR(depth(upright, {}, kUnitBox, {{1.4, 1.5, 0}, {}}), 0.1, 1e-9);
    EXPECT_NEAR(depth(Sphere{0.5f}, {}, kUnitBox, {{1.25, 1.25, 0}, {}}), 0.5 - std::sqrt(2.0) / 4, 1e-9);
}

TEST(OverlapDepth, OfHullsAgreesWithThatOfEqualBoxes) {
    std::vector<Vec3> corners;
    for (int i = 0; i < 8; ++i) corners.push_back({i & 1 ? 1.0f : -1.0f, i & 2 ? 1.0f : -1.0f, i & 4 ? 1.0f : -1.0f});
    const Shape hull = ConvexHull(corners);
    const Quat turned = rotationAbout({1, 2, 3}, 0.7f);
    for (const double x : {0.5, 1.2, 2.0, 2.4, 3.5}) {
        const double exact = depth(kUnitBox, {}, kUnitBox, {{x, 0.3, -0.2}, turned});
        // The search ends near the least of all directions, never below it.
        EXPECT_GE(overlapDepth(solidOf(hull, {}), solidOf(hull, {{x, 0.3, -0.2}, turned})), exact - 1e-6);
        EXPECT_NEAR(overlapDepth(solidOf(hull, {}), solidOf(hull, {{x, 0.3, -0.2}, turned})), exact, 0.05);
    }
}

TEST(OverlapDepth, BehindATriangleCountsOnlyOverIt) {
    const DVec3 p{0, 0, 0}, q{0, 0, 4}, r{4, 0, 0};
    EXPECT_NEAR(overlapDepth(solidOf(Sphere{0.5f}, {{1, 0.3, 1}, {}}), p, q, r), 0.2, 1e-9);
    EXPECT_EQ(overlapDepth(solidOf(Sphere{0.5f}, {{1, 0.6, 1}, {}}), p, q, r), 0);
    EXPECT_EQ(overlapDepth(solidOf(Sphere{0.5f}, {{3, 0.3, 3}, {}}), p, q, r), 0);
}

TEST(Measure, SeesOverlapThatTheSceneBeginsWithAndSkipsJoinedBodies) {
    Scene scene;
    for (const double y : {0.0, 0.9, 1.8}) {
        SceneBody body;
        body.def.shapes.push_back({.geometry = Box{}});
        body.def.pose.position = {0, y, 0};
        body.masonry = true;
        scene.bodies.push_back(body);
    }
    scene.joints.push_back({"weld", 0, 1, FixedDef{{.frameA = {{0, 0.45f, 0}, {}}, .frameB = {{0, -0.5f, 0}, {}}}}});
    SixDofDef apart;  // leaves all free: its bodies do not meet, and it has no gap
    scene.joints.push_back({"apart", 0, 2, apart});
    World world;
    const SceneInstance instance(scene, world);
    const auto depths = overlaps(world, scene, instance);
    ASSERT_EQ(depths.size(), 1u);
    EXPECT_NEAR(depths[0], 0.1, 1e-6);
    EXPECT_NEAR(largestJointGap(world), 0.05, 1e-6);
    world.setPose(instance.bodies[2], {{3, 5.8, 0}, {}});
    EXPECT_NEAR(largestDisplacement(world, scene, instance), 5, 1e-6);
    world.setVelocity(instance.bodies[2], {3, 4, 0}, {});
    EXPECT_NEAR(largestSpeed(world), 5, 1e-6);
}

TEST(Measure, QuantileIsAnElement) {
    EXPECT_EQ(quantile({}, 0.99), 0);
    EXPECT_EQ(quantile({1, 2, 3, 4}, 0.5), 2);
    EXPECT_EQ(quantile({1, 2, 3, 4}, 0.99), 4);
}

TEST(StepTimes, WorstSecondIsTheSlowestWindow) {
    StepTimes times(0.25);
    for (const double ms : {10, 10, 10, 10, 100, 10, 10, 10, 10, 10}) times.add(ms);
    EXPECT_NEAR(times.realTimeFactor(), 2.5 / 0.19, 1e-9);
    EXPECT_NEAR(times.worstSecond(), 1 / 0.13, 1e-9);
}

/// Two tonnes on links of some two kilograms: left to sweeps, by whatever guards them, they stand open by 0.17 m at the
/// turn of the first swing.
TEST(LargestJointGap, IsLessThanAHundredthOfALinkInTheShippedChain) {
    const Scene scene = loadScene(findScene("chain"));
    World world(scene.settings);
    const SceneInstance instance(scene, world);
    for (int i = 0; i < 180; ++i) {
        world.step(scene.step);
        ASSERT_LE(largestJointGap(world), 0.004) << i;
    }
}

}  // namespace
}  // namespace ragtop::demos
