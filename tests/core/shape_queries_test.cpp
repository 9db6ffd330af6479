#include "world/shape_queries.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <stdexcept>
#include <vector>

#include "shape_support.h"
#include "shapes/geometry.h"

namespace ragtop {
namespace {

constexpr float kEpsilon = std::numeric_limits<float>::epsilon();

struct QueryDice {
    std::mt19937 engine{17};
    float uniform(float lower, float upper) { return std::uniform_real_distribution<float>(lower, upper)(engine); }
    Vec3 point(float size) { return {uniform(-size, size), uniform(-size, size), uniform(-size, size)}; }
    Quat rotation() { return normalized(Quat{uniform(-1, 1), uniform(-1, 1), uniform(-1, 1), uniform(-1, 1)}); }
};

float heightAt(int i, int j) {
    return 2 * std::sin(0.7f * static_cast<float>(i)) * std::cos(0.5f * static_cast<float>(j));
}

HeightField hills() {
    std::vector<float> heights;
    for (int j = 0; j < 21; ++j) {
        for (int i = 0; i < 31; ++i) heights.push_back(heightAt(i, j));
    }
    heights[10 * 31 + 15] = std::numeric_limits<float>::quiet_NaN();
    return HeightField(31, 21, 0.75f, heights);
}

// The same hills, without the hole.
TriangleMesh hillsAsMesh() {
    std::vector<Vec3> vertices;
    std::vector<Triangle> triangles;
    for (std::uint32_t j = 0; j < 21; ++j) {
        for (std::uint32_t i = 0; i < 31; ++i) {
            vertices.push_back({0.75f * static_cast<float>(i), heightAt(static_cast<int>(i), static_cast<int>(j)),
                                0.75f * static_cast<float>(j)});
            if (i == 30 || j == 20) continue;
            const std::uint32_t v = j * 31 + i;
            triangles.push_back({v, v + 31, v + 32});
            triangles.push_back({v, v + 32, v + 1});
        }
    }
    return TriangleMesh(vertices, triangles);
}

std::vector<TriangleView> allTriangles(const Shape& shape) {
    constexpr float kAll = 1e6f;
    std::vector<TriangleView> out;
    const auto keep = [&](const TriangleView& view) {
        out.push_back(view);
        return true;
    };
    const Bounds everything{{-kAll, -kAll, -kAll}, {kAll, kAll, kAll}};
    if (const auto* mesh = std::get_if<TriangleMesh>(&shape)) {
        forEachTriangle(mesh->data(), everything, keep);
    } else {
        forEachTriangle(std::get<HeightField>(shape).data(), everything, keep);
    }
    return out;
}

// A ray or path from around the hills to around them, in the frame of the hills.
Ray pathOver(QueryDice& random, int i) {
    Vec3 from{random.uniform(-10, 33), random.uniform(-3, 8), random.uniform(-10, 25)};
    Vec3 to{random.uniform(-10, 33), random.uniform(-8, 3), random.uniform(-10, 25)};
    if (i % 4 == 0) to = {from.x, -5, from.z};
    if (i % 5 == 0) to.y = from.y = random.uniform(-1, 1);
    return {DVec3(from), to - from};
}

TEST(ShapeQueries, RaysMeetConvexShapesWhereGeometrySaysAnywhereInTheWorld) {
    // A box turned by 90° about z, far from the origin: its x extent points along y.
    const Pose pose{{1e7, 2e6, -3e7}, rotationAbout({0, 0, 1}, kPi / 2)};
    std::uint32_t triangle = 77;
    const Ray down{pose.position + DVec3{0.25, 10, 0.25}, {0, -20, 0}};
    const SweepHit box = castRayAtShape(Box{{2, 1, 1}}, pose, down, 1, triangle);
    ASSERT_TRUE(box.hit);
    EXPECT_NEAR(box.fraction, 0.4f, 4 * kEpsilon);
    // A quarter turn is only as exact as π; the shape is 2 m.
    EXPECT_NEAR(length(rotate(pose.rotation, box.normal) - Vec3{0, 1, 0}), 0, 4 * kEpsilon);
    EXPECT_NEAR(length(rotate(pose.rotation, box.point) - Vec3{0.25f, 2, 0.25f}), 0, 20 * 4 * kEpsilon);
    const Ray atCenter{pose.position + DVec3{0, 10, 0}, {0, -20, 0}};
    EXPECT_NEAR(castRayAtShape(Sphere{2}, pose, atCenter, 1, triangle).fraction, 0.4f, 4 * kEpsilon);
    EXPECT_EQ(triangle, 77u);
    EXPECT_FALSE(castRayAtShape(Sphere{2}, pose, atCenter, 0.3f, triangle).hit);
    EXPECT_EQ(castRayAtShape(Sphere{2}, pose, {pose.position, {0, -20, 0}}, 1, triangle).fraction, 0);
}

TEST(ShapeQueries, RaysAtTrianglesFindWhatTryingAllFinds) {
    QueryDice random;
    for (const Shape& shape : {Shape(hills()), Shape(hillsAsMesh())}) {
        const std::vector<TriangleView> triangles = allTriangles(shape);
        int hits = 0;
        for (int i = 0; i < 2000; ++i) {
            const Ray ray = pathOver(random, i);
            const float closer = i % 3 == 0 ? 0.6f : 1;
            SweepHit expected;
            expected.fraction = closer;
            for (const TriangleView& view : triangles) {
                const SweepHit hit = castRay(view, toVec3(ray.origin), ray.translation, expected.fraction);
                if (hit.hit && (!expected.hit || hit.fraction < expected.fraction)) expected = hit;
            }
            std::uint32_t triangle = 0xffffffffu;
            const SweepHit found = castRayAtShape(shape, {}, ray, closer, triangle);
            ASSERT_EQ(found.hit, expected.hit) << "ray " << i;
            if (!found.hit) {
                EXPECT_EQ(triangle, 0xffffffffu);
                continue;
            }
            ++hits;
            ASSERT_EQ(found.fraction, expected.fraction) << "ray " << i;
            bool named = false;
            for (const TriangleView& view : triangles) {
                if (view.index != triangle) continue;
                named = castRay(view, toVec3(ray.origin), ray.translation, closer).fraction == found.fraction;
            }
            EXPECT_TRUE(named);
        }
        EXPECT_GT(hits, 300);
    }
}

TEST(ShapeQueries, RaysPassHolesAndBacks) {
    const Shape field = hills();
    std::uint32_t triangle = 0;
    const Ray throughHole{{15 * 0.75 + 0.1, 10, 10 * 0.75 + 0.05}, {0, -20, 0}};
    EXPECT_FALSE(castRayAtShape(field, {}, throughHole, 1, triangle).hit);
    EXPECT_TRUE(castRayAtShape(hillsAsMesh(), {}, throughHole, 1, triangle).hit);
    const Ray fromBelow{{5.1, -10, 5.2}, {0, 20, 0}};
    EXPECT_FALSE(castRayAtShape(field, {}, fromBelow, 1, triangle).hit);
    EXPECT_FALSE(castRayAtShape(hillsAsMesh(), {}, fromBelow, 1, triangle).hit);
}

TEST(ShapeQueries, SweepsAtTrianglesFindWhatTryingAllFinds) {
    QueryDice random;
    std::vector<Vec3> corners;
    for (int i = 0; i < 12; ++i) corners.push_back(random.point(0.8f) + Vec3{0.5f, 0, 0});
    std::vector<Shape> movers{Sphere{0.4f}, Capsule{0.3f, 0.6f}, Box{{0.2f, 0.5f, 1.2f}}};
    if (hullsCanBeBuilt()) movers.push_back(ConvexHull(corners));
    for (const Shape& shape : {Shape(hills()), Shape(hillsAsMesh())}) {
        const std::vector<TriangleView> triangles = allTriangles(shape);
        for (int i = 0; i < 120; ++i) {
            const Ray path = pathOver(random, i);
            const Shape& mover = movers[static_cast<std::size_t>(i) % movers.size()];
            const Quat rotation = random.rotation();
            SweepHit expected;
            for (const TriangleView& view : triangles) {
                const SweepHit hit = sweep(view, convexView(mover), {toVec3(path.origin), rotation}, path.translation,
                                           expected.fraction);
                if (hit.hit && (!expected.hit || hit.fraction < expected.fraction)) expected = hit;
            }
            std::uint32_t triangle = 0;
            const SweepHit found = sweepShapeAtShape(mover, rotation, path, shape, {}, 1, triangle);
            // Sweeps end within 1e-5 of the mover's reach (below 2 m) of the surface; grazing can stretch or lose that.
            if (expected.hit != found.hit) {
                const SweepHit& only = expected.hit ? expected : found;
                EXPECT_LT(std::abs(dot(only.normal, normalized(path.translation))), 0.01f) << "path " << i;
                continue;
            }
            EXPECT_NEAR(found.fraction, expected.fraction, 1e-3f) << "path " << i;
        }
    }
}

TEST(ShapeQueries, SweptBallMeetsAPlaneOneRadiusEarly) {
    const Vec3 vertices[] = {{-50, 0, -50}, {-50, 0, 50}, {50, 0, 50}, {50, 0, -50}};
    const Triangle triangles[] = {{0, 1, 2}, {0, 2, 3}};
    const Shape floor = TriangleMesh(vertices, triangles);
    const Pose pose{{3e6, -1e6, 5e6}, rotationAbout({1, 2, 3}, 1)};
    std::uint32_t triangle = 9;
    const Ray path{pose.position + rotate(pose.rotation, {3, 4, -7}), rotate(pose.rotation, {1, -8, 2})};
    const SweepHit hit = sweepShapeAtShape(Sphere{0.5f}, {}, path, floor, pose, 1, triangle);
    ASSERT_TRUE(hit.hit);
    // 3.5 of 8 m; the tolerance of sweeps is 1e-5 radii, and positions near 10 m are rounded.
    EXPECT_NEAR(hit.fraction, 3.5f / 8, (1e-5f * 0.5f + 10 * 4 * kEpsilon) / 8);
    EXPECT_NEAR(hit.normal.y, 1, 4 * kEpsilon);
    EXPECT_NEAR(hit.point.x, 3 + 3.5f / 8, 1e-4f);
    EXPECT_EQ(triangle, 1u);  // the half with x > z
}

TEST(ShapeQueries, SweptBoxesMeetFaceToFace) {
    std::uint32_t triangle = 0;
    const Ray path{{-5, 0.3, 0}, {10, 0, 0}};
    const SweepHit hit = sweepShapeAtShape(Box{{1, 1, 1}}, {}, path, Box{{2, 1, 1}}, {}, 1, triangle);
    ASSERT_TRUE(hit.hit);
    EXPECT_NEAR(hit.fraction, 0.2f, 1e-5f);
    EXPECT_NEAR(hit.normal.x, -1, 4 * kEpsilon);
    const Ray above{{-5, 2.3, 0}, {10, 0, 0}};
    EXPECT_FALSE(sweepShapeAtShape(Box{{1, 1, 1}}, {}, above, Box{{2, 1, 1}}, {}, 1, triangle).hit);
}

TEST(ShapeQueries, OverlapsAgreeWithDistance) {
    const Pose pose{{1e6, 0, 0}, rotationAbout({0, 1, 0}, 0.3f)};
    const auto beside = [&](float x) { return pose * Frame{{x, 0, 0}, {}}; };
    EXPECT_TRUE(overlapsShape(Sphere{1}, beside(2.9f), Box{{2, 2, 2}}, pose));
    EXPECT_FALSE(overlapsShape(Sphere{1}, beside(3.1f), Box{{2, 2, 2}}, pose));
    EXPECT_TRUE(overlapsShape(Sphere{0.1f}, beside(0), Box{{2, 2, 2}}, pose)) << "inside";
    QueryDice random;
    for (const Shape& shape : {Shape(hills()), Shape(hillsAsMesh())}) {
        const std::vector<TriangleView> triangles = allTriangles(shape);
        for (int i = 0; i < 300; ++i) {
            const Shape query = i % 2 == 0 ? Shape(Box{{0.3f, 0.6f, 0.9f}}) : Shape(Capsule{0.3f, 0.5f});
            const Vec3 position{random.uniform(-2, 24), random.uniform(-3, 3), random.uniform(-2, 17)};
            const Frame frame{position, random.rotation()};
            bool expected = false;
            for (const TriangleView& view : triangles) {
                expected = expected || distance(view, convexView(query), frame).distance <= 0;
            }
            EXPECT_EQ(overlapsShape(query, {DVec3(frame.position), frame.rotation}, shape, {}), expected) << i;
        }
    }
}

TEST(ShapeQueries, OnlyConvexShapesMove) {
    std::uint32_t triangle = 0;
    const Shape mesh = hillsAsMesh();
    EXPECT_THROW(sweepShapeAtShape(mesh, {}, {}, Sphere{}, {}, 1, triangle), std::invalid_argument);
    EXPECT_THROW(overlapsShape(mesh, {}, Sphere{}, {}), std::invalid_argument);
}

TEST(ShapeQueries, AnotherScaleGivesTheSameBits) {
    QueryDice random;
    std::vector<float> heights;
    for (int i = 0; i < 100; ++i) heights.push_back(random.uniform(0, 1));
    std::vector<float> fourfold = heights;
    for (float& height : fourfold) height *= 4;
    const Shape small = HeightField(10, 10, 0.5f, heights);
    const Shape large = HeightField(10, 10, 2, fourfold);
    for (int i = 0; i < 300; ++i) {
        const Vec3 from{random.uniform(0, 5), 2, random.uniform(0, 5)};
        const Vec3 along{random.uniform(-2, 2), -3, random.uniform(-2, 2)};
        std::uint32_t a = 0, b = 0;
        const SweepHit hit = castRayAtShape(small, {}, {DVec3(from), along}, 1, a);
        const SweepHit scaled = castRayAtShape(large, {}, {DVec3(4 * from), 4 * along}, 1, b);
        ASSERT_EQ(hit.hit, scaled.hit);
        ASSERT_EQ(a, b);
        ASSERT_EQ(hit.fraction, scaled.fraction);
        ASSERT_EQ(4 * hit.point, scaled.point);
        const SweepHit swept = sweepShapeAtShape(Sphere{0.125f}, {}, {DVec3(from), along}, small, {}, 1, a);
        const SweepHit sweptScaled = sweepShapeAtShape(Sphere{0.5f}, {}, {DVec3(4 * from), 4 * along}, large, {}, 1, b);
        ASSERT_EQ(swept.fraction, sweptScaled.fraction);
        ASSERT_EQ(4 * swept.point, sweptScaled.point);
    }
}

}  // namespace
}  // namespace ragtop
