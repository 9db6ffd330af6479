#include "base/four_floats.h"

#include "collide_support.h"

namespace ragtop {
namespace {

Vec3 lane(const FourVectors& v, int i) { return {v.x[i], v.y[i], v.z[i]}; }
Quat lane(const FourQuats& q, int i) { return {q.x[i], q.y[i], q.z[i], q.w[i]}; }

FourVectors toFour(const Vec3 (&v)[4]) {
    return {FourFloats{v[0].x, v[1].x, v[2].x, v[3].x}, FourFloats{v[0].y, v[1].y, v[2].y, v[3].y},
            FourFloats{v[0].z, v[1].z, v[2].z, v[3].z}};
}
FourQuats toFour(const Quat (&q)[4]) {
    FourFloats rows[4];
    for (int i = 0; i < 4; ++i) rows[i] = loadFour(&q[i].x);
    transposeFour(rows);
    return {rows[0], rows[1], rows[2], rows[3]};
}

TEST(FourFloats, GiveInEachLaneWhatItGivesAlone) {
    Random random(3);
    for (int round = 0; round < 25000; ++round) {
        Vec3 a[4], b[4];
        Quat p[4], q[4];
        for (int i = 0; i < 4; ++i) {
            a[i] = random.inBox(2), b[i] = random.inBox(2);
            p[i] = random.rotation(), q[i] = random.rotation();
        }
        const FourVectors fourA = toFour(a), fourB = toFour(b);
        const FourQuats fourP = toFour(p), fourQ = toFour(q);
        const FourFloats dots = dot(fourA, fourB), lengths = length(fourA);
        const FourVectors crosses = cross(fourA, fourB), turned = rotate(fourP, fourA);
        const FourVectors back = inverseRotate(fourP, fourA), sums = fourA + 2.0f * fourB;
        const FourQuats products = fourP * fourQ, units = normalized(fourP * fourQ);
        const unsigned below = lanesWhere(fourA.x < fourB.x);
        for (int i = 0; i < 4; ++i) {
            ASSERT_EQ(dots[i], dot(a[i], b[i]));
            ASSERT_EQ(lengths[i], length(a[i]));
            ASSERT_EQ(lane(crosses, i), cross(a[i], b[i]));
            ASSERT_EQ(lane(turned, i), rotate(p[i], a[i]));
            ASSERT_EQ(lane(back, i), inverseRotate(p[i], a[i]));
            ASSERT_EQ(lane(sums, i), a[i] + 2.0f * b[i]);
            ASSERT_EQ(lane(products, i), p[i] * q[i]);
            ASSERT_EQ(lane(units, i), normalized(p[i] * q[i]));
            ASSERT_EQ((below >> i & 1u) != 0, a[i].x < b[i].x);
        }
    }
    EXPECT_EQ(lane(normalized(FourQuats{}), 2), Quat{});
}

}  // namespace
}  // namespace ragtop
