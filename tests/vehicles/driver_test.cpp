#include "ragtop/driver.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "road.h"

namespace ragtop {
namespace {

/// A smooth line goes through the points it is made of, and no step of it is longer than 2 m by more than it bends.
TEST(DriverLine, SmoothLineGoesThroughItsPoints) {
    const std::array<DVec3, 5> through{{{0, 0, 0}, {0, 1, 20}, {10, 0, 40}, {40, 0, 45}, {50, 0, 10}}};
    for (const bool closed : {false, true}) {
        const std::vector<DVec3> line = smoothLine(through, closed);
        for (const DVec3& point : through) EXPECT_NE(std::ranges::find(line, point), line.end());
        for (std::size_t i = 1; i < line.size(); ++i) EXPECT_LT(length(relative(line[i], line[i - 1])), 3.0f);
        EXPECT_EQ(closed, line.back() != through.back());
    }
}

/// On a polygon of n corners on a circle, by elementary geometry.
TEST(DriverLine, PlaceIsMeasuredAlongAndToTheLeft) {
    constexpr int kCorners = 360;
    constexpr double kRadius = 50;
    std::vector<DVec3> circle;
    for (int i = 0; i < kCorners; ++i) {
        const double angle = 2 * 3.14159265358979 * i / kCorners;
        circle.push_back({kRadius * std::cos(angle) - kRadius, 0, kRadius * std::sin(angle)});
    }
    // From the origin towards +z, its middle at x = −50: to the right, as left is +x.
    const DriverLine line{circle, true};
    const LinePlace inside = placeAt(line, {-10, 3, 0}), outside = placeAt(line, {-50, 0, 55});
    const double round = 2 * kCorners * kRadius * std::sin(3.14159265358979 / kCorners);
    EXPECT_NEAR(inside.length, round, 1e-3);
    // The foot is on either side of the corner, by the share of an edge's half that the place is nearer to the line.
    const double half = kRadius * std::sin(3.14159265358979 / kCorners);
    EXPECT_NEAR(inside.along, 0, 10 / kRadius * half + 1e-4);
    EXPECT_NEAR(inside.aside, -10, 2e-3);
    EXPECT_NEAR(outside.along, round / 4, 1e-2);
    EXPECT_NEAR(outside.aside, 5, 1e-2);
}

/// At 6 m/s pure pursuit aims 7.6 m ahead, or at the next point of the line, 2.1 m farther, and cuts a circle of 40 m
/// by less than aim²/(8 R) = 0.3 m.
TEST(Driver, KeepsACarOnACircle) {
    std::vector<DVec3> circle;
    for (int i = 0; i < 120; ++i) {
        const double angle = 2 * 3.14159265358979 * i / 120;
        circle.push_back({40 - 40 * std::cos(angle), 0, 40 * std::sin(angle)});
    }
    const DriverLine line{circle, true};
    Road road;
    Vehicle car(road.world, hatchback());
    for (int i = 0; i < 3000; ++i) {
        car.input = followLine(line, car, road.world.pose(car.chassis()), 6);
        road.world.step(kStep);
        if (i < 600) continue;
        ASSERT_LT(std::abs(placeAt(line, road.world.pose(car.chassis()).position).aside), 0.3f) << i;
    }
    EXPECT_NEAR(car.telemetry().speed, 6, 0.5);
}

}  // namespace
}  // namespace ragtop
