#include "direct/friction_share.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace ragtop::direct {
namespace {

constexpr double kMu = 0.4;

struct Wrench {
    double force[2] = {0, 0}, twist = 0;
};

Wrench wrenchOf(const SharePoint* points, unsigned count) {
    Wrench sum;
    for (unsigned j = 0; j < count; ++j) {
        const SharePoint& p = points[j];
        sum.force[0] += p.friction[0], sum.force[1] += p.friction[1];
        sum.twist += p.x * p.friction[1] - p.y * p.friction[0];
    }
    return sum;
}

/// Points with loads over six decades and some friction within their discs.
unsigned dice(std::mt19937& random, SharePoint points[4], double least) {
    std::uniform_real_distribution<double> unit(-1, 1);
    const unsigned count = 1 + random() % 4;
    for (unsigned j = 0; j < count; ++j) {
        SharePoint& p = points[j];
        p.x = unit(random), p.y = unit(random);
        p.normal = std::pow(10.0, 3 * unit(random));
        const double angle = 3.14159265 * unit(random);
        const double size = kMu * p.normal * (least + (1 - least) * std::abs(unit(random)));
        p.friction[0] = size * std::cos(angle), p.friction[1] = size * std::sin(angle);
    }
    return count;
}

/// What points can carry between them is found again, up to the limit of friction.
TEST(FrictionShare, KeepsForceAndTwist) {
    std::mt19937 random(1);
    for (int trial = 0; trial < 5000; ++trial) {
        SharePoint points[4];
        const unsigned count = dice(random, points, trial % 2 == 0 ? 0 : 0.99);
        const Wrench wanted = wrenchOf(points, count);
        double most = 0;
        for (unsigned j = 0; j < count; ++j) most += kMu * points[j].normal;
        shareFriction(points, count, kMu, wanted.force, wanted.twist);
        const Wrench found = wrenchOf(points, count);
        for (int k = 0; k < 2; ++k) EXPECT_NEAR(found.force[k], wanted.force[k], 1e-6 * most) << trial;
        EXPECT_NEAR(found.twist, wanted.twist, 2e-6 * most) << trial;
    }
}

TEST(FrictionShare, NeverLeavesTheDiscs) {
    std::mt19937 random(2);
    for (int trial = 0; trial < 5000; ++trial) {
        SharePoint points[4];
        const unsigned count = dice(random, points, 0);
        Wrench wanted = wrenchOf(points, count);
        wanted.twist *= 3;
        shareFriction(points, count, kMu, wanted.force, wanted.twist);
        for (unsigned j = 0; j < count; ++j)
            EXPECT_LE(std::hypot(points[j].friction[0], points[j].friction[1]), (1 + 1e-12) * kMu * points[j].normal);
    }
}

TEST(FrictionShare, WhatBearsNothingHoldsNothing) {
    SharePoint points[2];
    points[0].x = 1, points[1].x = -1;
    const double friction[2] = {1, 0};
    shareFriction(points, 2, kMu, friction, 1);
    for (const SharePoint& p : points) EXPECT_EQ(std::hypot(p.friction[0], p.friction[1]), 0);
}

}  // namespace
}  // namespace ragtop::direct
