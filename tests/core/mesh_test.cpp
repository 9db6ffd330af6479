#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <limits>
#include <random>

#include "shape_support.h"
#include "shapes/geometry.h"

namespace ragtop {
namespace {

struct Surface {
    std::vector<Vec3> vertices;
    std::vector<Triangle> triangles;
    TriangleMesh mesh() const { return TriangleMesh(vertices, triangles); }
};

Surface triangleSoup(int count, unsigned seed, float size) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<float> u(-1, 1);
    Surface soup;
    for (std::uint32_t i = 0; i < static_cast<std::uint32_t>(count); ++i) {
        const Vec3 at{10 * u(random), u(random), 10 * u(random)};
        for (int k = 0; k < 3; ++k) soup.vertices.push_back(at + size * Vec3{u(random), u(random), u(random)});
        soup.triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
    }
    return soup;
}

/// A grid of n × n cells over the x–z plane, heights from `height`, either sharing vertices or each triangle with its
/// own.
template <class Height>
Surface grid(int n, bool shared, Height&& height) {
    Surface surface;
    const auto at = [&](int i, int j) { return Vec3{static_cast<float>(i), height(i, j), static_cast<float>(j)}; };
    const auto add = [&](const Vec3& v) {
        const auto old = std::find(surface.vertices.begin(), surface.vertices.end(), v);
        if (shared && old != surface.vertices.end()) {
            return static_cast<std::uint32_t>(old - surface.vertices.begin());
        }
        surface.vertices.push_back(v);
        return static_cast<std::uint32_t>(surface.vertices.size() - 1);
    };
    for (int j = 0; j < n; ++j) {
        for (int i = 0; i < n; ++i) {
            for (const bool second : {false, true}) {
                const std::uint32_t a = add(at(i, j));
                const std::uint32_t b = add(second ? at(i + 1, j + 1) : at(i, j + 1));
                const std::uint32_t c = add(second ? at(i + 1, j) : at(i + 1, j + 1));
                surface.triangles.push_back({a, b, c});
            }
        }
    }
    return surface;
}

Surface cube(float side) {
    Surface surface{boxCorners({side, side, side}), {}};
    for (const auto& [a, b, c, d] :
         {std::array{0u, 1u, 3u, 2u}, std::array{0u, 2u, 6u, 4u}, std::array{0u, 4u, 5u, 1u},
          std::array{1u, 5u, 7u, 3u}, std::array{2u, 3u, 7u, 6u}, std::array{4u, 6u, 7u, 5u}}) {
        surface.triangles.push_back({a, b, c});
        surface.triangles.push_back({a, c, d});
    }
    return surface;
}

int activeCount(const MeshData& mesh) {
    int count = 0;
    for (const std::uint8_t bits : mesh.activeEdges) count += std::popcount(bits);
    return count;
}

template <class Data>
std::vector<std::uint32_t> found(const Data& data, const Bounds& bounds) {
    std::vector<std::uint32_t> indices;
    forEachTriangle(data, bounds, [&](const TriangleView& t) {
        indices.push_back(t.index);
        return true;
    });
    return indices;
}

Bounds randomBounds(std::mt19937& random, float reach) {
    std::uniform_real_distribution<float> u(-1, 1);
    const Vec3 at{reach * u(random), u(random), reach * u(random)};
    const Vec3 half = abs(scale({reach * u(random), 1, reach * u(random)}, {u(random), u(random), u(random)}));
    return {at - half, at + half};
}

TEST(Mesh, QueriesFindExactlyWhatBruteForceFinds) {
    for (const int count : {1, 3, 5, 40, 700}) {
        const Surface soup = triangleSoup(count, 1, count > 100 ? 0.3f : 2);
        const TriangleMesh mesh = soup.mesh();
        ASSERT_EQ(mesh.degenerateCount(), 0);
        std::mt19937 random(2);
        for (int i = 0; i < 300; ++i) {
            const Bounds bounds = randomBounds(random, 10);
            std::vector<std::uint32_t> wanted;
            for (std::uint32_t t = 0; t < soup.triangles.size(); ++t) {
                const Vec3 &a = soup.vertices[3 * t], &b = soup.vertices[3 * t + 1], &c = soup.vertices[3 * t + 2];
                if (overlaps({min(min(a, b), c), max(max(a, b), c)}, bounds)) wanted.push_back(t);
            }
            std::vector<std::uint32_t> got = found(mesh.data(), bounds);
            std::sort(got.begin(), got.end());
            EXPECT_EQ(got, wanted);
        }
    }
}

TEST(Mesh, WalkOfAllSpaceFindsEveryTriangleOnceInTreeOrder) {
    const float everywhere = std::numeric_limits<float>::infinity();
    const Bounds all{{-everywhere, -everywhere, -everywhere}, {everywhere, everywhere, everywhere}};
    for (const int count : {1, 4, 5, 17, 900}) {
        const TriangleMesh mesh = triangleSoup(count, 7, 0.2f).mesh();
        const auto source = mesh.data().sourceIndex;
        EXPECT_EQ(found(mesh.data(), all), (std::vector<std::uint32_t>(source.begin(), source.end())));
    }
}

TEST(Mesh, TreeHoldsEveryTriangleOnceInSmallLeaves) {
    for (const float size : {1.0f, 0.0f}) {
        // With size 0 the triangles of all places but one are moved onto each other.
        Surface soup = triangleSoup(900, 3, 0.2f);
        if (size == 0) {
            for (std::size_t i = 3; i < soup.vertices.size(); ++i) soup.vertices[i] = soup.vertices[i % 3];
        }
        const TriangleMesh mesh = soup.mesh();
        const MeshData& data = mesh.data();
        std::vector<int> seen(data.triangles.size(), 0);
        for (const MeshBranch& branch : data.branches)
            for (int child = 0; child < branch.children(); ++child) {
                EXPECT_LE(branch.count[child], 4u);
                for (std::uint32_t i = 0; i < branch.count[child]; ++i) {
                    const std::uint32_t t = branch.first[child] + i;
                    ++seen[t];
                    for (const std::uint32_t v : {data.triangles[t].a, data.triangles[t].b, data.triangles[t].c}) {
                        EXPECT_TRUE(contains(branch.bounds(child), {data.vertices[v], data.vertices[v]}));
                    }
                }
            }
        EXPECT_EQ(std::count(seen.begin(), seen.end(), 1), 900);
        // Of two or more children each, and n leaves of at least one triangle, n − 1 at most are branches.
        EXPECT_LT(data.branches.size(), 900u);
        for (std::size_t i = 0; i < data.triangles.size(); ++i) {
            EXPECT_EQ(data.triangles[i].a, soup.triangles[data.sourceIndex[i]].a);
        }
    }
}

TEST(Mesh, OfExponentialScalesIsStillAShallowTree) {
    Surface surface;
    for (std::uint32_t i = 0; i < 200; ++i) {
        const float x = std::ldexp(1.0f, static_cast<int>(i) - 100);
        surface.vertices.insert(surface.vertices.end(), {{x, 0, 0}, {x, 0, x}, {2 * x, 0, 0}});
        surface.triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
    }
    const TriangleMesh mesh = surface.mesh();
    EXPECT_EQ(found(mesh.data(), mesh.data().bounds).size(), 200u - static_cast<unsigned>(mesh.degenerateCount()));
}

TEST(Mesh, EndsAQueryWhenTheVisitorSaysSo) {
    const TriangleMesh mesh = triangleSoup(100, 4, 1).mesh();
    int visits = 0;
    forEachTriangle(mesh.data(), mesh.data().bounds, [&](const TriangleView&) { return ++visits < 7; });
    EXPECT_EQ(visits, 7);
}

TEST(Mesh, FlatGridHasActiveEdgesOnItsBorderOnly) {
    for (const bool shared : {true, false}) {
        const TriangleMesh mesh = grid(6, shared, [](int, int) { return 0.5f; }).mesh();
        EXPECT_EQ(activeCount(mesh.data()), 4 * 6) << shared;
        for (const Vec3& n : mesh.data().normals) EXPECT_EQ(n, (Vec3{0, 1, 0}));
    }
}

TEST(Mesh, CubeHasTwelveActiveEdges) {
    const TriangleMesh mesh = cube(0.7f).mesh();
    EXPECT_EQ(activeCount(mesh.data()), 2 * 12);
    // The inside of a box is concave everywhere.
    Surface room = cube(5);
    for (Triangle& t : room.triangles) std::swap(t.b, t.c);
    EXPECT_EQ(activeCount(room.mesh().data()), 0);
}

TEST(Mesh, RidgesAreActiveAndValleysAreNot) {
    const auto roof = [](float slope) {
        return grid(2, true, [slope](int i, int) { return i == 1 ? slope : 0.0f; }).mesh();
    };
    // Two edges of the ridge, seen from both sides, and 8 of the border.
    EXPECT_EQ(activeCount(roof(0.5f).data()), 8 + 4);
    EXPECT_EQ(activeCount(roof(-0.5f).data()), 8);
    // Slopes of ±0.4° bend by 0.8°, of ±0.6° by 1.2°.
    EXPECT_EQ(activeCount(roof(0.00698f).data()), 8);
    EXPECT_EQ(activeCount(roof(0.01047f).data()), 8 + 4);
}

TEST(Mesh, DoubleSidedSheetIsSmoothInside) {
    Surface sheet = grid(3, true, [](int, int) { return 0.0f; });
    const std::vector<Triangle> front = sheet.triangles;
    for (const Triangle& t : front) sheet.triangles.push_back({t.a, t.c, t.b});
    EXPECT_EQ(activeCount(sheet.mesh().data()), 2 * 4 * 3);
}

TEST(Mesh, LeavesOutAndCountsTrianglesWithoutArea) {
    const std::vector<Vec3> vertices{{0, 0, 0}, {0, 0, 1}, {1, 0, 0}, {2, 0, 0}};
    const std::vector<Triangle> triangles{{0, 2, 3}, {0, 1, 2}, {1, 1, 2}};
    const TriangleMesh mesh(vertices, triangles);
    EXPECT_EQ(mesh.degenerateCount(), 2);
    EXPECT_EQ(mesh.triangles().size(), 3u);
    EXPECT_EQ(found(mesh.data(), mesh.data().bounds), std::vector<std::uint32_t>{1});
}

TEST(Mesh, RefusesBadInputNamingIt) {
    const std::vector<Vec3> vertices{{0, 0, 0}, {0, 0, 1}, {1, 0, 0}};
    std::vector<Triangle> triangles{{0, 1, 2}};
    std::vector<Vec3> bad = vertices;
    bad[1].z = std::numeric_limits<float>::infinity();
    expectThrow([&] { TriangleMesh({}, triangles); }, "TriangleMesh: vertices is empty, must have at least 3");
    expectThrow([&] { TriangleMesh(vertices, {}); }, "TriangleMesh: triangles is empty, must have at least 1");
    expectThrow([&] { TriangleMesh(bad, triangles); }, "TriangleMesh: vertices[1].z is inf, must be finite");
    const std::vector<std::uint8_t> none{0, 0}, first{0}, second{1};
    const std::vector<Material> materials{Material{}}, negative{Material{.friction = -1}};
    expectThrow([&] { TriangleMesh(vertices, triangles, none, materials); },
                "TriangleMesh: materialOfTriangle has 2 entries, must have none or one per triangle, 1");
    expectThrow([&] { TriangleMesh(vertices, triangles, second, materials); },
                "TriangleMesh: materialOfTriangle[0] is 1, must be less than the number of materials, 1");
    expectThrow([&] { TriangleMesh(vertices, triangles, first, negative); },
                "TriangleMesh: materials[0].friction is -1, must be in [0, 10]");
    triangles.push_back({0, 1, 3});
    expectThrow([&] { TriangleMesh(vertices, triangles); }, "TriangleMesh: triangles[1].c is 3, must be in [0, 2]");
    triangles = {{0, 0, 1}};
    expectThrow([&] { TriangleMesh(vertices, triangles); },
                "TriangleMesh: triangles has 1 without area, must have at least 1 with area");
}

std::vector<float> hills(int columns, int rows, unsigned seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<float> u(-0.5f, 0.5f);
    std::vector<float> heights;
    for (int i = 0; i < columns * rows; ++i) heights.push_back(u(random));
    return heights;
}

TEST(HeightField, QueriesFindExactlyWhatBruteForceFinds) {
    for (const float spacing : {1.0f, 0.1f, 7.3f}) {
        std::vector<float> heights = hills(9, 6, 1);
        heights[20] = std::numeric_limits<float>::quiet_NaN();
        const HeightField field(9, 6, spacing, heights);
        std::mt19937 random(3);
        for (int k = 0; k < 500; ++k) {
            Bounds bounds = randomBounds(random, 12 * spacing);
            if (k % 5 == 0) bounds.lower.x = spacing * static_cast<float>(k % 8);  // touching a column of samples
            std::vector<std::uint32_t> wanted;
            for (int row = 0; row < 5; ++row) {
                for (int column = 0; column < 8; ++column) {
                    for (int half = 0; half < 2; ++half) {
                        const TriangleView t = triangleOf(field.data(), column, row, half);
                        if (std::isnan(t.a.y) || std::isnan(t.b.y) || std::isnan(t.c.y)) continue;
                        const Bounds own{min(min(t.a, t.b), t.c), max(max(t.a, t.b), t.c)};
                        if (overlaps(own, bounds)) wanted.push_back(t.index);
                    }
                }
            }
            EXPECT_EQ(found(field.data(), bounds), wanted);
        }
        const float far = std::numeric_limits<float>::infinity();
        // A sample belongs to six triangles.
        EXPECT_EQ(found(field.data(), {{-far, -far, -far}, {far, far, far}}).size(), 2u * 8 * 5 - 6);
        EXPECT_TRUE(found(field.data(), {{1e30f, -1, 1e30f}, {2e30f, 1, 2e30f}}).empty());
    }
}

TEST(HeightField, IsTheMeshOfItsTriangles) {
    const int n = 7;
    const std::vector<float> heights = hills(n + 1, n + 1, 4);
    const HeightField field(n + 1, n + 1, 1, heights);
    const TriangleMesh mesh =
        grid(n, true, [&](int i, int j) { return heights[static_cast<std::size_t>(j * (n + 1) + i)]; }).mesh();
    for (std::size_t i = 0; i < mesh.data().triangles.size(); ++i) {
        const std::uint32_t index = mesh.data().sourceIndex[i];
        EXPECT_EQ(field.data().normals[index], mesh.data().normals[i]);
        EXPECT_EQ(field.data().activeEdges[index], mesh.data().activeEdges[i]) << index;
        EXPECT_GT(mesh.data().normals[i].y, 0);
    }
}

TEST(HeightField, FlatOneHasActiveEdgesAtBorderAndHoleOnly) {
    std::vector<float> heights(6 * 6, 2.0f);
    const auto active = [&] {
        const HeightField field(6, 6, 0.5f, heights);
        int count = 0;
        for (const std::uint8_t bits : field.data().activeEdges) count += std::popcount(bits);
        return count;
    };
    EXPECT_EQ(active(), 4 * 5);
    heights[2 * 6 + 2] = std::numeric_limits<float>::quiet_NaN();
    EXPECT_EQ(active(), 4 * 5 + 6);
}

TEST(HeightField, RefusesBadInputNamingIt) {
    const float inf = std::numeric_limits<float>::infinity(), nan = std::numeric_limits<float>::quiet_NaN();
    std::vector<float> heights(4, 0.0f);
    expectThrow([&] { HeightField(1, 4, 1, heights); }, "HeightField: columns is 1, must be at least 2");
    expectThrow([&] { HeightField(4, 1, 1, heights); }, "HeightField: rows is 1, must be at least 2");
    expectThrow([&] { HeightField(2, 2, 0, heights); }, "HeightField: spacing is 0, must be finite and above 0 m");
    expectThrow([&] { HeightField(2, 2, nan, heights); }, "HeightField: spacing is nan, must be finite and above 0 m");
    expectThrow([&] { HeightField(3, 2, 1, heights); },
                "HeightField: heights has 4 entries, must have columns x rows, 6");
    heights[2] = -inf;
    expectThrow([&] { HeightField(2, 2, 1, heights); },
                "HeightField: heights[2] is -inf, must be finite, or NaN for a hole");
    heights.assign(4, nan);
    expectThrow([&] { HeightField(2, 2, 1, heights); },
                "HeightField: heights leaves no triangle, must have one without NaN");
}

}  // namespace
}  // namespace ragtop
