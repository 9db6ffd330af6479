#include "collide_support.h"
#include "shape_support.h"

/// Random polyhedra against brute force in double precision and against libccd.
namespace ragtop {
namespace {

/// Hysteresis prefers a face to an edge that is better by this part of the size; the rest is rounding of sums of a few
/// lengths in single precision.
constexpr double kChoice = 0.011;
/// And by this part of the overlap along the face: an edge is one point, which holds the less the deeper it is.
constexpr double kFavour = 0.1;

struct ConvexPair {
    ConvexView a, b;
    Frame bInA;
    double size;    ///< smallest half thickness
    double extent;  ///< largest radius
};

void compareWithBruteForce(const ConvexPair& pair) {
    const ExactHull a(pair.a, {}), b(pair.b, pair.bInA);
    const double exact = separationOf(a, b), rounding = 3e-6 * pair.extent;
    const Manifold m = collided(pair.a, pair.b, pair.bInA);
    if (exact > rounding) {
        EXPECT_EQ(m.pointCount, 0) << "apart by " << exact;
        return;
    }
    if (exact > -rounding) return;
    ASSERT_GT(m.pointCount, 0) << "overlap " << exact;
    ASSERT_LE(m.pointCount, kMaxManifoldPoints);
    EXPECT_NEAR(length(m.normal), 1, 1e-5);
    const double along = separationAlong(a, b, DVec3(m.normal));
    EXPECT_LE(along, exact + rounding);
    EXPECT_GE(along, (exact - kChoice * pair.size) / (1 - kFavour) - rounding) << "not the shortest way out";
    EXPECT_GE(deepest(m), along - rounding);
    // The corner that overhangs may be cut off the face by which the axis was chosen.
    EXPECT_LE(deepest(m), along + 2 * kChoice * pair.size + 0.25 * -along) << "deepest point lost";
}

#ifdef RAGTOP_WITH_CCD
/// Same verdict; no deeper than libccd's portal refinement, which never reports less than the true depth; as deep as
/// its expanding polytope, which ends early on one pair in twenty (then brute force sides with us) and is counted.
bool compareWithCcd(const ConvexPair& pair) {
    const CcdShape a{pair.a, {}}, b{pair.b, pair.bInA};
    const ccd_t ccd = ccdSettings();
    const Manifold m = collided(pair.a, pair.b, pair.bInA);
    const double rounding = 1e-4 * pair.extent;
    const bool touching = ccdGJKIntersect(&a, &b, &ccd) != 0;
    const ExactHull exactA(pair.a, {}), exactB(pair.b, pair.bInA);
    const double exact = separationOf(exactA, exactB);
    if (touching != (m.pointCount > 0)) {
        // Either one is right up to rounding, or ours is the verdict of brute force.
        EXPECT_TRUE(std::abs(exact) <= rounding || (exact < 0) == (m.pointCount > 0))
            << "brute force " << exact << ", points " << m.pointCount;
        return std::abs(exact) <= rounding;
    }
    if (!touching) return true;
    double ccdDepth = 0;
    ccd_vec3_t direction, position;
    if (ccdGJKPenetration(&a, &b, &ccd, &ccdDepth, &direction, &position) != 0) return false;
    const DVec3 d(direction.v[0], direction.v[1], direction.v[2]);
    if (!(std::abs(ExactHull::dotOf(d, d) - 1) < 1e-3)) return false;
    const double ours = -separationAlong(exactA, exactB, DVec3(m.normal));
    double mpr = 0;
    if (ccdMPRPenetration(&a, &b, &ccd, &mpr, &direction, &position) == 0) {
        EXPECT_LE(ours, (mpr + kChoice * pair.size) / (1 - kFavour) + rounding);
    }
    const double slack = kChoice * pair.size;
    return ours >= ccdDepth - slack - rounding && ours <= (ccdDepth + slack) / (1 - kFavour) + rounding;
}
#endif

ConvexPair randomBoxes(Random& random) {
    const auto half = [&] { return Vec3{random.uniform(0.2f, 1), random.uniform(0.2f, 1), random.uniform(0.2f, 1)}; };
    const Vec3 a = half(), b = half();
    const float least = std::min({a.x, a.y, a.z, b.x, b.y, b.z});
    const Frame frame{random.vector(0, 1.6f), random.rotation()};
    return {boxView(a), boxView(b), frame, least, length(a) + length(b) + length(frame.position)};
}

TEST(BoxPair, AgreesWithBruteForce) {
    Random random(1);
    for (int i = 0; i < 4000; ++i) {
        SCOPED_TRACE(i);
        compareWithBruteForce(randomBoxes(random));
    }
}

TEST(BoxPair, AgreesWithBruteForceWhenNearlyAligned) {
    Random random(2);
    for (int i = 0; i < 4000; ++i) {
        SCOPED_TRACE(i);
        ConvexPair pair = randomBoxes(random);
        const float angle = random.uniform(0, 1) * (i % 2 == 0 ? 1e-4f : 2e-2f);
        pair.bInA.rotation = rotationAbout(random.direction(), angle);
        const Vec3 sum = pair.a.halfExtents + pair.b.halfExtents;
        pair.bInA.position = {random.uniform(-1, 1) * sum.x, random.uniform(0.95f, 1.05f) * sum.y,
                              random.uniform(-1, 1) * sum.z};
        compareWithBruteForce(pair);
    }
}

TEST(HullPair, AgreesWithBruteForce) {
    RAGTOP_NEEDS_HULLS();
    Random random(3);
    for (int i = 0; i < 2000; ++i) {
        SCOPED_TRACE(i);
        const ConvexHull a(randomPoints(random, 5 + i % 20, 1)), b(randomPoints(random, 4 + i % 17, 1));
        const Frame frame{random.vector(0.2f, 1.8f), random.rotation()};
        const double size = std::min(a.data().innerRadius, b.data().innerRadius);
        compareWithBruteForce({hullView(a.data()), hullView(b.data()), frame, size, 4});
    }
}

TEST(BoxHull, CollidesAsTheBoxItIs) {
    Random random(4);
    for (int i = 0; i < 2000; ++i) {
        SCOPED_TRACE(i);
        const ConvexPair pair = randomBoxes(random);
        const HullData a = boxHull(pair.a.halfExtents), b = boxHull(pair.b.halfExtents);
        compareWithBruteForce({hullView(a), hullView(b), pair.bInA, pair.size, pair.extent});
        compareWithBruteForce({pair.a, hullView(b), pair.bInA, pair.size, pair.extent});
        compareWithBruteForce({hullView(a), pair.b, pair.bInA, pair.size, pair.extent});
    }
}

TEST(BoxPair, AgreesWithLibccd) {
#ifdef RAGTOP_WITH_CCD
    Random random(5);
    int agreed = 0;
    for (int i = 0; i < 2000; ++i) {
        SCOPED_TRACE(i);
        agreed += compareWithCcd(randomBoxes(random));
    }
    EXPECT_GE(agreed, 1800);
#else
    GTEST_SKIP() << "this build has no libccd";
#endif
}

TEST(HullPair, AgreesWithLibccd) {
    RAGTOP_NEEDS_HULLS();
#ifdef RAGTOP_WITH_CCD
    Random random(6);
    int agreed = 0;
    for (int i = 0; i < 2000; ++i) {
        SCOPED_TRACE(i);
        const ConvexHull a(randomPoints(random, 5 + i % 20, 1)), b(randomPoints(random, 4 + i % 17, 1));
        const Frame frame{random.vector(0.2f, 1.8f), random.rotation()};
        const double size = std::min(a.data().innerRadius, b.data().innerRadius);
        agreed += compareWithCcd({hullView(a.data()), hullView(b.data()), frame, size, 4});
    }
    EXPECT_GE(agreed, 1800);
#else
    GTEST_SKIP() << "this build has no libccd";
#endif
}

}  // namespace
}  // namespace ragtop
