#include "narrowphase/four_capsules.h"

#include "collide_support.h"

namespace ragtop {
namespace {

struct CapsulePair {
    ConvexView a, b;
    Frame bInA;
};

/// One in four has a length of zero, one in four is parallel or nearly so, and some cores meet.
CapsulePair randomPair(Random& random, int kind) {
    CapsulePair pair{capsuleView(random.uniform(0.05f, 0.3f), random.uniform(0.1f, 1)),
                     capsuleView(random.uniform(0.05f, 0.3f), random.uniform(0.1f, 1)),
                     {random.inBox(1), random.rotation()}};
    if (kind == 0) (random.uniform(0, 1) < 0.5f ? pair.a : pair.b).halfExtents.y = 0;
    if (kind == 1) pair.bInA.rotation = random.rotation(0.2f);
    if (kind == 2) pair.bInA = {{0, random.uniform(-0.2f, 0.2f), 0}, rotationAbout({1, 0, 0}, random.uniform(0, 3))};
    return pair;
}

TEST(FourCapsules, GiveTheBitsOfOnePairAlone) {
    Random random(11);
    int single = 0, apart = 0;
    for (int round = 0; round < 20000; ++round) {
        CapsulePair pairs[4];
        FourCapsules four{};
        for (int i = 0; i < 4; ++i) {
            pairs[i] = randomPair(random, i);
            const Frame& frame = pairs[i].bInA;
            four.position.x[i] = frame.position.x, four.position.y[i] = frame.position.y;
            four.position.z[i] = frame.position.z;
            four.rotation.x[i] = frame.rotation.x, four.rotation.y[i] = frame.rotation.y;
            four.rotation.z[i] = frame.rotation.z, four.rotation.w[i] = frame.rotation.w;
            four.halfHeightA[i] = pairs[i].a.halfExtents.y, four.halfHeightB[i] = pairs[i].b.halfExtents.y;
            four.radiusA[i] = pairs[i].a.radius, four.radiusB[i] = pairs[i].b.radius;
        }
        CapsuleTouch touches[4];
        touchFour(four, touches);
        for (int i = 0; i < 4; ++i) {
            if (!touches[i].single) continue;
            ++single;
            const float margin = random.uniform(0, 0.5f);
            const Manifold alone = collided(pairs[i].a, pairs[i].b, pairs[i].bInA, margin);
            Manifold found;
            ASSERT_EQ(takeTouch(touches[i], margin, found), alone.pointCount);
            ASSERT_EQ(found.gap, alone.gap);
            apart += alone.pointCount == 0;
            if (alone.pointCount == 0) continue;
            ASSERT_EQ(found.normal, alone.normal);
            ASSERT_EQ(found.points[0].position, alone.points[0].position);
            ASSERT_EQ(found.points[0].separation, alone.points[0].separation);
            ASSERT_EQ(found.points[0].feature, alone.points[0].feature);
        }
    }
    EXPECT_GT(single, 30000);
    EXPECT_GT(apart, 5000);
}

// Along a line, or through each other to the core, there is more to say than one point.
TEST(FourCapsules, LeaveParallelAndCrossingCoresToOthers) {
    const FourFloats one{1, 1, 1, 1}, none{};
    CapsuleTouch touches[4];
    const float small = std::sin(0.04f), cosine = std::cos(0.04f);  // half of 0.08 rad, less than 0.1
    const float half = std::sqrt(0.5f);
    const FourFloats beside{0.5f, 0.5f, 0.5f, 0}, x{0, small, 0, half}, z{0, 0, 1, 0}, w{1, cosine, 0, half};
    const FourCapsules pairs{{beside, none, none}, {x, none, z, w}, one, one, 0.2f * one, 0.2f * one};
    touchFour(pairs, touches);
    for (const CapsuleTouch& touch : touches) EXPECT_FALSE(touch.single);
}

}  // namespace
}  // namespace ragtop
