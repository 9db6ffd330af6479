#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "road.h"

namespace ragtop {
namespace {

TEST(Vehicle, StandsWithTheLoadsOfTheLeverLaw) {
    Road road(0, awake());
    Vehicle car(road.world, hatchback());
    car.input.handbrake = 1;
    run(road.world, 5);
    const auto wheels = car.telemetry().wheels;
    const VehicleDef def = hatchback();
    const float weight = def.chassis.mass * kGravity;
    EXPECT_NEAR(totalLoad(car), weight, 1e-4f * weight);
    const float front = weight * (1.26f + def.chassis.centerOfMass->z) / kHatchbackWheelbase;
    EXPECT_NEAR(wheels[0].load + wheels[1].load, front, 1e-3f * weight);
    for (std::size_t i = 0; i < 4; ++i) {
        EXPECT_TRUE(wheels[i].grounded);
        EXPECT_NEAR(wheels[i].compression, 0, 1e-4);
        EXPECT_NEAR(wheels[i].load, car.staticLoads()[i], 1e-3f * weight);
    }
    EXPECT_NEAR(road.world.pose(car.chassis()).position.y, 0, 1e-4);
}

/// A 20 % slope, braked, any heading and rate: after it has settled the car stays within a millimetre.
TEST(Vehicle, HoldsOnASlopeForGood) {
    for (const double dt : {1.0 / 30, 1.0 / 60, 1.0 / 120}) {
        for (const float heading : {0.0f, 0.25f * kPi, 0.5f * kPi, kPi}) {
            Road road(0.2f, awake());
            Vehicle car(road.world, plainTires(1), {.position = {}, .heading = heading});
            road.world.setPose(car.chassis(), {{}, road.tilt * rotationAbout({0, 1, 0}, heading)});
            car.input.brake = 1;
            run(road.world, 5, dt);
            const DVec3 from = road.world.pose(car.chassis()).position;
            run(road.world, 20, dt);
            const Vec3 drift = relative(road.world.pose(car.chassis()).position, from);
            EXPECT_LT(length(drift), 1e-3f) << heading << " " << dt;
            EXPECT_LT(length(road.world.linearVelocity(car.chassis())), 1e-4f) << heading << " " << dt;
        }
    }
}

TEST(Vehicle, SlidesOnceTheSlopeExceedsFriction) {
    for (const float friction : {0.51f, 0.49f}) {
        Road road(0.5f, awake());
        VehicleDef def = plainTires(friction);
        for (WheelDef& wheel : def.wheels) wheel.brakeTorque = 1e5f;
        Vehicle car(road.world, def);
        road.world.setPose(car.chassis(), {{}, road.tilt});
        car.input.brake = 1;
        run(road.world, 6);
        const float speed = std::abs(car.telemetry().speed);
        if (friction > 0.5f) {
            EXPECT_LT(speed, 1e-3f);
        } else {
            EXPECT_GT(speed, 0.1f);
        }
    }
}

TEST(Vehicle, RollsAsSoonAsTheBrakeIsReleased) {
    Road road(0.2f);
    Vehicle car(road.world, plainTires(1));
    road.world.setPose(car.chassis(), {{}, road.tilt});
    car.input = {.brake = 1, .gear = 0};
    run(road.world, 5);
    car.input.brake = 0;
    run(road.world, 2 * kStep);
    EXPECT_LT(car.telemetry().speed, -0.01f);
}

/// Bounce of a car with equal springs under its centre of mass, so that it does not pitch.
TEST(Vehicle, BouncesAtTheFrequencyOfItsSprings) {
    VehicleDef def = plainTires(1);
    def.chassis.centerOfMass = Vec3{0, 0.5f, 0};
    for (WheelDef& wheel : def.wheels) {
        wheel.suspension.frequency = 1.25f;
        wheel.suspension.dampingRatio = 0;
    }
    Road road(0, awake());
    Vehicle car(road.world, def, {.position = {0, 0.02, 0}});
    car.input.gear = 0;
    std::vector<double> crossings;
    double before = 0.02;
    for (int i = 0; i < 600; ++i) {
        road.world.step(kStep);
        const double height = road.world.pose(car.chassis()).position.y;
        if (before < 0 && height >= 0) crossings.push_back((i + before / (before - height)) * kStep);
        before = height;
    }
    ASSERT_GE(crossings.size(), 3u);
    EXPECT_NEAR(crossings[2] - crossings[1], 1 / 1.25, 0.02 / 1.25);
}

/// Falling from a few radii up: it lands, bounces, and comes to rest on its wheels at any rate.
TEST(Vehicle, LandsOnItsWheels) {
    for (const double dt : {1.0 / 30, 1.0 / 60, 1.0 / 240}) {
        Road road(0, awake());
        Vehicle car(road.world, hatchback(), {.position = {0, 2, 0}});
        car.input.brake = 1;
        EXPECT_FALSE(car.telemetry().wheels[0].grounded);
        run(road.world, 8, dt);
        const float weight = 1200 * kGravity;
        EXPECT_NEAR(totalLoad(car), weight, 1e-3f * weight) << dt;
        EXPECT_NEAR(road.world.pose(car.chassis()).position.y, 0, 1e-3) << dt;
    }
}

/// A light brick between a wheel and the ground carries the car as a fixed one does, to a tenth of its height, and is
/// not shot away.
TEST(Vehicle, StandsOnALightBrickAsOnAFixedOne) {
    const float half = 0.04f;
    const Box shape{{0.12f, half, 0.12f}};
    double height[2];
    for (const bool light : {false, true}) {
        Road road(0, awake());
        const DVec3 place{0.74, 0.04, 1.26};
        BodyId brick;
        if (light) {
            brick = road.world.create(DynamicBody{.shape = shape, .density = 1085, .position = place});
            EXPECT_NEAR(road.world.mass(brick).mass, 5, 0.01);
        } else {
            brick = road.world.create(StaticBody{.shape = shape, .position = place});
        }
        Vehicle car(road.world, hatchback(), {.position = {0, 0.1, 0}});
        car.input.brake = 1;
        run(road.world, 10);
        EXPECT_EQ(car.telemetry().wheels[0].ground, brick);
        height[light ? 1 : 0] = car.telemetry().wheels[0].pose.position.y;
    }
    EXPECT_NEAR(height[0], 0.30 + 2 * half, 2e-3);
    EXPECT_NEAR(height[1], height[0], 0.1 * 2 * half);
}

/// A curb of a third of the radius: the hub never moves faster than the wheel rolls, at walking and driving pace.
TEST(Vehicle, ClimbsACurbOnAContinuousPath) {
    for (const float speed : {1.5f, 5.0f, 15.0f}) {
        Road road(0, awake());
        road.world.create(StaticBody{.shape = Box{{20, 0.05f, 200}}, .position = {0, 0.05, 205}});
        Vehicle car(road.world, hatchback(), {.position = {}, .speed = speed});
        double before = 0.3, fastest = 0;
        const int steps = static_cast<int>(10 / (static_cast<double>(speed) * kStep));
        for (int i = 0; i < steps; ++i) {
            const float lacking = speed - car.telemetry().speed;
            road.world.applyForce(car.chassis(), {0, 0, 6000 * lacking}, road.world.centerOfMass(car.chassis()));
            road.world.step(kStep);
            const double now = car.telemetry().wheels[0].pose.position.y;
            fastest = std::max(fastest, std::abs(now - before) / kStep);
            before = now;
        }
        EXPECT_GT(road.world.pose(car.chassis()).position.y, 0.08) << speed;
        EXPECT_LT(fastest, 1.5 * static_cast<double>(speed) + 0.5) << speed;
    }
}

/// A trailer without brakes pulls at the braked car; what the joint does to it counts like gravity.
TEST(Vehicle, HoldsATrailerOnASlope) {
    Road road(0.2f, awake());
    Vehicle car(road.world, plainTires(1));
    road.world.setPose(car.chassis(), {{}, road.tilt});
    const auto trailer = road.world.create(DynamicBody{.shape = Box{{0.8f, 0.5f, 1.2f}},
                                                       .density = 120,
                                                       .position = DVec3(rotate(road.tilt, {0, 0.5f, -4})),
                                                       .rotation = road.tilt,
                                                       .material = {.friction = 0}});
    BallDef hitch;
    hitch.bodies = {.a = car.chassis(), .b = trailer, .frameA = {{0, 0.5f, -2.3f}, {}}, .frameB = {{0, 0, 1.7f}, {}}};
    road.world.create(JointDef(hitch));
    car.input.brake = 1;
    run(road.world, 10);
    const DVec3 from = road.world.pose(car.chassis()).position;
    run(road.world, 20);
    EXPECT_LT(length(relative(road.world.pose(car.chassis()).position, from)), 1e-3f);
    car.input = {.gear = 0};
    run(road.world, 2 * kStep);
    EXPECT_LT(road.world.linearVelocity(trailer).z, -0.01f);
}

/// Parked and asleep on a platform that starts, turns and stops: the car goes with it, and falls when it is gone.
TEST(Vehicle, RidesAMovingPlatform) {
    World world;
    const auto platform = world.create(BodyDef{.type = BodyType::kinematic,
                                               .shapes = {ShapeDef{.geometry = Box{{10, 0.5f, 10}}}},
                                               .pose = {{0, -0.5, 0}, {}}});
    Vehicle car(world, hatchback());
    car.input.brake = 1;
    run(world, 3);
    EXPECT_FALSE(world.isAwake(car.chassis()));
    for (int i = 0; i < 600; ++i) {
        const float t = static_cast<float>(i * kStep);
        world.setVelocity(platform, {0.2f * t * (10 - t) / 10, 0, 0.5f * t * (10 - t) / 25}, {0, 0.1f, 0});
        world.step(kStep);
    }
    world.setVelocity(platform, {}, {});
    run(world, 3);
    const Vec3 place = relative(world.pose(platform), world.pose(car.chassis())).position;
    EXPECT_LT(length(place - Vec3{0, 0.5f, 0}), 0.01f);
    EXPECT_FALSE(world.isAwake(car.chassis()));
    world.destroy(platform);
    run(world, 0.5);
    EXPECT_LT(world.pose(car.chassis()).position.y, -1);
}

/// At 300 km/h over a field of 1.7 m cells the loads stay what they are at rest, but for the moment of the rolling
/// resistance.
TEST(Vehicle, FeelsNoSeamsAtSpeed) {
    const std::vector<float> heights(64 * 800, 0.0f);
    World world;
    world.create(StaticBody{.shape = HeightField(64, 800, 1.7f, heights), .position = {-50, 0, -100}});
    VehicleDef def = plainTires(1);
    Vehicle car(world, def, {.position = {0.3, 0, 0}, .speed = 300 / 3.6f});
    car.input.gear = 0;
    run(world, 2);
    for (int i = 0; i < 480; ++i) {
        world.step(kStep);
        ASSERT_NEAR(car.telemetry().wheels[0].load, car.staticLoads()[0], 0.01f * car.staticLoads()[0]) << i;
    }
    EXPECT_NEAR(car.telemetry().speed, 300 / 3.6f, 0.01f);
}

/// A plate on ice: what the car pushes off with, the plate gets with the opposite sign.
TEST(Vehicle, PushesTheGroundBack) {
    World world(awake());
    world.create(StaticBody{.shape = Box{{50, 1, 50}}, .position = {0, -2, 0}, .material = {.friction = 0}});
    const auto plate = world.create(DynamicBody{
        .shape = Box{{5, 0.5f, 20}}, .density = 100, .position = {0, -0.5, 0}, .material = {.friction = 0.6f}});
    Vehicle car(world, plainTires(1));
    run(world, 2);
    car.input.throttle = 0.5f;
    run(world, 2);
    const float carMomentum = 1200 * dot(world.linearVelocity(car.chassis()), {0, 0, 1});
    const float plateMomentum = world.mass(plate).mass * dot(world.linearVelocity(plate), {0, 0, 1});
    EXPECT_GT(carMomentum, 1000);
    EXPECT_NEAR(carMomentum, -plateMomentum, 1e-3f * carMomentum);
}

}  // namespace
}  // namespace ragtop
