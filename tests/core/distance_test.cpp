#include "collide_support.h"
#include "shape_support.h"

namespace ragtop {
namespace {

TriangleView triangleView(const Vec3& a, const Vec3& b, const Vec3& c) {
    return {a, b, c, normalized(cross(b - a, c - a)), 7, 0};
}

/// The least distance to a segment, by the parameters where it can be: unlike GJK, no iteration.
double distanceToSegment(const DVec3& p, const DVec3& a, const DVec3& b) {
    const DVec3 d = b - a;
    const double dd = ExactHull::dotOf(d, d);
    const double t = dd > 0 ? std::clamp(ExactHull::dotOf(p - a, d) / dd, 0.0, 1.0) : 0.0;
    const DVec3 r = p - (a + t * d);
    return std::sqrt(ExactHull::dotOf(r, r));
}

TEST(Distance, OfSpheresAndCapsulesIsThatOfPointsAndSegments) {
    Random random(21);
    for (int i = 0; i < 2000; ++i) {
        const Frame frame{random.inBox(2), random.rotation()};
        const Distance spheres = distance(sphereView(0.3f), sphereView(0.2f), frame);
        EXPECT_NEAR(spheres.distance, length(frame.position) - 0.5f, 2e-6f);
        const Distance mixed = distance(capsuleView(0.3f, 0.7f), sphereView(0.2f), frame);
        const double core = distanceToSegment(DVec3(frame.position), {0, -0.7f, 0}, {0, 0.7f, 0});
        EXPECT_NEAR(mixed.distance, core - 0.5, 4e-6);
        if (core > 0.01) {
            EXPECT_NEAR(length(mixed.pointB - mixed.pointA), std::abs(mixed.distance), 4e-6f);
        }
    }
}

/// At the closest points of two convex sets apart, the planes across the normal support both: |pB − pA| is the distance
/// exactly when neither set reaches beyond its plane [Gilbert, Johnson, Keerthi, 1988, theorem 1].
TEST(Distance, OfPolyhedraIsProvenByItsSupportingPlanes) {
    RAGTOP_NEEDS_HULLS();
    Random random(22);
    int apart = 0;
    for (int i = 0; i < 4000; ++i) {
        SCOPED_TRACE(i);
        const ConvexHull a(randomPoints(random, 4 + i % 30, 1));
        const ConvexView viewA = hullView(a.data());
        const ConvexView viewB =
            boxView({random.uniform(0.05f, 1), random.uniform(0.05f, 1), random.uniform(0.05f, 1)});
        const Frame frame{random.vector(0.5f, 3), random.rotation()};
        const ExactHull exactA(viewA, {}), exactB(viewB, frame);
        const double bySat = separationOf(exactA, exactB);
        const Distance d = distance(viewA, viewB, frame);
        const double rounding = 2e-5;  // 100 roundings of sums of about three metres
        if (d.coresOverlap) {
            EXPECT_LE(bySat, rounding);
            continue;
        }
        ++apart;
        EXPECT_GE(d.distance, bySat - rounding);
        EXPECT_NEAR(length(d.normal), 1, 1e-5f);
        EXPECT_NEAR(length(d.pointB - d.pointA), d.distance, rounding);
        EXPECT_NEAR(separationAlong(exactA, exactB, DVec3(d.normal)), d.distance, rounding);
    }
    EXPECT_GT(apart, 1000);
}

TEST(Distance, OfATriangleIsTheSameFarFromTheOrigin) {
    Random random(23);
    const Vec3 far{4096, -2048, 1024};
    for (int i = 0; i < 1000; ++i) {
        // Multiples of 1/1024 are exact there.
        const auto snapped = [&] {
            const Vec3 v = random.inBox(1);
            return Vec3{std::round(v.x * 1024) / 1024, std::round(v.y * 1024) / 1024, std::round(v.z * 1024) / 1024};
        };
        const Vec3 a = snapped(), b = snapped(), c = snapped(), p = 2 * snapped();
        const Quat rotation = random.rotation();
        const ConvexView box = boxView({0.3f, 0.2f, 0.1f});
        const Distance near = distance(triangleView(a, b, c), box, {p, rotation});
        const Distance moved = distance(triangleView(a + far, b + far, c + far), box, {p + far, rotation});
        EXPECT_EQ(near.distance, moved.distance);
        EXPECT_EQ(near.normal, moved.normal);
    }
}

TEST(Distance, OfThingsInsideEachOtherIsNotPositive) {
    for (const ConvexView& a : {sphereView(1), capsuleView(0.5f, 1), boxView({1, 1, 1})}) {
        for (const ConvexView& b : {sphereView(1), capsuleView(0.5f, 1), boxView({1, 1, 1})}) {
            const Distance d = distance(a, b, {});
            EXPECT_LE(d.distance, 0);
            EXPECT_TRUE(d.coresOverlap);
            EXPECT_EQ(d.normal, (Vec3{0, 1, 0}));
            EXPECT_TRUE(isFinite(d.pointA) && isFinite(d.pointB));
        }
    }
}

TEST(Distance, ScalesWithLength) {
    Random random(24);
    for (int i = 0; i < 1000; ++i) {
        const Vec3 half{random.uniform(0.1f, 1), random.uniform(0.1f, 1), random.uniform(0.1f, 1)};
        const Frame frame{random.inBox(2), random.rotation()};
        const Distance small = distance(boxView(half), capsuleView(0.25f, 0.5f), frame);
        const Distance large = distance(boxView(4 * half), capsuleView(1, 2), {4 * frame.position, frame.rotation});
        EXPECT_EQ(4 * small.distance, large.distance);
        EXPECT_EQ(small.normal, large.normal);
        EXPECT_EQ(4 * small.pointA, large.pointA);
    }
}

TEST(Sweep, MeetsASphereWhereTheQuadraticSays) {
    // |(−3, 0.5, 0) + t (6, 0, 0)| = 1: t = (3 − √0.75) / 6.
    const SweepHit hit = sweep(sphereView(0.6f), sphereView(0.4f), {{-3, 0.5f, 0}, {}}, {6, 0, 0});
    ASSERT_TRUE(hit.hit);
    EXPECT_NEAR(hit.fraction, (3 - std::sqrt(0.75f)) / 6, 2e-5f);
    expectNear(hit.normal, {-std::sqrt(0.75f), 0.5f, 0}, 1e-4f);
    EXPECT_FALSE(sweep(sphereView(0.6f), sphereView(0.4f), {{-3, 1.01f, 0}, {}}, {6, 0, 0}).hit);
    EXPECT_FALSE(sweep(sphereView(0.6f), sphereView(0.4f), {{-3, 0.5f, 0}, {}}, {6, 0, 0}, 0.3f).hit);
    const SweepHit inside = sweep(sphereView(0.6f), sphereView(0.4f), {{0.5f, 0, 0}, {}}, {6, 0, 0});
    EXPECT_TRUE(inside.hit);
    EXPECT_EQ(inside.fraction, 0);
}

/// Separation along axes is linear in t, so the first touch of polyhedra is where the last axis stops separating.
TEST(Sweep, StopsWherePolyhedraFirstTouch) {
    Random random(25);
    int hits = 0;
    for (int i = 0; i < 1000; ++i) {
        SCOPED_TRACE(i);
        const Vec3 halfA{random.uniform(0.2f, 1), random.uniform(0.2f, 1), random.uniform(0.2f, 1)};
        const ConvexView a = boxView(halfA), b = boxView({0.3f, 0.5f, 0.2f});
        const Frame start{3 * random.direction(), random.rotation()};
        const Vec3 travel = -2 * start.position + random.inBox(2);
        const SweepHit hit = sweep(a, b, start, travel);
        const auto separationAt = [&](double t) {
            const Frame frame{start.position + static_cast<float>(t) * travel, start.rotation};
            return separationOf(ExactHull(a, {}), ExactHull(b, frame));
        };
        const double until = hit.hit ? hit.fraction : 1;
        const double rounding = 2e-5 * 3;
        for (int k = 0; k < 50; ++k) EXPECT_GE(separationAt(until * k / 50.0), -rounding);
        if (!hit.hit) continue;
        ++hits;
        EXPECT_NEAR(separationAt(hit.fraction), 0, rounding);
        EXPECT_LE(dot(hit.normal, travel), 0);
    }
    EXPECT_GT(hits, 100);
}

/// Unlike the closed form, the distance of a point to a triangle knows of no motion; on a line it is convex, so that
/// the first touch is where it falls to the radius.
TEST(Sweep, OfABallEndsWhereItsCentreComesAsNearAsItsRadius) {
    Random random(27);
    int hits = 0, starts = 0, faces = 0;
    for (int i = 0; i < 20000; ++i) {
        SCOPED_TRACE(i);
        const Vec3 corners[3] = {random.inBox(1), random.inBox(1), random.inBox(1)};
        if (lengthSquared(cross(corners[1] - corners[0], corners[2] - corners[0])) < 1e-4f) continue;
        const TriangleView triangle = triangleView(corners[0], corners[1], corners[2]);
        const float radius = random.uniform(0.01f, 0.6f);
        const Vec3 start = random.inBox(3);
        // Some along an edge, some past it.
        const Vec3 travel = i % 8 == 0 ? 2 * (corners[1] - corners[0]) : random.inBox(2) - 1.5f * start;
        const auto distanceAt = [&](float t) {
            return distance(triangle, sphereView(radius), {start + t * travel, {}}).distance;
        };
        const SweepHit hit = sweep(triangle, sphereView(radius), {start, {}}, travel);
        constexpr float kFewUlps = 2e-5f;  // some thirty units in the last place of 6 m
        if (distanceAt(0) < kFewUlps) {
            EXPECT_EQ(hit.fraction, 0);
            ++starts;
            continue;
        }
        const float until = hit.hit ? hit.fraction : 1;
        for (int k = 0; k < 40; ++k) ASSERT_GE(distanceAt(until * static_cast<float>(k) / 40), -kFewUlps);
        if (!hit.hit) continue;
        ++hits;
        const Vec3 apart = start + hit.fraction * travel - hit.point;
        // Where a ball grazes, a time is the root of a difference: its distance is what is known.
        EXPECT_NEAR(distanceAt(hit.fraction), 0, kFewUlps);
        EXPECT_NEAR(length(apart), radius, kFewUlps);
        EXPECT_NEAR(dot(apart, hit.normal), radius, kFewUlps);
        if (!hit.onFace) continue;
        ++faces;
        EXPECT_EQ(hit.normal, triangle.normal);
        EXPECT_NEAR(dot(hit.point - triangle.a, triangle.normal), 0, 1e-6f);
    }
    EXPECT_GT(hits, 4000);
    EXPECT_GT(starts, 100);
    EXPECT_GT(faces, 300);
}

TEST(TimeOfImpact, OfASpinningRodMatchesFineSampling) {
    Random random(26);
    const ConvexView rod = boxView({1, 0.02f, 0.02f}), post = boxView({0.1f, 0.1f, 2});
    int hits = 0;
    for (int i = 0; i < 300; ++i) {
        SCOPED_TRACE(i);
        const Frame start{Vec3{random.uniform(-2, 2), 1.2f + random.uniform(0, 1), random.uniform(-0.5f, 0.5f)},
                          random.rotation()};
        const Frame end{random.inBox(0.8f), random.rotation(3) * start.rotation};
        const SweepHit hit = timeOfImpact(post, rod, start, end, 0.01f);
        const Quat turn = normalized(end.rotation * conjugate(start.rotation));
        const Vec3 omega = rotationVector(turn);
        double first = 2;
        constexpr int kSamples = 2000;
        for (int k = 0; k <= kSamples && first > 1; ++k) {
            const float t = static_cast<float>(k) / kSamples;
            const Frame frame{start.position + t * (end.position - start.position),
                              normalized(rotationAbout(omega, t * length(omega)) * start.rotation)};
            if (distance(post, rod, frame).distance <= 0.01f) first = t;
        }
        if (first > 1) {
            // Never reached target: a hit may be reported only where it all but was, within the touch tolerance.
            if (!hit.hit) continue;
            const Frame frame{start.position + hit.fraction * (end.position - start.position),
                              normalized(rotationAbout(omega, hit.fraction * length(omega)) * start.rotation)};
            EXPECT_LE(distance(post, rod, frame).distance, 0.0125f);
            continue;
        }
        ++hits;
        ASSERT_TRUE(hit.hit);
        EXPECT_LE(hit.fraction, first + 1e-4) << "passed the first impact";
        // Not earlier than where the distance is within tolerance of the target.
        const Frame frame{start.position + hit.fraction * (end.position - start.position),
                          normalized(rotationAbout(omega, hit.fraction * length(omega)) * start.rotation)};
        EXPECT_LE(distance(post, rod, frame).distance, 0.0125f);
    }
    EXPECT_GT(hits, 30);
}

/// Exact for a sphere round the origin of a rod swung through a right angle: the tip sweeps a circle.
TEST(TimeOfImpact, OfASwungRodIsTheAngleToTheBall) {
    const ConvexView rod = capsuleView(0.1f, 1), ball = sphereView(0.2f);
    // Seen from the ball, the rod's centre stays at (−0.8, 0, 0) and it turns about z from vertical to horizontal; it
    // meets the ball when the ball's centre is 0.3 from the segment: sin φ = 0.3 / 0.8.
    const Frame start{{-0.8f, 0, 0}, {}}, end{{-0.8f, 0, 0}, rotationAbout({0, 0, 1}, -kPi / 2)};
    const SweepHit hit = timeOfImpact(ball, rod, start, end, 0);
    ASSERT_TRUE(hit.hit);
    const float expected = 1 - std::asin(0.375f) / (kPi / 2);
    EXPECT_LE(hit.fraction, expected + 1e-5f);
    // Touch is 1e-4 of the reach 1.1 m; the gap closes at 0.8 cos φ · π/2 per unit of t.
    EXPECT_NEAR(hit.fraction, expected, 1.1e-4f / (0.8f * 0.927f * kPi / 2) + 1e-5f);
}

void expectRayAgreesWithSampling(const ConvexView& shape, Random& random) {
    const ConvexView point = sphereView(0);
    for (int i = 0; i < 500; ++i) {
        SCOPED_TRACE(i);
        const Vec3 origin = random.inBox(2), travel = random.inBox(1) - 1.5f * origin;
        const SweepHit ray = castRay(shape, origin, travel);
        const SweepHit swept = sweep(shape, point, {origin, {}}, travel);
        const auto distanceAt = [&](float t) { return distance(shape, point, {origin + t * travel, {}}).distance; };
        for (int k = 0; k < 100; ++k) {
            const float t = (ray.hit ? ray.fraction : 1) * static_cast<float>(k) / 100;
            EXPECT_GE(distanceAt(t), ray.fraction == 0 ? -10.0f : -1e-5f);
        }
        if (!ray.hit) continue;
        if (ray.fraction == 0) {
            EXPECT_LE(distanceAt(0), 1e-5f);
            expectNear(ray.normal, normalized(-travel), 1e-6f);
            continue;
        }
        EXPECT_NEAR(distanceAt(ray.fraction), 0, 1e-5f);
        EXPECT_LT(dot(ray.normal, travel), 0);
        expectNear(ray.point, origin + ray.fraction * travel, 1e-6f);
        if (swept.hit) {
            EXPECT_NEAR(swept.fraction, ray.fraction, 1e-4f / std::abs(dot(ray.normal, travel)));
        }
    }
}

TEST(CastRay, HitsWhereTheDistanceVanishes) {
    Random random(27);
    expectRayAgreesWithSampling(sphereView(0.8f), random);
    expectRayAgreesWithSampling(capsuleView(0.4f, 0.7f), random);
    expectRayAgreesWithSampling(boxView({0.5f, 0.9f, 0.3f}), random);
    const HullData hull = boxHull({0.5f, 0.9f, 0.3f});
    expectRayAgreesWithSampling(hullView(hull), random);
    if (!hullsCanBeBuilt()) return;
    const ConvexHull round(randomPoints(random, 40, 0.9f));
    expectRayAgreesWithSampling(hullView(round.data()), random);
}

TEST(CastRay, HitsTheFrontOfATriangleOnly) {
    const TriangleView triangle = triangleView({0, 0, 0}, {0, 0, 1}, {1, 0, 0});  // front up
    const SweepHit hit = castRay(triangle, {0.25f, 2, 0.25f}, {0, -4, 0});
    ASSERT_TRUE(hit.hit);
    EXPECT_EQ(hit.fraction, 0.5f);
    expectNear(hit.normal, {0, 1, 0}, 1e-6f);
    EXPECT_FALSE(castRay(triangle, {0.25f, -2, 0.25f}, {0, 4, 0}).hit);
    EXPECT_FALSE(castRay(triangle, {0.75f, 2, 0.75f}, {0, -4, 0}).hit);
    EXPECT_FALSE(castRay(triangle, {0.25f, 2, 0.25f}, {0, -4, 0}, 0.4f).hit);
}

TEST(CastRay, NeverPassesBetweenNeighbours) {
    Random random(28);
    for (int i = 0; i < 5000; ++i) {
        const Vec3 a = random.inBox(1), c = random.inBox(1) + Vec3{0, 0, 3}, b = {3, random.uniform(-1, 1), 1},
                   d = {-3, random.uniform(-1, 1), 1};
        // Rays at points of the common edge a–c.
        const Vec3 target = a + random.uniform(0.05f, 0.95f) * (c - a);
        const Vec3 origin = target + Vec3{0, 5, 0} + random.inBox(0.5f);
        const Vec3 travel = 2 * (target - origin);
        const bool either =
            castRay(triangleView(a, c, b), origin, travel).hit || castRay(triangleView(c, a, d), origin, travel).hit;
        EXPECT_TRUE(either) << i;
    }
}

TEST(CastRay, OfNoLengthHitsOnlyWhatItIsIn) {
    for (const ConvexView& shape : {sphereView(1), capsuleView(0.5f, 0.5f), boxView({1, 1, 1})}) {
        EXPECT_TRUE(castRay(shape, {0, 0.5f, 0}, {}).hit);
        EXPECT_FALSE(castRay(shape, {0, 3, 0}, {}).hit);
        EXPECT_FALSE(castRay(shape, {3, 0, 0}, {}).hit);
    }
}

}  // namespace
}  // namespace ragtop
