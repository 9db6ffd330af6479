#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <random>

#include "ragtop/eigen.h"
#include "ragtop/math.h"

namespace ragtop {
namespace {

/// The distance of two neighbouring floats at the size of v.
long double unitAt(long double v) {
    const float f = static_cast<float>(std::abs(v));
    return static_cast<long double>(std::nextafter(f, std::numeric_limits<float>::infinity())) - f;
}
long double unitsOff(float got, long double wanted) { return std::abs(got - wanted) / unitAt(wanted); }

class Fnv {
public:
    void add(float v) {
        const auto bits = std::bit_cast<std::uint32_t>(v);
        for (int i = 0; i < 4; ++i) hash_ = (hash_ ^ ((bits >> (8 * i)) & 0xff)) * 1099511628211ull;
    }
    std::uint64_t value() const { return hash_; }

private:
    std::uint64_t hash_ = 14695981039346656037ull;
};

Quat randomRotation(std::mt19937& random) {
    std::uniform_real_distribution<float> u(-1, 1);
    for (;;) {
        const Quat q{u(random), u(random), u(random), u(random)};
        const float l = q.x * q.x + q.y * q.y + q.z * q.z + q.w * q.w;
        if (l > 0.01f && l < 1) return normalized(q);
    }
}

float angleBetween(const Quat& a, const Quat& b) { return length(rotationVector(conjugate(a) * b)); }

constexpr float kRoundings = 1e-6f;  // a handful of roundings of numbers near 1, 6e-8 each

TEST(SinCos, IsWithinAnUlpUpToTenThousandRadians) {
    long double worst = 0;
    for (int i = -200000; i <= 200000; ++i) {
        const float angle = 0.05f * static_cast<float>(i) + 1e-3f * static_cast<float>(i % 37);
        const SinCos v = sinCos(angle);
        worst = std::max({worst, unitsOff(v.sin, std::sin(static_cast<long double>(angle))),
                          unitsOff(v.cos, std::cos(static_cast<long double>(angle)))});
    }
    EXPECT_LE(worst, 0.51L);
}

TEST(SinCos, IsWithinAnUlpAtEveryScaleOfSmallAngles) {
    long double worst = 0;
    for (float angle = 1e-37f; angle < 4; angle *= 1.001f) {
        const SinCos v = sinCos(angle);
        worst = std::max({worst, unitsOff(v.sin, std::sin(static_cast<long double>(angle))),
                          unitsOff(v.cos, std::cos(static_cast<long double>(angle)))});
    }
    EXPECT_LE(worst, 0.51L);
}

TEST(SinCos, KeepsItsBitsOnEveryPlatform) {
    Fnv hash;
    for (float angle = 1e-6f; angle < 1e30f; angle *= 1.01f) {
        const SinCos v = sinCos(angle), w = sinCos(-angle);
        hash.add(v.sin);
        hash.add(v.cos);
        hash.add(arcTan2(v.sin, v.cos));
        EXPECT_EQ(w.sin, -v.sin);
        EXPECT_EQ(w.cos, v.cos);
    }
    EXPECT_EQ(hash.value(), 2118482371296179000u);
}

TEST(SinCos, StaysOnTheUnitCircleForAnyFiniteAngle) {
    for (float angle = 1; angle < 3e38f; angle *= 1.7f) {
        const SinCos v = sinCos(angle);
        EXPECT_NEAR(v.sin * v.sin + v.cos * v.cos, 1, kRoundings) << angle;
    }
    EXPECT_TRUE(std::isnan(sinCos(std::numeric_limits<float>::infinity()).sin));
    EXPECT_EQ(sinCos(0).sin, 0);
    EXPECT_EQ(sinCos(0).cos, 1);
}

TEST(ArcTan2, IsWithinAnUlpInAllQuadrants) {
    long double worst = 0;
    for (int i = 0; i < 200000; ++i) {
        const float angle = -kPi + 2 * kPi * static_cast<float>(i) / 200000;
        const float size = std::ldexp(1.0f, i % 80 - 40);
        const float x = size * std::cos(angle), y = size * std::sin(angle);
        worst = std::max(worst,
                         unitsOff(arcTan2(y, x), std::atan2(static_cast<long double>(y), static_cast<long double>(x))));
    }
    EXPECT_LE(worst, 0.51L);
}

TEST(ArcTan2, IsExactOnTheAxes) {
    EXPECT_EQ(arcTan2(0, 0), 0);
    EXPECT_EQ(arcTan2(0, 1), 0);
    EXPECT_EQ(arcTan2(0, -1), kPi);
    EXPECT_EQ(arcTan2(-0.0f, -1), kPi);
    EXPECT_EQ(arcTan2(3, 0), kPi / 2);
    EXPECT_EQ(arcTan2(-3, 0), -kPi / 2);
    EXPECT_EQ(arcTan2(2, 2), kPi / 4);
}

TEST(Rotation, AboutAnAxisTurnsThePlaneAcrossIt) {
    for (float angle = -7; angle < 7; angle += 0.37f) {
        const Quat q = rotationAbout({0, 0, 25}, angle);
        const Vec3 turned = rotate(q, {1, 0, 0});
        EXPECT_NEAR(turned.x, std::cos(angle), kRoundings);
        EXPECT_NEAR(turned.y, std::sin(angle), kRoundings);
        EXPECT_NEAR(turned.z, 0, kRoundings);
    }
    EXPECT_EQ(rotationAbout({0, 0, 0}, 1), Quat{});
    EXPECT_EQ(rotationAbout({1e-30f, 0, 0}, 1), rotationAbout({1e30f, 0, 0}, 1));
}

TEST(Rotation, BetweenDirectionsIsTheShortestOne) {
    std::mt19937 random(1);
    for (int i = 0; i < 1000; ++i) {
        const Vec3 from = rotate(randomRotation(random), {1, 0, 0}), to = rotate(randomRotation(random), {1, 0, 0});
        const Quat q = rotationBetween(from, to);
        EXPECT_LT(length(rotate(q, from) - to), 2 * kRoundings);
        EXPECT_NEAR(dot(rotationVector(q), from), 0, 4 * kRoundings);
        EXPECT_LT(length(rotate(rotationBetween(from, -from), from) + from), 2 * kRoundings);
        const Vec3 nearlyOpposite = normalized(-from + 1e-5f * to);
        EXPECT_LT(length(rotate(rotationBetween(from, nearlyOpposite), from) - nearlyOpposite), 2 * kRoundings);
    }
    EXPECT_EQ(rotationBetween({0, 1, 0}, {0, 1, 0}), Quat{});
}

TEST(Rotation, FromAxesUndoesTheirMatrix) {
    std::mt19937 random(2);
    for (int i = 0; i < 1000; ++i) {
        const Quat q = randomRotation(random);
        const Mat3 m = toMat3(q);
        EXPECT_LT(angleBetween(q, rotationFromAxes(m.cx, m.cy, m.cz)), 2 * kRoundings);
    }
    // Half turns, where the trace is −1.
    EXPECT_LT(angleBetween(Quat{0, 1, 0, 0}, rotationFromAxes({-1, 0, 0}, {0, 1, 0}, {0, 0, -1})), kRoundings);
    EXPECT_LT(angleBetween(Quat{0, 0, 1, 0}, rotationFromAxes({-1, 0, 0}, {0, -1, 0}, {0, 0, 1})), kRoundings);
    EXPECT_LT(angleBetween(Quat{1, 0, 0, 0}, rotationFromAxes({1, 0, 0}, {0, -1, 0}, {0, 0, -1})), kRoundings);
}

TEST(Rotation, VectorIsAxisTimesAngleUpToPi) {
    for (float angle = 1e-6f; angle < kPi; angle *= 1.1f) {
        const Vec3 v = rotationVector(rotationAbout({0, 3, 4}, angle));
        EXPECT_NEAR(length(v), angle, kRoundings * (1 + angle));
        EXPECT_NEAR(v.y * 4, v.z * 3, kRoundings * angle);
    }
    EXPECT_NEAR(rotationVector(rotationAbout({1, 0, 0}, 1.5f * kPi)).x, -0.5f * kPi, 2 * kRoundings);
    EXPECT_EQ(rotationVector({}), Vec3{});
}

TEST(Blend, TurnsAtConstantRateAlongTheShorterArc) {
    std::mt19937 random(3);
    for (int i = 0; i < 200; ++i) {
        const Pose from{{1e5, 2, 3}, randomRotation(random)};
        Pose to{{1e5 + 1, 4, 1}, randomRotation(random)};
        const float whole = angleBetween(from.rotation, to.rotation);
        const Pose quarter = blend(from, to, 0.25);
        EXPECT_NEAR(angleBetween(from.rotation, quarter.rotation), 0.25f * whole, 4 * kRoundings);
        EXPECT_NEAR(angleBetween(quarter.rotation, to.rotation), 0.75f * whole, 4 * kRoundings);
        EXPECT_NEAR(quarter.position.x, 1e5 + 0.25, 1e-9);
        // −q is the same rotation.
        to.rotation = {-to.rotation.x, -to.rotation.y, -to.rotation.z, -to.rotation.w};
        EXPECT_LT(angleBetween(blend(from, to, 0.25).rotation, quarter.rotation), 2 * kRoundings);
    }
}

TEST(Blend, IsExactAtBothEnds) {
    const Pose from{{0.1, 0.2, 0.3}, {0.6f, 0, 0, 0.8f}}, to{{0.7, 0.9, 1.1}, {0, 0.8f, 0, 0.6f}};
    EXPECT_EQ(blend(from, to, 0), from);
    EXPECT_EQ(blend(from, to, 1), to);
}

TEST(Eigen, RotatesVectorsAlike) {
    std::mt19937 random(4);
    for (int i = 0; i < 100; ++i) {
        const Quat q = randomRotation(random);
        const Vec3 v{0.3f, -0.5f, 0.7f};
        const Vec3 wanted = rotate(q, v);
        EXPECT_LT(length(fromEigen(Eigen::Vector3f(toEigen(q) * toEigen(v))) - wanted), kRoundings);
        EXPECT_LT(length(fromEigen(Eigen::Vector3f(toEigen(toMat3(q)) * toEigen(v))) - wanted), kRoundings);
        EXPECT_EQ(fromEigen(toEigen(q)), q);
        EXPECT_EQ(fromEigen(toEigen(v)), v);
        const Mat3 m = fromEigen(toEigen(toMat3(q)));
        EXPECT_EQ(m.cy, toMat3(q).cy);
        const Pose pose{{1, 2, 3}, q};
        const DVec3 moved = fromEigen(Eigen::Vector3d(toEigen(pose) * toEigen(DVec3(v))));
        EXPECT_LT(length(relative(moved, transformPoint(pose, v))), kRoundings);
    }
}

}  // namespace
}  // namespace ragtop
