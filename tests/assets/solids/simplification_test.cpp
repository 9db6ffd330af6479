#include "ragtop/simplification.h"

#include <gmock/gmock.h>

#include "solids/surface_tree.h"
#include "solids/written_solids.h"

namespace ragtop {
namespace {

/// m, farthest that points all over one surface are from another.
double farthest(std::span<const Vec3> from, std::span<const Triangle> triangles, std::span<const Vec3> to,
                std::span<const Triangle> other) {
    std::vector<DVec3> places;
    for (const Vec3& v : to) places.emplace_back(v);
    const SurfaceTree tree(places, other);
    double most = 0;
    for (const Triangle& t : triangles)
        for (const auto& [u, v] : {std::pair{0.0, 0.0}, {1.0, 0.0}, {0.0, 1.0}, {0.5, 0.5}, {0.3, 0.3}, {0.1, 0.6}}) {
            const DVec3 a(from[t.a]), b(from[t.b]), c(from[t.c]);
            most = std::max(most, tree.distance(a + u * (b - a) + v * (c - a)));
        }
    return most;
}

/// Between the points that are looked at, of triangles of at most the error's size, it is hardly more.
constexpr double kBetween = 1.2;

TEST(Simplification, KeepsWithinTheErrorBothWays) {
    const written::Solid ring = written::torus(0.4, 0.12, 120, 48);
    std::size_t before = ring.triangles.size();
    for (const float error : {5e-4f, 2e-3f, 1e-2f}) {
        const SimplerSurface less = simplify(ring.vertices, ring.triangles, error);
        EXPECT_LT(less.triangles.size(), before);
        before = less.triangles.size();
        EXPECT_LE(less.error, error);
        EXPECT_LE(farthest(ring.vertices, ring.triangles, less.vertices, less.triangles), kBetween * error);
        EXPECT_LE(farthest(less.vertices, less.triangles, ring.vertices, ring.triangles), kBetween * error);
        EXPECT_GT(massOf(TriangleMesh(less.vertices, less.triangles), 1).mass, 0);  // closed still
    }
}

TEST(Simplification, OfAFlatSheetLeavesItsBorder) {
    written::Solid sheet;
    constexpr std::uint32_t kSide = 20;
    for (std::uint32_t i = 0; i < kSide * kSide; ++i)
        sheet.vertices.push_back({static_cast<float>(i % kSide), 0, static_cast<float>(i / kSide)});
    for (std::uint32_t i = 0; i + 1 < kSide; ++i)
        for (std::uint32_t j = 0; j + 1 < kSide; ++j) {
            const std::uint32_t at = i * kSide + j;
            sheet.triangles.push_back({at, at + kSide, at + 1});
            sheet.triangles.push_back({at + 1, at + kSide, at + kSide + 1});
        }
    const SimplerSurface less = simplify(sheet.vertices, sheet.triangles, 1e-3f);
    EXPECT_LE(less.triangles.size(), 4u);
    EXPECT_LE(farthest(sheet.vertices, sheet.triangles, less.vertices, less.triangles), 1e-3);
}

TEST(Simplification, ScalesWithTheSurface) {
    const written::Solid cup = written::cup(0.04, 0.006, 0.095, 64);
    const std::size_t one = simplify(cup.vertices, cup.triangles, 1e-3f).triangles.size();
    written::Solid large = cup;
    for (Vec3& v : large.vertices) v = 65536.0f * v;
    EXPECT_EQ(simplify(large.vertices, large.triangles, 65.536f).triangles.size(), one);
    EXPECT_LE(simplify(cup.vertices, cup.triangles, 0).error, 1e-7f);
}

TEST(Simplification, RefusesBadInputInOneLine) {
    const written::Solid solid = written::byName("L");
    for (const float error : {-1.0f, std::nanf(""), 1e9f})
        EXPECT_THROW(simplify(solid.vertices, solid.triangles, error), std::invalid_argument);
    EXPECT_THROW(simplify({}, {}, 0.1f), std::invalid_argument);
    const std::vector<Triangle> wild{{0, 1, 1000000}};
    EXPECT_THROW(simplify(solid.vertices, wild, 0.1f), std::invalid_argument);
}

}  // namespace
}  // namespace ragtop
