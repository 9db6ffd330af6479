#include "ragtop/fixed_stepper.h"

#include <gtest/gtest.h>

#include <limits>
#include <stdexcept>
#include <string>

namespace ragtop {
namespace {

TEST(FixedStepper, StepsAndRestAddUpToTheFrames) {
    constexpr double kStep = 1.0 / 64;  // exact, so that the sum is exact too
    FixedStepper stepper(kStep, 100);
    const double frames[] = {0.25 * kStep, 3.5 * kStep, 0, 1.25 * kStep, 0.125 * kStep, 7 * kStep};
    double time = 0, stepped = 0;
    for (const double frame : frames) {
        time += frame;
        for (const double dt : stepper.advance(frame)) {
            EXPECT_EQ(dt, kStep);
            stepped += dt;
        }
        EXPECT_EQ(stepped + stepper.blendFactor() * kStep, time);
        EXPECT_GE(stepper.blendFactor(), 0);
        EXPECT_LT(stepper.blendFactor(), 1);
    }
    EXPECT_EQ(stepper.dropped(), 0);
}

TEST(FixedStepper, SlowFramesDropWholeSteps) {
    constexpr double kStep = 1.0 / 64;
    FixedStepper stepper(kStep, 4);
    EXPECT_EQ(stepper.advance(10.25 * kStep).count(), 4);
    EXPECT_EQ(stepper.dropped(), 6 * kStep);
    EXPECT_EQ(stepper.blendFactor(), 0.25);
    EXPECT_EQ(stepper.advance(0.75 * kStep).count(), 1);
    EXPECT_EQ(stepper.blendFactor(), 0);
}

TEST(FixedStepper, ManyFramesDriftByRoundingsOnly) {
    FixedStepper stepper(1.0 / 60, 4);
    int steps = 0;
    constexpr int kFrames = 100000;
    for (int i = 0; i < kFrames; ++i) {
        steps += stepper.advance(1.0 / 144).count();
        ASSERT_LT(stepper.blendFactor(), 1);
    }
    // 100,000 frames of 1/144 s are 41666.67 steps; each addition is off by at most half an ulp of the step.
    EXPECT_EQ(steps, 41666);
    EXPECT_NEAR(stepper.blendFactor(), 2.0 / 3, kFrames * std::numeric_limits<double>::epsilon());
}

TEST(FixedStepper, NonsenseFramesCountAsZero) {
    FixedStepper stepper(1.0 / 60, 4);
    EXPECT_EQ(stepper.advance(-1).count(), 0);
    EXPECT_EQ(stepper.advance(std::numeric_limits<double>::quiet_NaN()).count(), 0);
    EXPECT_EQ(stepper.blendFactor(), 0);
    EXPECT_EQ(stepper.advance(std::numeric_limits<double>::infinity()).count(), 4);
    EXPECT_EQ(stepper.blendFactor(), 0);
}

TEST(FixedStepper, UnusableStepsAreNamed) {
    for (const double step :
         {0.0, -0.1, std::numeric_limits<double>::infinity(), std::numeric_limits<double>::quiet_NaN()}) {
        EXPECT_THROW(FixedStepper(step, 4), std::invalid_argument);
    }
    try {
        FixedStepper stepper(0.01, 0);
        FAIL();
    } catch (const std::invalid_argument& error) {
        EXPECT_NE(std::string(error.what()).find("maxSteps is 0"), std::string::npos);
    }
}

TEST(FixedStepper, BlendsBetweenTheLastTwoSteps) {
    constexpr double kStep = 1.0 / 64;
    WorldSettings settings;
    settings.gravity = {};
    World world(settings);
    const BodyId body = world.create(DynamicBody{.shape = Sphere{}, .linearVelocity = {64, 0, 0}});
    FixedStepper stepper(kStep, 4);
    for (const double dt : stepper.advance(1.5 * kStep)) {
        stepper.remember(world);
        world.step(dt);
    }
    // One metre per step, exactly: no force acts and the numbers are powers of two.
    EXPECT_NEAR(stepper.blended(world, body).position.x, 0.5, 1e-6);
    const BodyId newcomer = world.create(DynamicBody{.shape = Sphere{}, .position = {0, 50, 0}});
    EXPECT_EQ(stepper.blended(world, newcomer).position, (DVec3{0, 50, 0}));
    world.destroy(newcomer);
    const BodyId successor = world.create(DynamicBody{.shape = Sphere{}, .position = {0, 70, 0}});
    EXPECT_EQ(stepper.blended(world, successor).position, (DVec3{0, 70, 0}));
}

}  // namespace
}  // namespace ragtop
