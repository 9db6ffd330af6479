#include <gtest/gtest.h>

#include <cmath>

#include "world_support.h"

// Springs of a ball joint: the whole rotation, or twist and swing apart.
namespace ragtop::test {
namespace {

struct Held {
    World world;
    BodyId body{};
    JointId joint{};

    Held(SolverChoice solver, const BallDef& drives)
        : world([&] {
              WorldSettings settings = withoutGravity();
              settings.sleeping = false;
              settings.solver = solver;
              return settings;
          }()) {
        BodyDef def = bodyDef(Sphere{0.2f}, {});
        def.mass = MassProperties{1, {}, {{0.1f, 0, 0}, {0, 0.1f, 0}, {0, 0, 0.1f}}};
        body = world.create(def);
        BallDef ball = drives;
        ball.bodies.b = body;
        joint = world.create(JointDef(ball));
    }
};

/// Sag is τ/k, about the twist axis and across it.
TEST(BallDrive, SagsByItsOwnStiffnessAboutEachAxis) {
    for (const SolverChoice solver : {SolverChoice::iterative, SolverChoice::direct}) {
        BallDef drives;
        drives.spring = Spring{.stiffness = 200, .damping = 20};
        drives.twistSpring = Spring{.stiffness = 50, .damping = 10};
        drives.target = rotationAbout({0, 0, 1}, 0.4f);
        Held held(solver, drives);
        const Vec3 twistAxis = rotate(drives.target, {1, 0, 0});
        run(held.world, 3, kDt, [&] { held.world.applyTorque(held.body, 5.0f * twistAxis); });
        EXPECT_NEAR(asDouble(held.world.state(held.joint).coordinate), 0.1, 2e-3) << nameOf(solver);
        EXPECT_NEAR(asDouble(held.world.state(held.joint).swing), 0.4, 2e-3) << nameOf(solver);
        run(held.world, 3, kDt, [&] { held.world.applyTorque(held.body, {0, 0, 8}); });
        EXPECT_NEAR(asDouble(held.world.state(held.joint).swing), 0.44, 2e-3) << nameOf(solver);
        EXPECT_NEAR(asDouble(held.world.state(held.joint).coordinate), 0, 2e-3) << nameOf(solver);
    }
}

/// What follows a target that turns at the speed it is told lags by nothing, and feed-forward bears a load that is
/// known.
TEST(BallDrive, FollowsATurningTargetAndBearsAKnownLoad) {
    for (const SolverChoice solver : {SolverChoice::iterative, SolverChoice::direct}) {
        BallDef drives;
        drives.spring = Spring{.stiffness = 50, .damping = 10};
        Held held(solver, drives);
        drives.bodies.b = held.body;
        const double h = kDt;
        for (int i = 0; i < 240; ++i) {
            drives.target = rotationAbout({0, 1, 0}, static_cast<float>(0.5 * i * h));
            drives.targetSpeed = {0, 0.5f, 0};
            drives.feedForward = {0, 0, -3};
            held.world.setDef(held.joint, drives);
            held.world.applyTorque(held.body, {0, 0, 3});
            held.world.step(h);
        }
        // The target stands still within a step: half of it is what the body is ahead of it.
        EXPECT_NEAR(asDouble(held.world.state(held.joint).swing), 0.5 * 240 * h, 0.5 * h * 1.1) << nameOf(solver);
        EXPECT_NEAR(asDouble(held.world.angularVelocity(held.body).y), 0.5, 0.01) << nameOf(solver);
        EXPECT_NEAR(asDouble(held.world.pose(held.body).rotation.z), 0, 1e-3) << nameOf(solver);
    }
}

TEST(BallDrive, NeverExceedsItsTorque) {
    BallDef drives;
    drives.spring = Spring{.stiffness = 1e5f, .damping = 100};
    drives.twistSpring = Spring{.stiffness = 1e4f, .damping = 100};
    drives.target = rotationAbout(normalized(Vec3{1, 2, -1}), 2.5f);
    drives.maxSpringTorque = 3;
    Held held(SolverChoice::iterative, drives);
    double most = 0;
    run(held.world, 2, kDt, [&] { most = std::max(most, asDouble(length(held.world.state(held.joint).torque))); });
    EXPECT_LE(most, 3.001);
    EXPECT_GT(most, 2.9);
}

}  // namespace
}  // namespace ragtop::test
