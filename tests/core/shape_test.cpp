#include "ragtop/shape.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <random>
#include <set>

#include "shape_support.h"
#include "shapes/hull.h"

namespace ragtop {
namespace {

std::vector<Vec3> cloud(int count, unsigned seed, const Vec3& size = {1, 1, 1}) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<float> u(-1, 1);
    std::vector<Vec3> points;
    for (int i = 0; i < count; ++i) points.push_back(scale(size, {u(random), u(random), u(random)}));
    return points;
}

/// Closed, convex, Euler's formula, loops counter-clockwise, edges with the right faces.
void expectPolyhedron(const HullData& hull, std::span<const Vec3> points, float tolerance) {
    EXPECT_EQ(hull.vertices.size() + hull.faces.size(), hull.edges.size() + 2);
    EXPECT_EQ(hull.faceIndices.size(), 2 * hull.edges.size());
    EXPECT_EQ(hull.planes.size(), hull.faces.size());
    EXPECT_LE(hull.vertices.size(), 128u);
    const HullView view = viewOf(hull);
    for (std::size_t f = 0; f < hull.faces.size(); ++f) {
        const auto loop = view.loop(f);
        const Plane& plane = hull.planes[f];
        EXPECT_NEAR(length(plane.normal), 1, 1e-6f);
        ASSERT_GE(loop.size(), 3u);
        for (std::size_t i = 0; i < loop.size(); ++i) {
            const Vec3 &a = hull.vertices[loop[i]], &b = hull.vertices[loop[(i + 1) % loop.size()]],
                       &c = hull.vertices[loop[(i + 2) % loop.size()]];
            EXPECT_GT(dot(cross(b - a, c - b), plane.normal), 0) << "face " << f << " turns right at " << i;
            EXPECT_NEAR(dot(plane.normal, a), plane.offset, tolerance);
        }
        for (const Vec3& p : points) EXPECT_LE(dot(plane.normal, p), plane.offset + tolerance);
    }
    std::set<std::pair<int, int>> seen;
    for (const HullData::Edge& edge : hull.edges) {
        EXPECT_LT(edge.from, edge.to);
        EXPECT_TRUE(seen.insert({edge.from, edge.to}).second);
        const auto runs = [&](std::size_t face, int from, int to) {
            const auto loop = view.loop(face);
            const auto at = std::find(loop.begin(), loop.end(), from);
            return at != loop.end() && loop[static_cast<std::size_t>(at - loop.begin() + 1) % loop.size()] == to;
        };
        EXPECT_TRUE(runs(edge.leftFace, edge.from, edge.to));
        EXPECT_TRUE(runs(edge.rightFace, edge.to, edge.from));
    }
}

void expectSame(const HullData& a, const HullData& b, float ratio = 1) {
    ASSERT_EQ(a.vertices.size(), b.vertices.size());
    ASSERT_EQ(a.faces.size(), b.faces.size());
    ASSERT_EQ(a.edges.size(), b.edges.size());
    for (std::size_t i = 0; i < a.vertices.size(); ++i) EXPECT_EQ(a.vertices[i], ratio * b.vertices[i]);
    EXPECT_EQ(a.faceIndices, b.faceIndices);
    for (std::size_t i = 0; i < a.planes.size(); ++i) {
        EXPECT_EQ(a.planes[i].normal, b.planes[i].normal);
        EXPECT_EQ(a.planes[i].offset, ratio * b.planes[i].offset);
        EXPECT_EQ(a.faces[i].firstIndex, b.faces[i].firstIndex);
    }
    for (std::size_t i = 0; i < a.edges.size(); ++i) {
        EXPECT_EQ(a.edges[i].from, b.edges[i].from);
        EXPECT_EQ(a.edges[i].to, b.edges[i].to);
        EXPECT_EQ(a.edges[i].leftFace, b.edges[i].leftFace);
        EXPECT_EQ(a.edges[i].rightFace, b.edges[i].rightFace);
    }
    EXPECT_EQ(a.center, ratio * b.center);
    EXPECT_EQ(a.innerRadius, ratio * b.innerRadius);
}

TEST(Hull, OfBoxCornersIsTheBox) {
    RAGTOP_NEEDS_HULLS();
    const Vec3 half{0.5f, 1.25f, 0.1f};
    const ConvexHull hull(boxCorners(half));
    expectSame(hull.data(), boxHull(half));
    expectPolyhedron(hull.data(), hull.vertices(), 1e-6f);
}

TEST(Hull, OfAGridInABoxHasOnlyItsCorners) {
    RAGTOP_NEEDS_HULLS();
    std::vector<Vec3> points;
    for (int x = 0; x <= 7; ++x) {
        for (int y = 0; y <= 7; ++y) {
            for (int z = 0; z <= 7; ++z) {
                points.push_back(
                    {static_cast<float>(x) * 0.1f, static_cast<float>(y) * 0.3f, static_cast<float>(z) * 0.7f});
            }
        }
    }
    const ConvexHull hull(points);
    EXPECT_EQ(hull.vertices().size(), 8u);
    EXPECT_EQ(hull.data().faces.size(), 6u);
    expectPolyhedron(hull.data(), points, 1e-5f);
}

TEST(Hull, OfACylinderHasRoundCaps) {
    RAGTOP_NEEDS_HULLS();
    std::vector<Vec3> points;
    constexpr int kSides = 48;
    const Quat tilt = rotationAbout({1, 2, 3}, 1);
    for (int i = 0; i < kSides; ++i) {
        const SinCos turn = sinCos(2 * kPi * static_cast<float>(i) / kSides);
        for (const float y : {-0.2f, 0.2f}) points.push_back(rotate(tilt, {0.4f * turn.cos, y, 0.4f * turn.sin}));
    }
    const ConvexHull hull(points);
    EXPECT_EQ(hull.vertices().size(), points.size());
    EXPECT_EQ(hull.data().faces.size(), kSides + 2u);
    expectPolyhedron(hull.data(), points, 1e-5f);
}

TEST(Hull, OfACloudHoldsAllItsPoints) {
    RAGTOP_NEEDS_HULLS();
    for (const unsigned seed : {1u, 2u, 3u, 4u, 5u, 6u, 7u, 8u}) {
        const Vec3 size = seed % 2 ? Vec3{1, 1, 1} : Vec3{3, 0.02f, 0.4f};
        const std::vector<Vec3> points = cloud(20 * static_cast<int>(seed), seed, size);
        const ConvexHull hull(points);
        expectPolyhedron(hull.data(), points, 2e-4f);
    }
}

TEST(Hull, KeepsTheOutermost128Points) {
    RAGTOP_NEEDS_HULLS();
    const std::vector<Vec3> points = spherePoints(30, 2);
    const ConvexHull hull(points);
    EXPECT_EQ(hull.vertices().size(), 128u);
    expectPolyhedron(hull.data(), hull.vertices(), 1e-4f);
    // Caps of a sphere cut by the best possible 128-vertex hull are some 0.03 r high; allow twice that.
    EXPECT_GT(hull.data().innerRadius, 2 * (1 - 0.06f));
    EXPECT_EQ(hull.data().bounds.upper.y, 2);
    EXPECT_EQ(hull.data().bounds.lower.x, -2);
}

TEST(Hull, DependsOnThePointsAlone) {
    RAGTOP_NEEDS_HULLS();
    std::vector<Vec3> points = cloud(200, 11);
    const ConvexHull hull(points);
    std::mt19937 random(12);
    for (int i = 0; i < 5; ++i) {
        std::shuffle(points.begin(), points.end(), random);
        points.push_back(points[0]);
        expectSame(ConvexHull(points).data(), hull.data());
    }
}

TEST(Hull, ScalesByPowersOfTwoToTheBit) {
    RAGTOP_NEEDS_HULLS();
    for (const float ratio : {4.0f, 1.0f / 1024}) {
        std::vector<Vec3> points = spherePoints(12, 0.3f);
        const ConvexHull hull(points);
        for (Vec3& p : points) p *= ratio;
        expectSame(ConvexHull(points).data(), hull.data(), ratio);
    }
}

TEST(Hull, RefusesPointsWithoutVolume) {
    RAGTOP_NEEDS_HULLS();
    const float nan = std::numeric_limits<float>::quiet_NaN();
    std::vector<Vec3> points{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    expectThrow([&] { ConvexHull{points}; }, "ConvexHull: points has 3 entries, must have 4 to 65535");
    points.push_back({0, nan, 0});
    expectThrow([&] { ConvexHull{points}; }, "ConvexHull: points[3].y is nan, must be finite");
    points[3] = {5, 6, 0};
    expectThrow([&] { ConvexHull{points}; },
                "ConvexHull: points all lie in a plane to within 0 of their size, must span a volume");
    points = {{1, 2, 3}, {2, 4, 6}, {3, 6, 9}, {4, 8, 12}};
    expectThrow([&] { ConvexHull{points}; },
                "ConvexHull: points all lie in a plane to within 0 of their size, must span a volume");
    points = {{1, 2, 3}, {1, 2, 3}, {1, 2, 3}, {1, 2, 3}};
    expectThrow([&] { ConvexHull{points}; }, "ConvexHull: points are all at one place, must span a volume");
    points.assign(65536, Vec3{});
    expectThrow([&] { ConvexHull{points}; }, "ConvexHull: points has 65536 entries, must have 4 to 65535");
}

TEST(BoxHull, IsAPolyhedronWithoutAllocation) {
    constexpr BoxHull box({1, 2, 3});
    static_assert(box.innerRadius == 1);
    expectPolyhedron(boxHull({1, 2, 3}), box.vertices, 0);
    const HullView view = box.view();
    EXPECT_EQ(view.vertices.data(), box.vertices.data());
    EXPECT_EQ(view.edges.size(), 12u);
}

std::vector<Shape> solids() {
    std::vector<Shape> shapes{Sphere{0.3f}, Capsule{0.2f, 0.5f}, Box{{0.1f, 0.5f, 2}}};
    if (hullsCanBeBuilt()) shapes.push_back(ConvexHull(cloud(60, 21)));
    return shapes;
}

Quat someRotation(std::mt19937& random) {
    std::uniform_real_distribution<float> u(-1, 1);
    return normalized(Quat{u(random), u(random), u(random), u(random)});
}

TEST(Bounds, HoldAllSupportPointsAtTenKilometres) {
    std::mt19937 random(5);
    std::uniform_real_distribution<double> far(-1e4, 1e4);
    for (const Shape& shape : solids()) {
        const ConvexView view = convexView(shape);
        for (int i = 0; i < 300; ++i) {
            const Pose pose{{far(random), far(random), far(random)}, someRotation(random)};
            const Bounds bounds = boundsOf(shape, pose);
            for (const Vec3& axis :
                 {Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}, Vec3{-1, 0, 0}, Vec3{0, -1, 0}, Vec3{0, 0, -1}}) {
                const Vec3 core = supportOfCore(view, inverseRotate(pose.rotation, axis));
                const DVec3 p = transformPoint(pose, core) + view.radius * axis;
                EXPECT_LE(bounds.lower.x, p.x);
                EXPECT_LE(bounds.lower.y, p.y);
                EXPECT_LE(bounds.lower.z, p.z);
                EXPECT_GE(bounds.upper.x, p.x);
                EXPECT_GE(bounds.upper.y, p.y);
                EXPECT_GE(bounds.upper.z, p.z);
            }
        }
    }
}

TEST(Bounds, AreTightToTheRoundingOfPositions) {
    std::mt19937 random(6);
    for (const Shape& shape : solids()) {
        for (int i = 0; i < 100; ++i) {
            const Pose pose{{1, -2, 0.5}, someRotation(random)};
            const Bounds bounds = boundsOf(shape, pose);
            const ConvexView view = convexView(shape);
            const Vec3 core = supportOfCore(view, inverseRotate(pose.rotation, {1, 0, 0}));
            EXPECT_NEAR(bounds.upper.x, transformPoint(pose, core).x + view.radius, 5e-6);
        }
    }
}

TEST(Bounds, OfAnUnturnedBoxAtTheOriginAreTheBox) {
    const Bounds bounds = boundsOf(Box{{1, 2, 3}}, Frame{});
    EXPECT_LE(bounds.upper.x, 1.00001f);
    EXPECT_GE(bounds.upper.x, 1);
    EXPECT_GE(bounds.upper.z, 3);
    EXPECT_LE(bounds.lower.y, -2);
    EXPECT_EQ(boundsOf(Sphere{0.25f}, Pose{{1, 2, 3}, {}}).upper, (Vec3{1.25f, 2.25f, 3.25f}));
}

TEST(Bounds, OfSurfacesHoldTheirVertices) {
    const std::vector<Vec3> vertices{{5, 0, 0}, {5, 1, 1}, {7, 0, 3}};
    const std::vector<Triangle> triangles{{0, 1, 2}};
    const std::vector<float> heights{1, 2, 3, 4, 5, 6};
    std::mt19937 random(7);
    const TriangleMesh mesh(vertices, triangles);
    const HeightField field(3, 2, 2, heights);
    for (int i = 0; i < 100; ++i) {
        const Pose pose{{1e4, 3, -1e4}, someRotation(random)};
        for (const Vec3& v : vertices) {
            const DVec3 p = transformPoint(pose, v);
            const Bounds b = boundsOf(mesh, pose);
            EXPECT_TRUE(p.x >= b.lower.x && p.y >= b.lower.y && p.z >= b.lower.z && p.x <= b.upper.x &&
                        p.y <= b.upper.y && p.z <= b.upper.z);
        }
        const DVec3 p = transformPoint(pose, {4, 6, 2});
        const Bounds b = boundsOf(field, pose);
        EXPECT_TRUE(p.x >= b.lower.x && p.y >= b.lower.y && p.z >= b.lower.z && p.x <= b.upper.x && p.y <= b.upper.y &&
                    p.z <= b.upper.z);
    }
}

TEST(Bounds, OfABallsPathHoldTheBallAtBothEnds) {
    const DVec3 from(1e6 + 0.1, -2, 3), to(1e6 - 0.7, 5, 3);
    const Bounds path = boundsOfPath(from, to, 0.3f);
    EXPECT_TRUE(contains(path, boundsOf(Sphere{0.3f}, Pose{from, {}})));
    EXPECT_TRUE(contains(path, boundsOf(Sphere{0.3f}, Pose{to, {}})));
    EXPECT_NEAR(path.upper.y - path.lower.y, 7.6f, 1e-5f);
}

TEST(Shape, SizesAndRadiiAreThoseOfGeometry) {
    EXPECT_EQ(sizeOf(Box{{3, 1, 2}}), 1);
    EXPECT_EQ(sizeOf(Capsule{0.25f, 9}), 0.25f);
    EXPECT_FLOAT_EQ(radiusAbout(Box{{2, 3, 6}}, {}), 7);
    EXPECT_FLOAT_EQ(radiusAbout(Box{{2, 3, 6}}, {2, 3, 6}), 14);
    EXPECT_FLOAT_EQ(radiusAbout(Capsule{1, 3}, {0, 1, 0}), 5);
    EXPECT_FLOAT_EQ(radiusAbout(Sphere{1}, {3, 4, 0}), 6);
    Compound compound;
    compound.parts.push_back({Sphere{1}, {{3, 0, 0}, {}}});
    compound.parts.push_back({Box{{0.5f, 1, 1}}, {}});
    EXPECT_FLOAT_EQ(radiusAbout(compound, {}), 4);
    EXPECT_EQ(sizeOf(compound), 0.5f);
    const std::vector<float> heights{0, 0, 0, std::numeric_limits<float>::quiet_NaN(), 4, 0, 0, 0};
    EXPECT_FLOAT_EQ(radiusAbout(HeightField(4, 2, 1, heights), {0, 0, 1}), 4);
}

TEST(Shape, OnlyConvexOnesHaveAView) {
    Compound compound;
    compound.parts.push_back({Sphere{}, {}});
    expectThrow([&] { convexView(compound); }, "shape is a mesh, height field or compound; must be convex");
    EXPECT_EQ(convexView(Capsule{0.5f, 2}).halfExtents.y, 2);
}

TEST(Shape, SaysWhichNumberIsWrong) {
    EXPECT_EQ(whyInvalid(Shape{Sphere{}}), "");
    EXPECT_EQ(whyInvalid(Shape{Sphere{1e-4f}}), "");
    EXPECT_EQ(whyInvalid(Shape{Sphere{-1}}), "radius is -1, must be in [0.0001, 100000] m");
    EXPECT_EQ(whyInvalid(Shape{Box{{1, 0, 1}}}), "halfExtents.y is 0, must be in [0.0001, 100000] m");
    EXPECT_EQ(whyInvalid(Shape{Capsule{1, -2}}), "halfHeight is -2, must be in [0, 100000] m");
    EXPECT_EQ(whyInvalid(Shape{Sphere{std::numeric_limits<float>::quiet_NaN()}}),
              "radius is nan, must be in [0.0001, 100000] m");
    EXPECT_EQ(whyInvalid(Shape{Compound{}}), "parts is empty, must have at least 1");
    Compound compound;
    compound.parts.push_back({Sphere{1}, {}});
    compound.parts.push_back({Sphere{0}, {}});
    EXPECT_EQ(whyInvalid(Shape{compound}), "parts[1].shape.radius is 0, must be in [0.0001, 100000] m");
    compound.parts[1] = {Sphere{1}, {{}, {0, 0, 0, 2}}};
    EXPECT_EQ(whyInvalid(Shape{compound}),
              "parts[1].frame.rotation is (0, 0, 0, 2), must be finite and have length 1 to within 0.001");
}

}  // namespace
}  // namespace ragtop
