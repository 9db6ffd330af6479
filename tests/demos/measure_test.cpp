#include "measure.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "convex_depth.h"
#include "double_math.h"
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

/// The least overlap over all planes through three corners of one hull and all products of two lines through corners:
/// the normals of faces and pairs of edges are among them.
double exhaustiveOverlap(const ConvexSolid& a, const ConvexSolid& b) {
    double least = std::numeric_limits<double>::infinity();
    const auto test = [&](const DVec3& product) {
        if (!(length(product) > 1e-9)) return;
        const DVec3 n = (1 / length(product)) * product;
        double low[2] = {1e9, 1e9}, high[2] = {-1e9, -1e9};
        for (const int i : {0, 1}) {
            for (const DVec3& p : (i == 0 ? a : b).points)
                low[i] = std::min(low[i], dot(p, n)), high[i] = std::max(high[i], dot(p, n));
        }
        least = std::min({least, high[0] - low[1], high[1] - low[0]});
    };
    const auto linesOf = [](const ConvexSolid& solid) {
        std::vector<DVec3> lines;
        for (const DVec3& p : solid.points)
            for (const DVec3& q : solid.points) lines.push_back(q - p);
        return lines;
    };
    const std::vector<DVec3> linesA = linesOf(a), linesB = linesOf(b);
    for (const auto* lines : {&linesA, &linesB})
        for (const DVec3& e : *lines)
            for (const DVec3& f : linesA) test(cross(e, f));
    for (const DVec3& e : linesB)
        for (const DVec3& f : linesB) test(cross(e, f));
    return std::max(0.0, least);
}

TEST(OverlapDepth, OfHullsIsTheLeastOfAllTheirPlanesAndPairsOfEdges) {
    std::mt19937 random(5);
    const auto number = [&] { return std::uniform_real_distribution<float>(-1, 1)(random); };
    const auto hull = [&] {
        std::vector<Vec3> points(8);
        for (Vec3& p : points) p = {number(), 0.3f * number(), number()};
        return ConvexHull(points);
    };
    int deep = 0;
    for (int i = 0; i < 100; ++i) {
        const Shape a = hull(), b = hull();
        const Pose at{{number(), 0.5 * static_cast<double>(number()), number()},
                      rotationAbout({number(), number(), 1.1f}, kPi * number())};
        const double expected = exhaustiveOverlap(solidOf(a, {}), solidOf(b, at));
        EXPECT_NEAR(depth(a, {}, b, at), expected, 1e-8) << i;
        deep += expected > 0.01 ? 1 : 0;
    }
    EXPECT_GT(deep, 20);
}

TEST(OverlapDepth, OfFlatAndDistantSolidsIsFound) {
    const Shape sheet = Box{{1, 1e-4f, 1}};
    EXPECT_NEAR(depth(sheet, {}, sheet, {{0.5, 1e-4, 0.5}, {}}), 1e-4, 1e-9);
    EXPECT_EQ(depth(sheet, {}, sheet, {{0, 3e-4, 0}, {}}), 0);
    EXPECT_EQ(depth(sheet, {}, sheet, {{1e6, 0, 1e6}, {}}), 0);
    EXPECT_NEAR(depth(sheet, {{1e6, 0, 0}, {}}, Sphere{0.5f}, {{1e6, 0.3, 0}, {}}), 0.2001, 1e-6);
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
