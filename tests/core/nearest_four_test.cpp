#include "narrowphase/nearest_four.h"

#include "collide_support.h"

namespace ragtop {
namespace {

TriangleView randomTriangle(Random& random) {
    for (;;) {
        TriangleView view;
        view.a = random.inBox(1), view.b = random.inBox(1), view.c = random.inBox(1);
        const Vec3 across = cross(view.b - view.a, view.c - view.a);
        if (lengthSquared(across) < 1e-6f) continue;
        view.normal = normalized(across);
        return view;
    }
}

TEST(NearestFour, IsWhatEachTriangleGivesAlone) {
    Random random(5);
    int kinds[3] = {};
    for (int round = 0; round < 25000; ++round) {
        const TriangleView views[4] = {randomTriangle(random), randomTriangle(random), randomTriangle(random),
                                       randomTriangle(random)};
        const TriangleView* const four[4] = {&views[0], &views[1], &views[2], &views[3]};
        const Vec3 from = random.inBox(round % 2 == 0 ? 1.0f : 3.0f);
        const NearestFour nearest = nearestOnFour(four, from);
        for (int k = 0; k < 4; ++k) {
            const Vec3 corners[3] = {views[k].a - from, views[k].b - from, views[k].c - from};
            Feature feature;
            const Vec3 alone = nearestOnTriangle(corners, views[k].normal, {}, feature);
            ASSERT_EQ(nearest.pointAt(k), alone);
            ASSERT_EQ(nearest.square[k], lengthSquared(alone));
            ASSERT_EQ(nearest.height[k], -dot(views[k].normal, corners[0]));
            ASSERT_EQ(nearest.featureAt(k).kind, feature.kind);
            ASSERT_EQ(nearest.featureAt(k).index, feature.index);
            ASSERT_EQ(nearest.inside[k] != 0, feature.kind == Feature::face);
            ++kinds[feature.kind];
        }
    }
    for (const int count : kinds) EXPECT_GT(count, 1000);
}

}  // namespace
}  // namespace ragtop
