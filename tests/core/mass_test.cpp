#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>
#include <stdexcept>

#include "mesh_bodies.h"
#include "ragtop/shape.h"
#include "shape_support.h"

namespace ragtop {
namespace {

/// Sums are in double and rounded once.
constexpr double kMassRounding = 2e-7;

void expectSame(const MassProperties& got, const MassProperties& wanted, float size, double relative = kMassRounding) {
    EXPECT_NEAR(got.mass, wanted.mass, relative * wanted.mass);
    EXPECT_LT(length(got.center - wanted.center), relative * size);
    const double inertia = relative * wanted.mass * size * size;
    EXPECT_LT(length(got.inertia.cx - wanted.inertia.cx), inertia);
    EXPECT_LT(length(got.inertia.cy - wanted.inertia.cy), inertia);
    EXPECT_LT(length(got.inertia.cz - wanted.inertia.cz), inertia);
}

TEST(Mass, OfASphereIsTheClosedForm) {
    const MassProperties m = massOf(Sphere{0.3f}, 700);
    const double r = 0.3f, mass = 700 * 4.0 / 3 * std::numbers::pi * r * r * r;
    EXPECT_NEAR(m.mass, mass, kMassRounding * mass);
    EXPECT_EQ(m.center, Vec3{});
    EXPECT_NEAR(m.inertia.cx.x, 0.4 * mass * r * r, kMassRounding * mass);
    EXPECT_EQ(m.inertia.cx.x, m.inertia.cz.z);
    EXPECT_EQ(m.inertia.cy.x, 0);
}

TEST(Mass, OfABoxIsTheClosedForm) {
    const MassProperties m = massOf(Box{{1, 2, 3}}, 10);
    EXPECT_EQ(m.mass, 480);
    EXPECT_EQ(m.inertia.cx, (Vec3{480.0f * 13 / 3, 0, 0}));
    EXPECT_EQ(m.inertia.cy, (Vec3{0, 480.0f * 10 / 3, 0}));
    EXPECT_EQ(m.inertia.cz, (Vec3{0, 0, 480.0f * 5 / 3}));
}

TEST(Mass, OfACapsuleWithoutTubeIsASphere) {
    expectSame(massOf(Capsule{0.25f, 0}, 1000), massOf(Sphere{0.25f}, 1000), 0.25f);
}

/// Slices across the y axis: mass ∫ρ π s² dy, about y ∫½ρπ s⁴ dy, across ∫ρπ(s⁴/4 + s² y²) dy.
TEST(Mass, OfACapsuleIsTheSumOfItsSlices) {
    const double r = 0.25f, h = 0.4f;
    double mass = 0, along = 0, across = 0;
    const int slices = 200000;
    for (int i = 0; i < slices; ++i) {
        const double y = (r + h) * (2 * (i + 0.5) / slices - 1);
        const double cap = std::max(0.0, std::abs(y) - h);
        const double s2 = r * r - cap * cap;
        const double dy = 2 * (r + h) / slices;
        mass += 500 * std::numbers::pi * s2 * dy;
        along += 0.5 * 500 * std::numbers::pi * s2 * s2 * dy;
        across += 500 * std::numbers::pi * (0.25 * s2 * s2 + s2 * y * y) * dy;
    }
    const MassProperties m = massOf(Capsule{0.25f, 0.4f}, 500);
    EXPECT_NEAR(m.mass, mass, 1e-6 * mass);
    EXPECT_NEAR(m.inertia.cy.y, along, 1e-6 * along);
    EXPECT_NEAR(m.inertia.cx.x, across, 1e-6 * across);
    EXPECT_EQ(m.inertia.cx.x, m.inertia.cz.z);
}

TEST(Mass, OfTheHullOfABoxIsThatOfTheBox) {
    RAGTOP_NEEDS_HULLS();
    const Vec3 half{0.3f, 0.7f, 0.2f}, offset{0.5f, -0.25f, 4};
    std::vector<Vec3> points = boxCorners(half);
    for (Vec3& p : points) p += offset;
    MassProperties wanted = massOf(Box{half}, 800);
    wanted.center = offset;
    // Corners are rounded at the offset of 4 m, so sizes are off by some 1e-6.
    expectSame(massOf(ConvexHull(points), 800), wanted, 1, 4e-6);
}

/// A cap of width w cut off the sphere is w²/8r high and faces n points w ~ 1/√n wide, so the missing volume falls
/// as 1/n.
TEST(Mass, OfSphericalHullsConvergesToTheSphere) {
    RAGTOP_NEEDS_HULLS();
    const double volume = 4.0 / 3 * std::numbers::pi * 8;
    double first = 0;
    for (const int level : {2, 3, 4, 5}) {
        const MassProperties m = massOf(ConvexHull(spherePoints(level, 2)), 1);
        const double errorTimesPoints = (volume - m.mass) * (4 * level * level + 2);
        if (level == 2) first = errorTimesPoints;
        EXPECT_NEAR(errorTimesPoints, first, 0.2 * first) << level;
        EXPECT_LT(length(m.center), 1e-6f);
        EXPECT_NEAR(m.inertia.cx.x, m.inertia.cy.y, 1e-5 * m.inertia.cx.x);
    }
}

TEST(Mass, OfATetrahedronHasItsCentroid) {
    RAGTOP_NEEDS_HULLS();
    const std::vector<Vec3> points{{0, 0, 0}, {3, 0, 0}, {0, 3, 0}, {0, 0, 3}};
    const MassProperties m = massOf(ConvexHull(points), 2);
    EXPECT_NEAR(m.mass, 9, 9 * kMassRounding);
    EXPECT_LT(length(m.center - Vec3{0.75f, 0.75f, 0.75f}), 1e-6f);
    // About the corner ∫y² + z² = 2 · ρ l⁵/60; about the centre less m d².
    EXPECT_NEAR(m.inertia.cx.x, 2 * 2 * 243.0 / 60 - 9 * 2 * 0.75 * 0.75, 1e-5);
    // About the corner −∫xy = −ρ l⁵/120.
    EXPECT_NEAR(m.inertia.cx.y, -2 * 243.0 / 120 + 9 * 0.75 * 0.75, 1e-5);
}

TEST(Mass, ParallelAxesAddMassTimesSquaredOffset) {
    const MassProperties m = massOf(Box{{0.5f, 1, 1.5f}}, 100);
    MassProperties far = transformed(m, {{3, 4, 0}, {}});
    EXPECT_EQ(far.center, (Vec3{3, 4, 0}));
    // A speck of mass at the origin moves the centre; two equal bodies at ±d have it at 0.
    MassProperties near = transformed(m, {{-3, -4, 0}, {}});
    const MassProperties pair[] = {far, near};
    const MassProperties both = combined(pair);
    EXPECT_EQ(both.mass, 2 * m.mass);
    EXPECT_EQ(both.center, Vec3{});
    EXPECT_FLOAT_EQ(both.inertia.cx.x, 2 * (m.inertia.cx.x + m.mass * 16));
    EXPECT_FLOAT_EQ(both.inertia.cy.y, 2 * (m.inertia.cy.y + m.mass * 9));
    EXPECT_FLOAT_EQ(both.inertia.cz.z, 2 * (m.inertia.cz.z + m.mass * 25));
    EXPECT_FLOAT_EQ(both.inertia.cx.y, 2 * -m.mass * 12);
    EXPECT_EQ(both.inertia.cx.y, both.inertia.cy.x);
}

TEST(Mass, TurnsWithItsFrame) {
    const Quat quarter = rotationAbout({0, 0, 1}, kPi / 2);
    const MassProperties m = transformed(massOf(Box{{1, 2, 3}}, 10), {{1, 0, 0}, quarter});
    expectSame(m, {480, {1, 0, 0}, massOf(Box{{2, 1, 3}}, 10).inertia}, 3);
}

TEST(Mass, OfHalvesIsThatOfTheWhole) {
    Compound halves;
    halves.parts.push_back({Box{{0.5f, 2, 3}}, {{-0.5f, 0, 0}, {}}});
    halves.parts.push_back({Box{{2, 0.5f, 3}}, {{0.5f, 0, 0}, rotationAbout({0, 0, 1}, kPi / 2)}});
    expectSame(massOf(halves, 10), massOf(Box{{1, 2, 3}}, 10), 3);
}

TEST(Mass, ScalesByPowersOfTwoToTheBit) {
    const MassProperties one = massOf(Capsule{0.3f, 0.7f}, 123), four = massOf(Capsule{1.2f, 2.8f}, 123);
    EXPECT_EQ(four.mass, 64 * one.mass);
    EXPECT_EQ(four.inertia.cx.x, 1024 * one.inertia.cx.x);
    EXPECT_EQ(massOf(Capsule{0.3f, 0.7f}, 64 * 123).inertia.cy.y, 64 * one.inertia.cy.y);
}

TEST(Mass, OfAMeshIsThatOfWhatItEncloses) {
    expectSame(massOf(scenes::boxMesh({1, 2, 3}), 10), massOf(Box{{1, 2, 3}}, 10), 3);
    // Two boxes make an L, wherever it is.
    Compound legs;
    legs.parts.push_back({Box{{0.5f, 0.125f, 0.25f}}, {{0.5f, 0.125f, 0}, {}}});
    legs.parts.push_back({Box{{0.125f, 0.375f, 0.25f}}, {{0.125f, 0.625f, 0}, {}}});
    expectSame(massOf(scenes::angleIron(1, 0.25f, 0.25f), 10), massOf(legs, 10), 1);
}

TEST(Mass, OfAFineTorusIsThatOfTheBody) {
    // V = 2 π² R r², I about the axis = m (R² + ¾ r²), across it m (½ R² + ⅝ r²); a polygon of n corners has
    // sin(2π/n)/(2π/n) of the circle's area, which falls short by (2π/n)²/6 per direction.
    const float R = 1, r = 0.25f;
    const double m = 2 * 3.14159265 * 3.14159265 * 0.0625;
    const double short_ = 2 * std::pow(2 * 3.14159265 / 64, 2) / 6;
    const MassProperties got = massOf(scenes::torus(R, r, 64, 64), 1);
    EXPECT_NEAR(got.mass, m, 1.01 * short_ * m);
    EXPECT_NEAR(got.inertia.cz.z, m * (1 + 0.75 * 0.0625), 4 * short_ * m);
    EXPECT_NEAR(got.inertia.cx.x, m * (0.5 + 0.625 * 0.0625), 4 * short_ * m);
}

TEST(Mass, OfAMeshOfWrongOrientationIsRefused) {
    const auto tetrahedron = [](bool insideOut, bool oneTurned) {
        const std::vector<Vec3> v{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
        std::vector<Triangle> t{{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
        for (std::size_t i = 0; i < (insideOut ? 4u : oneTurned ? 1u : 0u); ++i) std::swap(t[i].b, t[i].c);
        return TriangleMesh(v, t);
    };
    EXPECT_NEAR(massOf(tetrahedron(false, false), 6).mass, 1, 1e-6);
    expectThrow(
        [&] { massOf(tetrahedron(true, false), 1); },
        "shape is a TriangleMesh that has a volume of -0.16666667 m³, which triangles that are clockwise seen from "
        "outside make, and so has no mass");
    expectThrow(
        [&] { massOf(tetrahedron(false, true), 1); },
        "shape is a TriangleMesh that has triangles of opposite orientation at the edge of vertices 0 and 1, and so "
        "has no mass");
}

TEST(Mass, IsRefusedToSurfaces) {
    const std::vector<Vec3> vertices{{0, 0, 0}, {0, 0, 1}, {1, 0, 0}};
    const std::vector<Triangle> triangles{{0, 1, 2}};
    expectThrow([&] { massOf(TriangleMesh(vertices, triangles), 1); },
                "shape is a TriangleMesh that is open at the edge of vertices 0 and 1, and so has no mass");
    const std::vector<float> heights(4, 0.0f);
    expectThrow([&] { massOf(HeightField(2, 2, 1, heights), 1); },
                "shape is a HeightField, which has no mass; must be a solid");
}

}  // namespace
}  // namespace ragtop
