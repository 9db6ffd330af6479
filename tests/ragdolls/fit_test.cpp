#include "fit.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "fit_foot.h"
#include "fit_hull.h"

namespace ragtop {
namespace {

/// Points on the surface of a capsule of radius 0.1 and segment 0.4 along y.
std::vector<Vec3> capsulePoints(const Frame& frame) {
    std::vector<Vec3> points;
    for (int i = 0; i < 24; ++i) {
        const SinCos around = sinCos(2 * kPi * static_cast<float>(i) / 24);
        for (int j = 0; j <= 8; ++j) {
            const float y = -0.2f + 0.05f * static_cast<float>(j);
            points.push_back(transformPoint(frame, {0.1f * around.cos, y, 0.1f * around.sin}));
        }
        for (int j = 1; j <= 6; ++j) {
            const SinCos up = sinCos(0.5f * kPi * static_cast<float>(j) / 6);
            for (const float end : {-1.0f, 1.0f})
                points.push_back(transformPoint(
                    frame, {0.1f * up.cos * around.cos, end * (0.2f + 0.1f * up.sin), 0.1f * up.cos * around.sin}));
        }
    }
    return points;
}

TEST(FitCapsule, RecoversACapsuleFromItsSurface) {
    const Frame frame{{1, 2, 3}, rotationAbout({1, 1, 0}, 0.8f)};
    const auto points = capsulePoints(frame);
    const FittedShape fitted = fitCapsule(points, rotate(frame.rotation, {0, 1, 0}), 1.0f);
    const Capsule& capsule = std::get<Capsule>(fitted.shape);
    EXPECT_NEAR(capsule.radius, 0.1f, 1e-4f);
    EXPECT_NEAR(capsule.halfHeight, 0.2f, 1e-4f);
    EXPECT_LT(length(fitted.frame.position - frame.position), 1e-4f);
    EXPECT_EQ(countInside(fitted, points), static_cast<int>(points.size()));
}

TEST(FitCapsule, LeavesOutFarPoints) {
    auto points = capsulePoints({});
    const std::size_t sound = points.size();
    for (int i = 0; i < 10; ++i) points.push_back({2.0f, 0.1f * static_cast<float>(i), 0});
    const FittedShape fitted = fitCapsule(points, {0, 1, 0}, 0.95f);
    EXPECT_LT(std::get<Capsule>(fitted.shape).radius, 0.12f);
    EXPECT_GE(countInside(fitted, points), static_cast<int>(std::ceil(0.95f * static_cast<float>(sound + 10))));
}

TEST(FitCapsule, OfManyPointsIsNearlyThatOfFew) {
    // Points in a rod whose ends are thinner than its middle.
    std::mt19937 random(5);
    const auto any = [&] { return static_cast<float>(random()) / 4294967296.0f; };
    std::vector<Vec3> many;
    for (int i = 0; i < 20'000; ++i) {
        const float y = any() - 0.5f, radius = (0.1f - 0.15f * y * y) * any();
        const SinCos around = sinCos(2 * kPi * any());
        many.push_back({radius * around.cos, y, radius * around.sin});
    }
    for (const float share : {0.9f, 1.0f}) {
        const FittedShape of = fitCapsule(many, {0, 1, 0}, share);
        EXPECT_GE(countInside(of, many), static_cast<int>(std::ceil(share * 20'000)));
        const FittedShape ofFew = fitCapsule(std::span(many).first(1000), {0, 1, 0}, share);
        EXPECT_NEAR(massOf(of.shape, 1).mass, massOf(ofFew.shape, 1).mass, 0.1f * massOf(of.shape, 1).mass) << share;
    }
}

TEST(FitBox, HoldsTheShareAskedFor) {
    std::vector<Vec3> points;
    for (int i = 0; i < 1000; ++i) {
        const auto part = [&](int factor) { return static_cast<float>(i * factor % 101) / 100.0f - 0.5f; };
        points.push_back({part(7), 0.3f * part(31), 2.0f * part(57)});
    }
    const Quat rotation = rotationAbout({0, 1, 0}, 0.3f);
    for (Vec3& point : points) point = rotate(rotation, point);
    for (const float share : {0.8f, 0.9f, 1.0f}) {
        const FittedShape fitted = fitBox(points, rotation, share);
        EXPECT_GE(countInside(fitted, points), static_cast<int>(share * 1000));
    }
    EXPECT_NEAR(std::get<Box>(fitBox(points, rotation, 1.0f).shape).halfExtents.z, 1.0f, 1e-3f);
}

TEST(FitBox, LeavesOutAsMuchAsTheShareAllowsHoweverManyPointsThereAre) {
    std::mt19937 random(11);
    const auto any = [&] { return static_cast<float>(random()) / 4294967296.0f - 0.5f; };
    for (const std::size_t count : {1u, 7u, 50u, 500u}) {
        std::vector<Vec3> points;
        for (std::size_t i = 0; i < count; ++i) {
            const float far = i % 5 == 0 ? 4.0f : 1.0f;
            points.push_back(far * Vec3{any(), 2 * any(), i % 3 == 0 ? 0.25f : any()});
        }
        std::vector<float> along[3];
        for (int axis = 0; axis < 3; ++axis) {
            for (const Vec3& point : points) along[axis].push_back(point[axis]);
            std::sort(along[axis].begin(), along[axis].end());
        }
        const std::size_t spare = count - static_cast<std::size_t>(std::ceil(0.8f * static_cast<float>(count)));
        Vec3 half;
        // Of as many left out on each side of each axis the most that holds the share.
        for (std::size_t each = spare / 2 + 1; each-- > 0;) {
            Vec3 lower, upper;
            for (int axis = 0; axis < 3; ++axis) {
                lower[axis] = along[axis][each];
                upper[axis] = along[axis][count - 1 - each];
            }
            half = 0.5f * (upper - lower);
            if (count - static_cast<std::size_t>(countInside({Box{half}, {0.5f * (upper + lower), {}}}, points)) <=
                spare)
                break;
        }
        EXPECT_EQ(std::get<Box>(fitBox(points, {}, 0.8f).shape).halfExtents, half) << count;
    }
}

TEST(FitCapsule, OnePointStillGivesAShape) {
    const std::vector<Vec3> points(20, Vec3{1, 1, 1});
    const FittedShape fitted = fitCapsule(points, {0, 1, 0}, 0.9f);
    EXPECT_GE(countInside(fitted, points), 18);
}

TEST(CapsuleBetween, HasTheVolume) {
    for (const float volume : {0.0001f, 0.001f, 0.004f}) {
        const FittedShape fitted = capsuleBetween({0, 0, 0}, {0.5f, 0, 0}, volume);
        const Capsule& c = std::get<Capsule>(fitted.shape);
        const float got = kPi * c.radius * c.radius * (2 * c.halfHeight + 4.0f / 3.0f * c.radius);
        EXPECT_NEAR(got, volume, 1e-3f * volume);
        EXPECT_NEAR(2 * (c.halfHeight + c.radius), 0.5f, 1e-6f);
    }
}

TEST(Overlap, OfCapsulesIsExact) {
    const FittedShape a{Capsule{0.1f, 0.5f}, {}};
    const Quat tilted = rotationAbout({0, 0, 1}, 1.0f);
    const auto crossing = [&](float z) { return FittedShape{Capsule{0.2f, 0.5f}, {{0, 0, z}, tilted}}; };
    EXPECT_TRUE(mayOverlap(a, crossing(0.299f), 0));
    EXPECT_FALSE(mayOverlap(a, crossing(0.301f), 0));
    EXPECT_TRUE(mayOverlap(a, crossing(0.301f), 0.01f));
    const FittedShape above{Capsule{0.1f, 0.1f}, {{0, 0.81f, 0}, {}}};
    EXPECT_FALSE(mayOverlap(a, above, 0));
}

TEST(Overlap, OfBoxesFindsTheGap) {
    const FittedShape a{Box{{1, 1, 1}}, {}};
    const Quat turned = rotationAbout({0, 1, 0}, 0.25f * kPi);
    const auto beside = [&](float x) { return FittedShape{Box{{1, 1, 1}}, {{x, 0, 0}, turned}}; };
    EXPECT_TRUE(mayOverlap(a, beside(2.40f), 0));
    EXPECT_FALSE(mayOverlap(a, beside(2.42f), 0));
}

TEST(Overlap, OfHullsIsThatOfTheBoxesTheyAre) {
    const auto hullOf = [](const Vec3& half) {
        std::vector<Vec3> corners;
        for (int i = 0; i < 8; ++i)
            corners.push_back(scale(half, {i & 1 ? 1.0f : -1.0f, i & 2 ? 1.0f : -1.0f, i & 4 ? 1.0f : -1.0f}));
        return ConvexHull(corners);
    };
    const FittedShape a{hullOf({1, 1, 1}), {}};
    const Quat turned = rotationAbout({0, 1, 0}, 0.25f * kPi);
    // It may see no gap of a hundredth of the size.
    for (const bool hull : {false, true}) {
        const auto beside = [&](float x) {
            return FittedShape{hull ? Shape{hullOf({1, 1, 1})} : Shape{Box{{1, 1, 1}}}, {{x, 0, 0}, turned}};
        };
        EXPECT_TRUE(mayOverlap(a, beside(2.40f), 0));
        EXPECT_FALSE(mayOverlap(a, beside(2.44f), 0));
        EXPECT_TRUE(mayOverlap(a, beside(2.44f), 0.04f));
    }
    EXPECT_FALSE(mayOverlap(a, {Capsule{0.2f, 0.5f}, {{1.25f, 0, 0}, {}}}, 0));
    EXPECT_TRUE(mayOverlap(a, {Capsule{0.2f, 0.5f}, {{1.15f, 0, 0}, {}}}, 0));
}

/// Points of a limb that is half as thick at its end: V = π L (R² + R r + r²)/3.
std::vector<Vec3> taperedPoints(std::size_t count) {
    std::mt19937 random(9);
    const auto any = [&] { return static_cast<float>(random()) / 4294967296.0f; };
    std::vector<Vec3> points;
    for (std::size_t i = 0; i < count; ++i) {
        const float y = any(), radius = 0.1f - 0.05f * y;
        const SinCos around = sinCos(2 * kPi * any());
        points.push_back({radius * around.cos, 0.4f * y, radius * around.sin});
    }
    return points;
}

TEST(FitHull, OfATaperedLimbHoldsItsSkinWithLittleAir) {
    const float volume = kPi * 0.4f * (0.01f + 0.005f + 0.0025f) / 3;
    for (const std::size_t count : {60u, 500u, 20'000u}) {
        const std::vector<Vec3> points = taperedPoints(count);
        const auto hull = fitHull(points, rotationAbout({1, 2, 0}, 0.7f), 0.92f);
        ASSERT_TRUE(hull);
        EXPECT_GE(countInside(hull->fitted, points), static_cast<int>(0.92f * static_cast<float>(count)));
        EXPECT_LE(std::get<ConvexHull>(hull->fitted.shape).vertices().size(), 38u);
        EXPECT_LT(massOf(hull->fitted.shape, 1).mass, 1.25f * volume) << count;
        // 64 corners on a round body of as many points leave out some of it.
        EXPECT_LT(hull->pointsVolume, 1.001f * volume);
        if (count > 100) {
            EXPECT_GT(hull->pointsVolume, 0.92f * volume);
        }
        EXPECT_GT(massOf(fitCapsule(points, {0, 1, 0}, 0.92f).shape, 1).mass, 1.25f * volume);
    }
}

TEST(FitHull, OfPointsInAPlaneIsNone) {
    std::vector<Vec3> points;
    for (int i = 0; i < 100; ++i) {
        const auto n = static_cast<float>(i);
        points.push_back({n, 2 * n + 0.5f * static_cast<float>(i % 7), 3 * n - static_cast<float>(i % 7)});
    }
    EXPECT_FALSE(fitHull(points, {}, 0.9f));
    EXPECT_FALSE(fitHull(std::vector<Vec3>(20, Vec3{1, 1, 1}), {}, 0.9f));
}

/// A wedge with a shaft above its heel, as shoes are: x across, y towards the toes, z up.
std::vector<Vec3> shoePoints(int count) {
    std::mt19937 random(21);
    const auto any = [&] { return static_cast<float>(random()) / 4294967296.0f; };
    std::vector<Vec3> points;
    while (static_cast<int>(points.size()) < count) {
        const float along = any(), high = any();
        if (high > 0.35f + std::max(0.0f, 0.65f - 1.3f * along)) continue;
        const float width = (0.035f + 0.015f * along) * (1 - 0.3f * high);
        const float edge = std::clamp(4 * std::min(along, 1 - along), 0.3f, 1.0f);
        points.push_back({width * edge * (2 * any() - 1), 0.27f * along - 0.09f, 0.11f * high});
    }
    return points;
}

TEST(FitFoot, StandsOnARectangleAndHoldsItsSkinWithLittleAir) {
    for (const int count : {400, 2000, 8000}) {
        std::vector<Vec3> points = shoePoints(count);
        const Quat rotation = normalized(rotationAbout({1, -0.4f, 0.2f}, 1.1f));
        for (Vec3& point : points) point = rotate(rotation, point);
        const FittedShape foot = fitFoot(points, rotation, 0.92f);
        const auto* hull = std::get_if<ConvexHull>(&foot.shape);
        ASSERT_TRUE(hull) << count;
        EXPECT_GE(countInside(foot, points), static_cast<int>(std::ceil(0.92f * static_cast<float>(count))));
        EXPECT_LE(massOf(*hull, 1).mass, 1.25f * massOf(ConvexHull(points), 1).mass) << count;
        float lowest = 1, next = 1;
        std::vector<Vec3> sole;
        for (const Vec3& corner : hull->vertices()) lowest = std::min(lowest, corner.z);
        for (const Vec3& corner : hull->vertices())
            if (corner.z < lowest + 1e-6f)
                sole.push_back(corner);
            else
                next = std::min(next, corner.z);
        ASSERT_EQ(sole.size(), 4u) << count;
        EXPECT_GT(next, lowest + 0.002f);
        for (const Vec3& corner : sole) EXPECT_NEAR(std::abs(corner.x), std::abs(sole[0].x), 0.01f);
    }
}

/// What is a box already stays one, and what is flat.
TEST(FitFoot, OfABlockIsTheBox) {
    std::vector<Vec3> points;
    for (int i = 0; i < 1000; ++i)
        points.push_back({0.04f * static_cast<float>(i % 10), 0.08f * static_cast<float>(i / 10 % 10),
                          0.03f * static_cast<float>(i / 100)});
    EXPECT_TRUE(std::holds_alternative<Box>(fitFoot(points, {}, 1.0f).shape));
    for (Vec3& point : points) point.z = 0;
    EXPECT_TRUE(std::holds_alternative<Box>(fitFoot(points, {}, 0.9f).shape));
}

/// Nine tenths of the points are in a cube; the others reach twice as far, so that whatever leaves out as much of all
/// as may be leaves out too many of them.
TEST(FitBoth, HoldsTheShareOfEitherKindHoweverFewThereAre) {
    std::mt19937 random(4);
    const auto any = [&] { return static_cast<float>(random()) / 4294967296.0f - 0.5f; };
    for (const std::size_t own : {90u, 900u, 9000u}) {
        std::vector<Vec3> points;
        for (std::size_t i = 0; i < own; ++i) points.push_back({any(), any(), any()});
        for (std::size_t i = 0; i < own / 9; ++i) points.push_back({2 * any(), any(), any()});
        int fits = 0;
        const auto fit = [&](std::span<const Vec3> some, float share) {
            ++fits;
            return fitBox(some, {}, share);
        };
        const FittedShape fitted =
            fitBoth(points, own, {0.1f * static_cast<float>(own), 0.1f * static_cast<float>(own / 9)}, fit);
        const std::span<const Vec3> all(points);
        EXPECT_GE(countInside(fitted, all.first(own)), static_cast<int>(0.9f * static_cast<float>(own)));
        EXPECT_GE(countInside(fitted, all.subspan(own)), static_cast<int>(0.9f * static_cast<float>(own / 9)));
        EXPECT_LT(countInside(fitBox(points, {}, 0.9f), all.subspan(own)),
                  static_cast<int>(0.9f * static_cast<float>(own / 9)));
        EXPECT_LE(fits, 3) << own;
    }
    // Of one kind it is the shape that was asked for.
    const std::vector<Vec3> points = capsulePoints({});
    const auto fit = [](std::span<const Vec3> some, float share) { return fitBox(some, {}, share); };
    const auto half = static_cast<float>(points.size() / 2);
    const FittedShape fitted = fitBoth(points, points.size() / 2, LeftOut{half, half}, fit);
    EXPECT_EQ(std::get<Box>(fitted.shape).halfExtents, std::get<Box>(fitBox(points, {}, 0.0f).shape).halfExtents);
}

TEST(KeptAbove, LeavesAHullThatStandsOnTheFloorAsItIs) {
    const FittedShape foot = fitFoot(shoePoints(500), {}, 0.92f);
    const float floor = bottomOf(foot, {0, 0, 1}) + 1e-7f;
    const FittedShape kept = keptAbove(foot, {0, 0, 1}, floor, 0.001f);
    EXPECT_EQ(std::get<ConvexHull>(kept.shape).vertices().size(), std::get<ConvexHull>(foot.shape).vertices().size());
}

TEST(GrowingHull, OfTheCornersOfACubeIsTheCube) {
    std::vector<Vec3> points;
    for (int i = 0; i < 125; ++i)
        points.push_back(0.5f *
                         Vec3{static_cast<float>(i % 5), static_cast<float>(i / 5 % 5), static_cast<float>(i / 25)});
    GrowingHull hull(points);
    hull.grow(points.size());
    EXPECT_EQ(hull.corners().size(), 8u);
    EXPECT_NEAR(hull.volume(), 8.0f, 1e-4f);
}

/// Nothing is left below the floor, and nothing above it is lost that the cut need not take.
TEST(KeptAbove, CutsWhatIsBelowAndNoMore) {
    for (int i = 0; i < 50; ++i) {
        const auto n = static_cast<float>(i);
        const Frame frame{{0.1f * n, 1, -0.2f}, rotationAbout({1, 0.3f * n, -2}, 0.37f * n)};
        const Vec3 up = normalized(Vec3{0.2f, 1, 0.05f * n});
        const Shape hull = ConvexHull(capsulePoints({}));
        for (const Shape& shape : {Shape{Capsule{0.1f, 0.3f}}, Shape{Box{{0.1f, 0.3f, 0.2f}}}, hull}) {
            const FittedShape whole{shape, frame};
            const float bottom = bottomOf(whole, up), top = -bottomOf(whole, -up);
            for (const float share : {-0.1f, 0.1f, 0.4f}) {
                const float floor = bottom + share * (top - bottom);
                const FittedShape cut = keptAbove(whole, up, floor, 0.01f);
                EXPECT_NEAR(bottomOf(cut, up), std::max(floor, bottom), 2e-6f) << i << " " << share;
                EXPECT_LE(-bottomOf(cut, -up), top + 1e-6f);
            }
        }
    }
    const FittedShape upright = keptAbove({Capsule{0.1f, 0.3f}, {}}, {0, 1, 0}, -0.2f, 0.01f);
    EXPECT_FLOAT_EQ(std::get<Capsule>(upright.shape).radius, 0.1f);
    EXPECT_FLOAT_EQ(std::get<Capsule>(upright.shape).halfHeight, 0.2f);
    EXPECT_FLOAT_EQ(-bottomOf(upright, {0, -1, 0}), 0.4f);
}

}  // namespace
}  // namespace ragtop
