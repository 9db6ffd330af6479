#include "collide_support.h"
#include "shape_support.h"

namespace ragtop {
namespace {

constexpr float kMetreRounding = 1e-6f;  // of lengths near one metre

Frame at(const Vec3& position) { return {position, {}}; }

std::vector<ConvexView> oneOfEach(const HullData& hull) {
    return {sphereView(0.5f), capsuleView(0.3f, 0.6f), boxView({0.5f, 0.4f, 0.7f}), hullView(hull)};
}

void expectSanePoints(const Manifold& m, float margin) {
    ASSERT_GE(m.pointCount, 0);
    ASSERT_LE(m.pointCount, kMaxManifoldPoints);
    if (m.pointCount > 0) {
        EXPECT_NEAR(length(m.normal), 1, 1e-5f);
    }
    for (int i = 0; i < m.pointCount; ++i) {
        EXPECT_TRUE(isFinite(m.points[i].position));
        EXPECT_LE(m.points[i].separation, margin);
        for (int k = 0; k < i; ++k) EXPECT_NE(m.points[i].feature, m.points[k].feature);
    }
}

TEST(SpherePair, TouchesHalfWayAlongTheCentres) {
    const Manifold m = collided(sphereView(1), sphereView(0.5f), at({0, 1.4f, 0}));
    ASSERT_EQ(m.pointCount, 1);
    expectNear(m.normal, {0, 1, 0}, kMetreRounding);
    EXPECT_NEAR(m.points[0].separation, -0.1f, kMetreRounding);
    expectNear(m.points[0].position, {0, 0.95f, 0}, kMetreRounding);
    EXPECT_EQ(collided(sphereView(1), sphereView(0.5f), at({0, 1.6f, 0}), 0.09f).pointCount, 0);
    EXPECT_EQ(collided(sphereView(1), sphereView(0.5f), at({0, 1.6f, 0}), 0.11f).pointCount, 1);
}

/// The edge of one box lies nearly in a face of another and crosses it from side to side. Heights of its ends over the
/// face differ by the width of the face times the tilt; both are told while that is less than the margin, wherever the
/// separating axis lies.
TEST(BoxPair, AnEdgeAcrossAFaceTouchesAtBothOfItsEnds) {
    std::mt19937 random(1);
    const auto between = [&](float a, float b) { return std::uniform_real_distribution<float>(a, b)(random); };
    for (int i = 0; i < 500; ++i) {
        const Vec3 half{between(0.1f, 0.5f), between(0.05f, 0.2f), between(0.1f, 0.3f)};
        const float length = between(1, 3), lean = between(-0.5f, 0.5f), roll = between(-0.05f, 0.05f);
        // A bar along z stands on its edge below the box, and the box leans and rolls over it.
        const float depth = between(0, 0.01f);
        const Quat turned = rotationAbout({0, 0, 1}, lean) * rotationAbout({1, 0, 0}, roll);
        const Frame box{{0, std::sqrt(2.0f) * 0.2f + half.y / std::cos(lean) - depth, 0}, turned};
        const ConvexView bar = boxView({0.2f, 0.2f, length});
        const Frame edgeUp{{}, rotationAbout({0, 0, 1}, 0.25f * kPi)};
        const Frame boxInBar{inverseRotate(edgeUp.rotation, box.position), conjugate(edgeUp.rotation) * turned};
        const Manifold m = collided(bar, boxView(half), boxInBar, 0.1f);
        ASSERT_GE(m.pointCount, 2) << i;
        float least = 1e9f, most = -1e9f;
        for (const ManifoldPoint& point : m.all()) {
            least = std::min(least, point.position.z);
            most = std::max(most, point.position.z);
        }
        EXPECT_GT(most - least, 1.8f * half.z) << i;
    }
}

TEST(SphereAndCapsule, TouchOnTheTubeAndOnTheCap) {
    const Manifold tube = collided(capsuleView(0.25f, 1), sphereView(0.5f), at({0.7f, 0.5f, 0}));
    ASSERT_EQ(tube.pointCount, 1);
    expectNear(tube.normal, {1, 0, 0}, kMetreRounding);
    EXPECT_NEAR(tube.points[0].separation, -0.05f, kMetreRounding);
    expectNear(tube.points[0].position, {0.225f, 0.5f, 0}, kMetreRounding);
    const Manifold cap = collided(sphereView(0.5f), capsuleView(0.25f, 1), at({0, -1.7f, 0}));
    ASSERT_EQ(cap.pointCount, 1);
    expectNear(cap.normal, {0, -1, 0}, kMetreRounding);
    EXPECT_NEAR(cap.points[0].separation, -0.05f, kMetreRounding);
    expectNear(cap.points[0].position, {0, -0.475f, 0}, kMetreRounding);
}

TEST(CapsulePair, ParallelTouchesAtTheEndsOfTheCommonLength) {
    const Manifold m = collided(capsuleView(0.5f, 1), capsuleView(0.25f, 1), at({0.7f, 0.5f, 0}));
    ASSERT_EQ(m.pointCount, 2);
    expectNear(m.normal, {1, 0, 0}, kMetreRounding);
    for (const ManifoldPoint& point : {m.points[0], m.points[1]}) {
        EXPECT_NEAR(point.separation, -0.05f, kMetreRounding);
        EXPECT_NEAR(point.position.x, 0.475f, kMetreRounding);
    }
    EXPECT_NEAR(std::min(m.points[0].position.y, m.points[1].position.y), -0.5f, kMetreRounding);
    EXPECT_NEAR(std::max(m.points[0].position.y, m.points[1].position.y), 1.0f, kMetreRounding);
}

TEST(CapsulePair, CrossedTouchesAtOnePoint) {
    for (const float angle : {0.05f, 0.5f, 1.5f}) {
        const Manifold m =
            collided(capsuleView(0.5f, 2), capsuleView(0.25f, 2), {{0.7f, 0.25f, 0}, rotationAbout({1, 0, 0}, angle)});
        ASSERT_EQ(m.pointCount, 1) << angle;
        expectNear(m.normal, {1, 0, 0}, 2e-5f);
        EXPECT_NEAR(m.points[0].separation, -0.05f, 4 * kMetreRounding);
    }
}

TEST(SphereAndBox, TouchFaceEdgeCornerAndInside) {
    const ConvexView box = boxView({1, 2, 3}), sphere = sphereView(0.5f);
    const Manifold face = collided(box, sphere, at({0.2f, 2.4f, 1}));
    ASSERT_EQ(face.pointCount, 1);
    expectNear(face.normal, {0, 1, 0}, kMetreRounding);
    EXPECT_NEAR(face.points[0].separation, -0.1f, kMetreRounding);
    const Manifold edge = collided(box, sphere, at({1.3f, 2.3f, 1}));
    ASSERT_EQ(edge.pointCount, 1);
    expectNear(edge.normal, {std::sqrt(0.5f), std::sqrt(0.5f), 0}, kMetreRounding);
    EXPECT_NEAR(edge.points[0].separation, std::sqrt(0.18f) - 0.5f, kMetreRounding);
    const Manifold corner = collided(sphere, box, at({-1.2f, -2.2f, -3.2f}));
    ASSERT_EQ(corner.pointCount, 1);
    EXPECT_NEAR(corner.normal.x, -std::sqrt(1.0f / 3), 2 * kMetreRounding);
    EXPECT_NEAR(corner.points[0].separation, std::sqrt(0.12f) - 0.5f, 2 * kMetreRounding);
    const Manifold inside = collided(box, sphere, at({-0.9f, 0, 0}));
    ASSERT_EQ(inside.pointCount, 1);
    expectNear(inside.normal, {-1, 0, 0}, kMetreRounding);
    EXPECT_NEAR(inside.points[0].separation, -0.6f, kMetreRounding);
}

TEST(SphereAndHull, AgreesWithTheBoxThatTheHullIs) {
    const Vec3 half{0.5f, 0.8f, 0.6f};
    const HullData hull = boxHull(half);
    Random random(11);
    for (int i = 0; i < 2000; ++i) {
        SCOPED_TRACE(i);
        const Frame frame{random.inBox(1.2f), random.rotation()};
        const Manifold box = collided(boxView(half), sphereView(0.4f), frame, 0.1f);
        const Manifold same = collided(hullView(hull), sphereView(0.4f), frame, 0.1f);
        ASSERT_EQ(box.pointCount, same.pointCount);
        if (box.pointCount == 0) continue;
        EXPECT_NEAR(box.points[0].separation, same.points[0].separation, 5e-6f);
        const float apart = box.points[0].separation + 0.4f;  // the direction is known to rounding over this length
        if (apart > 0.01f) expectNear(box.normal, same.normal, 5e-6f / apart);
    }
}

TEST(CapsuleOnBox, LyingTouchesAtBothEndsOfTheLineCutToTheFace) {
    const Quat lying = rotationAbout({0, 0, 1}, kPi / 2);
    const Manifold m = collided(boxView({1, 0.5f, 1}), capsuleView(0.25f, 0.75f), {{0.5f, 0.7f, 0}, lying});
    ASSERT_EQ(m.pointCount, 2);
    expectNear(m.normal, {0, 1, 0}, kMetreRounding);
    const float low = std::min(m.points[0].position.x, m.points[1].position.x);
    const float high = std::max(m.points[0].position.x, m.points[1].position.x);
    EXPECT_NEAR(low, -0.25f, 2 * kMetreRounding);
    EXPECT_NEAR(high, 1, 2 * kMetreRounding);
    for (int i = 0; i < 2; ++i) EXPECT_NEAR(m.points[i].separation, -0.05f, 2 * kMetreRounding);
}

TEST(CapsuleOnBox, WithAnEndOverAFaceIsAsFarAsTheEndIsAboveIt) {
    Random random(21);
    const Vec3 half{0.5f, 0.4f, 0.7f};
    const float radius = 0.1f, halfHeight = 0.3f;
    int over = 0;
    for (int i = 0; i < 2000; ++i) {
        SCOPED_TRACE(i);
        const Quat rotation = random.rotation();
        const Vec3 reach = rotate(rotation, {0, halfHeight, 0}), lower = reach.y < 0 ? reach : -reach;
        const float gap = random.uniform(-0.9f * radius, 0.05f);
        // Its lower end over the top, anywhere but next to the rim; flat ones touch along a line.
        const Vec3 end{random.uniform(-0.45f, 0.45f), half.y + radius + gap, random.uniform(-0.65f, 0.65f)};
        if (-lower.y < 0.15f * halfHeight) continue;
        const ConvexView a = boxView(half), b = capsuleView(radius, halfHeight);
        const Frame frame{end - lower, rotation};
        const Manifold m = collided(a, b, frame, 0.06f);
        ASSERT_EQ(m.pointCount, 1);
        EXPECT_EQ(m.normal, (Vec3{0, 1, 0}));
        EXPECT_NEAR(m.points[0].separation, gap, 2e-6f);
        if (gap > 0) {
            EXPECT_NEAR(distance(a, b, frame).distance, gap, 1e-5f);
        }
        expectNear(m.points[0].position, {end.x, half.y + 0.5f * gap, end.z}, 2e-6f);
        ++over;
    }
    EXPECT_GT(over, 1000);
}

TEST(CapsuleOnBox, AlongAnEdgeTouchesAtTwoPoints) {
    const Quat along = rotationAbout({1, 0, 0}, kPi / 2);
    const Vec3 diagonal{std::sqrt(0.5f), std::sqrt(0.5f), 0};
    const Manifold m = collided(boxView({1, 1, 1}), capsuleView(0.25f, 0.5f), {Vec3{1, 1, 0} + 0.2f * diagonal, along});
    ASSERT_EQ(m.pointCount, 2);
    expectNear(m.normal, diagonal, 1e-5f);
    for (int i = 0; i < 2; ++i) EXPECT_NEAR(m.points[i].separation, -0.05f, 1e-5f);
}

TEST(CapsuleInBox, LeavesTheShortestWay) {
    Random random(12);
    const Vec3 half{0.5f, 0.8f, 0.6f};
    for (int i = 0; i < 2000; ++i) {
        SCOPED_TRACE(i);
        const ConvexView a = boxView(half), b = capsuleView(0.2f, 0.5f);
        const Frame frame{random.inBox(0.9f), random.rotation()};
        const Manifold m = collided(a, b, frame);
        // The segment as a hull of no thickness: a needle.
        const Vec3 end = rotate(frame.rotation, {0, 0.5f, 0});
        ExactHull needle(boxView({1e-6f, 0.5f, 1e-6f}), frame);
        const double core = separationOf(ExactHull(a, {}), needle);
        if (core > 0.21) {
            EXPECT_EQ(m.pointCount, 0);
        }
        if (core >= -0.001) continue;
        ASSERT_GT(m.pointCount, 0);
        // Hysteresis 0.01 of the smallest thickness in favour of faces, on both sides.
        const Vec3 p = frame.position - end, q = frame.position + end;
        const float along = std::min(dot(p, m.normal), dot(q, m.normal)) - dot(abs(m.normal), half);
        EXPECT_NEAR(along, core, 0.0021);
        EXPECT_GE(deepest(m), along - 0.2f - 1e-5f);
        EXPECT_LE(deepest(m), along - 0.2f + 0.004f);
    }
}

TEST(BoxOnBox, FaceOnFaceTouchesAtTheFourCorners) {
    const Manifold m = collided(boxView({1, 0.5f, 1}), boxView({0.5f, 0.25f, 0.25f}), at({0.75f, 0.74f, 0}));
    ASSERT_EQ(m.pointCount, 4);
    expectNear(m.normal, {0, 1, 0}, 0);
    for (int i = 0; i < 4; ++i) {
        EXPECT_NEAR(m.points[i].separation, -0.01f, kMetreRounding);
        const Vec3 p = m.points[i].position;
        EXPECT_TRUE(std::abs(p.x - 0.25f) < kMetreRounding || std::abs(p.x - 1) < kMetreRounding) << p.x;
        EXPECT_NEAR(std::abs(p.z), 0.25f, kMetreRounding);
        EXPECT_NEAR(p.y, 0.495f, kMetreRounding);
    }
}

TEST(BoxOnBox, CrossedEdgesTouchAtOnePoint) {
    const float h = std::sqrt(0.5f);
    const Frame frame{{0, 2 * h - 0.02f, 0}, rotationAbout({0, 1, 0}, kPi / 2) * rotationAbout({0, 0, 1}, kPi / 4)};
    Frame tilted = frame;  // A's edge along z points up once A is turned about z, so B is seen from that frame
    const Quat turn = rotationAbout({0, 0, 1}, -kPi / 4);
    tilted.position = rotate(turn, frame.position);
    tilted.rotation = turn * frame.rotation;
    const Manifold m = collided(boxView({0.5f, 0.5f, 0.5f}), boxView({0.5f, 0.5f, 0.5f}), tilted);
    ASSERT_EQ(m.pointCount, 1);
    expectNear(m.normal, rotate(turn, {0, 1, 0}), 1e-5f);
    EXPECT_NEAR(m.points[0].separation, -0.02f, 1e-5f);
    expectNear(m.points[0].position, rotate(turn, {0, h - 0.01f, 0}), 1e-5f);
}

TEST(Collide, OtherOrderMirrorsTheContact) {
    RAGTOP_NEEDS_HULLS();
    Random random(13);
    const ConvexHull hull(randomPoints(random, 20, 0.8f));
    const std::vector<ConvexView> shapes = oneOfEach(hull.data());
    for (int i = 0; i < 4000; ++i) {
        SCOPED_TRACE(i);
        const ConvexView &a = shapes[static_cast<std::size_t>(i % 4)], &b = shapes[static_cast<std::size_t>(i / 4 % 4)];
        const Frame frame{random.vector(0.6f, 1.4f), random.rotation()};
        const Manifold ab = collided(a, b, frame), ba = collided(b, a, inverse(frame));
        expectSanePoints(ab, 0);
        // Pairs that barely touch may fall on either side of zero.
        if (ab.pointCount == 0 || ba.pointCount == 0) {
            EXPECT_GE((ab.pointCount > 0 ? deepest(ab) : 0) + (ba.pointCount > 0 ? deepest(ba) : 0), -2e-5f);
            continue;
        }
        const Vec3 mirrored = rotate(frame.rotation, -ba.normal);
        // Two axes may be equally good up to the hysteresis (0.01 of 0.4 m) and rounding.
        EXPECT_NEAR(deepest(ab), deepest(ba), 0.005f);
        if (std::abs(deepest(ab) - deepest(ba)) < 1e-5f && deepest(ab) < -0.01f) expectNear(ab.normal, mirrored, 2e-3f);
    }
}

TEST(Collide, CoincidentShapesPartInSomeDirection) {
    const HullData hull = boxHull({0.5f, 0.3f, 0.4f});
    const std::vector<ConvexView> shapes = oneOfEach(hull);
    for (const ConvexView& a : shapes) {
        for (const ConvexView& b : shapes) {
            for (const Quat& rotation : {Quat{}, rotationAbout({0, 0, 1}, kPi / 2), rotationAbout({1, 1, 0}, 0.3f)}) {
                const Manifold m = collided(a, b, {{}, rotation});
                ASSERT_GT(m.pointCount, 0);
                expectSanePoints(m, 0);
                EXPECT_LT(deepest(m), -0.29f);
            }
        }
    }
}

TEST(Collide, FeaturesPersistUnderASmallMotion) {
    const ConvexView brick = boxView({0.5f, 0.25f, 0.25f});
    const HullData data = boxHull(brick.halfExtents);
    for (const ConvexView& view : {brick, hullView(data)}) {
        for (const float x : {0.0f, 0.5f}) {  // flush and half overlapping
            SeparationCache cache;
            Manifold first, next;
            collide(view, view, at({x, 0.4999f, 0}), 0.01f, cache, first);
            ASSERT_EQ(first.pointCount, 4);
            Random random(14);
            for (int i = 0; i < 500; ++i) {
                const Frame frame{Vec3{x, 0.4999f, 0} + random.inBox(1e-4f), random.rotation(2e-4f)};
                collide(view, view, frame, 0.01f, cache, next);
                ASSERT_EQ(next.pointCount, 4);
                expectNear(next.normal, {0, 1, 0}, 4e-4f);
                for (int k = 0; k < 4; ++k) {
                    bool found = false;
                    for (int j = 0; j < 4; ++j) {
                        found = found || (first.points[j].feature == next.points[k].feature &&
                                          length(first.points[j].position - next.points[k].position) < 1e-3f);
                    }
                    EXPECT_TRUE(found);
                }
            }
        }
    }
}

TEST(Collide, LengthsTimesFourGiveResultsTimesFour) {
    RAGTOP_NEEDS_HULLS();
    Random random(15);
    const std::vector<Vec3> points = randomPoints(random, 24, 0.8f);
    std::vector<Vec3> large;
    for (const Vec3& p : points) large.push_back(4 * p);
    const ConvexHull hullA(points), hullB(large);
    ASSERT_EQ(hullA.data().vertices.size(), hullB.data().vertices.size());
    const std::vector<ConvexView> small = oneOfEach(hullA.data());
    std::vector<ConvexView> big = oneOfEach(hullB.data());
    for (ConvexView& view : big) {
        view.radius *= 4;
        view.halfExtents *= 4;
    }
    for (int i = 0; i < 4000; ++i) {
        const auto a = static_cast<std::size_t>(i % 4), b = static_cast<std::size_t>(i / 4 % 4);
        const Frame frame{random.vector(0.2f, 1.6f), random.rotation()};
        const Manifold m = collided(small[a], small[b], frame, 0.05f);
        const Manifold n = collided(big[a], big[b], {4 * frame.position, frame.rotation}, 0.2f);
        ASSERT_EQ(m.pointCount, n.pointCount) << i;
        if (m.pointCount == 0) continue;
        EXPECT_EQ(m.normal, n.normal) << i;
        for (int k = 0; k < m.pointCount; ++k) {
            EXPECT_EQ(4 * m.points[k].position, n.points[k].position) << i;
            EXPECT_EQ(4 * m.points[k].separation, n.points[k].separation);
            EXPECT_EQ(m.points[k].feature, n.points[k].feature);
        }
    }
}

TEST(Collide, WhatIsRememberedDoesNotChangeTheVerdict) {
    RAGTOP_NEEDS_HULLS();
    Random random(16);
    const ConvexHull hull(randomPoints(random, 40, 0.8f));
    const std::vector<ConvexView> shapes = oneOfEach(hull.data());
    for (int pair = 0; pair < 16; ++pair) {
        const ConvexView &a = shapes[static_cast<std::size_t>(pair % 4)],
                         &b = shapes[static_cast<std::size_t>(pair / 4)];
        SeparationCache cache;
        Frame frame{{1.5f, 0, 0}, {}};
        for (int i = 0; i < 1000; ++i) {
            frame.position += random.inBox(0.03f) - 0.01f * frame.position;
            frame.rotation = normalized(rotationAbout(random.direction(), 0.02f) * frame.rotation);
            Manifold remembered;
            collide(a, b, frame, 0.02f, cache, remembered);
            const Manifold fresh = collided(a, b, frame, 0.02f);
            EXPECT_EQ(remembered.pointCount > 0, fresh.pointCount > 0);
            // In deep overlap the corner of the axis may be cut off the face, by more the deeper it is.
            if (fresh.pointCount == 0 || remembered.pointCount == 0 || deepest(fresh) < -0.5f) continue;
            // 2 × hysteresis of 0.01 × 0.4 m.
            EXPECT_NEAR(deepest(remembered), deepest(fresh), 0.009f);
        }
    }
}

/// Hulls in each other slide and turn slowly, so that faces are kept from before whose deepest corner is beside them.
TEST(HullPair, ShowsItsDepthWhateverFaceWasBefore) {
    Random random(7);
    constexpr float kDeep = 0.03f;  // m
    int overlaps = 0;
    for (int pair = 0; pair < 80; ++pair) {
        const ConvexHull a(randomPoints(random, 8 + pair % 24, 1)), b(randomPoints(random, 8 + pair % 24, 1));
        const ConvexView viewA = hullView(a.data()), viewB = hullView(b.data());
        const float size = std::min(a.data().innerRadius, b.data().innerRadius);
        const Vec3 way = random.direction(), axis = random.direction(), slide = random.vector(0.002f, 0.004f);
        const Quat turned = random.rotation();
        const float turn = random.uniform(-0.01f, 0.01f);
        float apart = 4;
        for (float step = 2; step > 1e-3f; step /= 2)
            if (separationOf(ExactHull(viewA, {}), ExactHull(viewB, {(apart - step) * way, turned})) > -kDeep)
                apart -= step;
        SeparationCache cache;
        for (int i = 0; i < 40; ++i) {
            const auto n = static_cast<float>(i);
            const Frame placed{apart * way + n * slide, rotationAbout(axis, turn * n) * turned};
            Manifold out;
            collide(viewA, viewB, placed, 0.02f, cache, out);
            const Manifold fresh = collided(viewA, viewB, placed, 0.02f);
            if (fresh.pointCount == 0 || deepest(fresh) > 0) continue;
            ++overlaps;
            ASSERT_GT(out.pointCount, 0);
            // Hysteresis of 0.01 of the size in favour of what was before; points that are nearly as deep.
            EXPECT_LE(deepest(out), deepest(fresh) + 0.012f * size) << pair << " at " << i;
        }
    }
    EXPECT_GT(overlaps, 1000);
}

}  // namespace
}  // namespace ragtop
