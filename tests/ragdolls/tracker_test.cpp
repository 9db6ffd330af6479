#include "ragtop/tracker.h"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>
#include <vector>

#include "core/heap_counter.h"
#include "human.h"
#include "ragtop/body_pose.h"
#include "ragtop/world.h"

namespace ragtop {
namespace {

/// A march in place, 0.8 steps a second, that bobs by 2 cm.
std::vector<Pose> stepping(double time) {
    const auto swing = static_cast<float>(std::sin(2 * M_PI * 0.8 * time));
    const float left = std::max(swing, 0.0f), right = std::max(-swing, 0.0f);
    const PartAngles pose[] = {{BodyRole::thigh, BodySide::left, 0.7f * left * left},
                               {BodyRole::shank, BodySide::left, 0.9f * left * left},
                               {BodyRole::thigh, BodySide::right, 0.7f * right * right},
                               {BodyRole::shank, BodySide::right, 0.9f * right * right},
                               {BodyRole::upperArm, BodySide::left, -0.4f * swing, 0.2f},
                               {BodyRole::upperArm, BodySide::right, 0.4f * swing, 0.2f}};
    return standing(BodyAxes(human()), {}, pose);
}

struct FollowedBody {
    World world;
    Ragdoll body;
    Muscles muscles;
    Tracker tracker;
    InverseDynamics dynamics;
    double time = 0;

    explicit FollowedBody(const TrackerOptions& options = {}, bool ground = true)
        : body(world, human(), stepping(0)),
          muscles(world, body, muscleProfile("rigid")),
          tracker(world, body, muscles, options),
          dynamics(world, body) {
        if (ground) world.create(StaticBody{.shape = Box{{100, 1, 100}}, .position = {0, -1, 0}});
        tracker.follow(stepping(-kDt), kDt);
        tracker.follow(stepping(0), kDt);
    }
    void step() {
        time += kDt;
        tracker.follow(stepping(time), kDt);
        muscles.step(kDt);
        world.step(kDt);
        dynamics.look();
    }
};

TEST(Tracker, FollowsAMarchToThreeDegrees) {
    FollowedBody walker;
    std::vector<double> squares(human().joints.size());
    int counted = 0;
    double helped = 0;
    for (int i = 0; i < 360; ++i) {
        walker.step();
        if (i < 60) continue;
        ++counted;
        helped += static_cast<double>(lengthSquared(walker.tracker.assistance().linear));
        for (std::size_t j = 0; j < squares.size(); ++j) {
            const double off = static_cast<double>(walker.muscles.error(static_cast<int>(j)));
            squares[j] += off * off;
        }
    }
    for (std::size_t j = 0; j < squares.size(); ++j)
        EXPECT_LT(std::sqrt(squares[j] / counted) * 180 / M_PI, 3) << human().parts[j + 1].name;
    // Feet bear some of the weight.
    const double weight = static_cast<double>(walker.dynamics.mass()) * 9.81;
    EXPECT_LT(std::sqrt(helped / counted), 0.95 * weight);
    EXPECT_GT(walker.dynamics.centerOfMass().y, 0.85);
}

/// What it is helped with keeps within its bounds and is all that acts: in the air the momentum changes by that and
/// gravity.
TEST(Tracker, TheAssistanceIsAllThatActs) {
    for (const float help : {0.0f, 0.5f}) {
        FollowedBody walker({.force = help, .torque = 0.5f * help}, false);
        walker.dynamics.look();
        const Vec3 before = walker.dynamics.velocity();
        const float mass = walker.dynamics.mass(), weight = 9.81f * mass;
        Vec3 push;
        for (int i = 0; i < 30; ++i) {
            walker.step();
            EXPECT_LE(length(walker.tracker.assistance().linear), help * weight * 1.0001f);
            push += static_cast<float>(kDt) * walker.tracker.assistance().linear;
        }
        const Vec3 gained = mass * (walker.dynamics.velocity() - before);
        const Vec3 expected = push - Vec3{0, 30 * static_cast<float>(kDt) * weight, 0};
        EXPECT_LT(length(gained - expected), 1e-3f * weight);
    }
}

TEST(Tracker, StepsWithoutMemory) {
    FollowedBody walker;
    for (int i = 0; i < 10; ++i) walker.step();
    const std::vector<Pose> next = stepping(walker.time + kDt);
    const long before = heapCalls();
    walker.tracker.follow(next, kDt);
    walker.muscles.step(kDt);
    EXPECT_EQ(heapCalls(), before);
}

TEST(Tracker, WhatIsWrongIsTold) {
    EXPECT_EQ(whyInvalid(TrackerOptions{.rate = 0}), "rate is 0 1/s, must be in [0.1, 60]");
    FollowedBody walker;
    EXPECT_THROW(Tracker(walker.world, walker.body, walker.muscles, {.force = -1}), std::invalid_argument);
    EXPECT_THROW(walker.tracker.follow({}, kDt), std::invalid_argument);
}

}  // namespace
}  // namespace ragtop
