#include "narrowphase/box_on_triangles.h"

#include "collide_support.h"
#include "narrowphase/clip.h"

namespace ragtop {
namespace {

struct Placed {
    TurnedBox box;
    TriangleView view;
    Vec3 edge(int k) const {
        const Vec3 v[3] = {view.a, view.b, view.c};
        return v[k == 2 ? 0 : k + 1] - v[k];
    }
};

Placed randomPlaced(Random& random) {
    const Vec3 half{random.uniform(0.2f, 1), random.uniform(0.2f, 1), random.uniform(0.2f, 1)};
    Placed placed{TurnedBox(half, random.rotation()), {}};
    for (;;) {
        TriangleView& view = placed.view;
        const Vec3 middle = random.inBox(1.2f);
        view.a = middle + random.inBox(1.5f), view.b = middle + random.inBox(1.5f), view.c = middle + random.inBox(1.5f);
        const Vec3 across = cross(view.b - view.a, view.c - view.a);
        if (lengthSquared(across) < 0.01f) continue;
        view.normal = normalized(across);
        return placed;
    }
}

/// From the triangle to the box, by all corners.
float separationAlong(const Placed& placed, const Vec3& direction) {
    float highest = -1e9f, lowest = 1e9f;
    for (const Vec3& corner : {placed.view.a, placed.view.b, placed.view.c})
        highest = std::max(highest, dot(direction, corner));
    for (int i = 0; i < 8; ++i) lowest = std::min(lowest, dot(direction, placed.box.corner(i)));
    return lowest - highest;
}

/// The greatest separations along the normal of the triangle, the faces of the box, and edge pairs that lead out of the
/// triangle.
struct Separations {
    float own, faces = -1e9f, edges = -1e9f;

    explicit Separations(const Placed& placed) : own(separationAlong(placed, placed.view.normal)) {
        for (const Vec3& axis : placed.box.axes) {
            faces = std::max({faces, separationAlong(placed, axis), separationAlong(placed, -axis)});
            for (int k = 0; k < 3; ++k) {
                const Vec3 e = placed.edge(k);
                Vec3 direction = cross(e, axis);
                if (lengthSquared(direction) < 1e-3f * lengthSquared(e)) continue;
                if (dot(direction, cross(e, placed.view.normal)) < 0) direction = -direction;
                edges = std::max(edges, separationAlong(placed, normalized(direction)));
            }
        }
    }
    float most() const { return std::max({own, faces, edges}); }
};

constexpr float kRounding = 1e-5f;

TEST(BoxOnTriangles, NoAxisSeparatesByMoreThanTheOneFound) {
    Random random(7);
    constexpr float kMargin = 0.1f;
    int kinds[3] = {}, apart = 0;
    for (int round = 0; round < 20000; ++round) {
        const Placed placed = randomPlaced(random);
        const TriangleView* const four[4] = {&placed.view, &placed.view, &placed.view, &placed.view};
        const BoxAxes found = findBoxAxes(placed.box, FourTriangles(four, {}), kMargin, 1e9f);
        const Separations all(placed);
        if (found.touches == 0) {
            // By the distance of bounds too, which no single axis may show.
            const bool shown = all.most() > kMargin - kRounding;
            apart += shown;
            EXPECT_GT(all.most(), 0);
            continue;
        }
        ASSERT_EQ(found.touches, 15u);
        ASSERT_LE(all.most(), kMargin + kRounding);
        const float tolerance = kChoiceTolerance * placed.box.size;
        for (int lane = 0; lane < 4; ++lane) {
            ASSERT_EQ(found.axis[lane], found.axis[0]);
            ASSERT_LE(all.most(), found.separation[lane] + 2 * tolerance + kRounding);
            const BoxAxes::Kind kind = found.kind(lane);
            const float of[3] = {all.own, all.faces, all.edges};
            ASSERT_NEAR(found.separation[lane], of[kind], kRounding);
            ++kinds[kind];
        }
    }
    for (const int count : kinds) EXPECT_GT(count, 1000);
    EXPECT_GT(apart, 1000);
}

TEST(BoxOnTriangles, PointsAreAsFarApartAsTheyShow) {
    Random random(8);
    constexpr float kMargin = 0.2f;
    int points[3] = {};
    for (int round = 0; round < 20000; ++round) {
        const Placed placed = randomPlaced(random);
        const TriangleView* const four[4] = {&placed.view, &placed.view, &placed.view, &placed.view};
        const BoxAxes found = findBoxAxes(placed.box, FourTriangles(four, {}), kMargin, 1e9f);
        if (found.touches == 0) continue;
        const Vec3 corners[3] = {placed.view.a, placed.view.b, placed.view.c};
        const CornersAndNormal t{corners, placed.view.normal};
        const BoxAxes::Kind kind = found.kind(0);
        Vec3 normal = placed.view.normal;
        ManifoldPoint out[kMostBoxPoints];
        const int count = kind == BoxAxes::kTriangle ? boxFaceOnTriangle(placed.box, t, kMargin, out)
                          : kind == BoxAxes::kBoxFace
                              ? triangleOnBoxFace(placed.box, t, found.axis[0], kMargin, normal, out)
                              : edgesOfBoxAndTriangle(placed.box, t, found.axis[0], found.separation[0], kMargin, normal, out);
        ASSERT_LE(count, 7);
        const float overhang = 2 * kOverhang * placed.box.size;
        for (int i = 0; i < count; ++i) {
            const ManifoldPoint& point = out[i];
            ASSERT_LE(point.separation, kMargin);
            ASSERT_GE(point.separation, found.separation[0] - kRounding);
            for (int j = 0; j < i; ++j) ASSERT_NE(out[j].feature, point.feature);
            if (kind == BoxAxes::kEdges) continue;  // nearest to each other, which is not along the normal at their ends
            const Vec3 onBox = point.position + 0.5f * point.separation * normal;
            const Vec3 onTriangle = point.position - 0.5f * point.separation * normal;
            for (int axis = 0; axis < 3; ++axis)
                ASSERT_LE(std::fabs(dot(onBox, placed.box.axes[axis])), placed.box.half[axis] + overhang + 10 * kRounding);
            ASSERT_NEAR(dot(placed.view.normal, onTriangle - placed.view.a), 0, 10 * kRounding);
            for (int k = 0; k < 3; ++k) {
                const Vec3 outward = normalized(cross(placed.edge(k), placed.view.normal));
                ASSERT_LE(dot(outward, onTriangle - corners[k]), overhang + 10 * kRounding);
            }
        }
        points[kind] += count;
    }
    for (const int count : points) EXPECT_GT(count, 1000);
}

TEST(BoxOnTriangles, WhatIsBehindIsLeftOut) {
    const TurnedBox box({0.5f, 0.5f, 0.5f}, {});
    TriangleView view{.a = {-1, 0.2f, -1}, .b = {0, 0.2f, 1}, .c = {1, 0.2f, -1}, .normal = {0, 1, 0}};
    const TriangleView* const four[4] = {&view, &view, &view, &view};
    EXPECT_EQ(findBoxAxes(box, FourTriangles(four, {}), 0.01f, 0.125f).touches, 0u);
    EXPECT_EQ(findBoxAxes(box, FourTriangles(four, {0, 0.1f, 0}), 0.01f, 0.125f).touches, 15u);
}

}  // namespace
}  // namespace ragtop
