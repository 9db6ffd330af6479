#include "ragtop/vehicle.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <stdexcept>
#include <variant>
#include <vector>

#include "road.h"

namespace ragtop {
namespace {

/// The hatchback with lengths × 4, masses × 64 and times × 2: accelerations stay, and every number only changes its
/// exponent.
VehicleDef enlarged() {
    VehicleDef def = hatchback();
    for (ChassisShape& part : def.chassis.shapes) {
        std::get<Box>(part.shape).halfExtents *= 4;
        part.frame.position *= 4;
    }
    def.chassis.mass *= 64;
    *def.chassis.centerOfMass *= 4;
    *def.chassis.inertia *= 1024;
    for (WheelDef& wheel : def.wheels) {
        wheel.position *= 4;
        wheel.radius *= 4;
        wheel.width *= 4;
        wheel.mass *= 64;
        wheel.brakeTorque *= 256;
        wheel.handbrakeTorque *= 256;
        wheel.suspension.travelUp *= 4;
        wheel.suspension.travelDown *= 4;
        wheel.suspension.frequency /= 2;
        wheel.tire.relaxationLength *= 4;
    }
    def.steering.rate /= 2;
    for (TorquePoint& point : def.engine.torqueCurve) {
        point.rpm /= 2;
        point.torque *= 256;
    }
    def.engine.inertia *= 1024;
    def.engine.idleRpm /= 2;
    def.engine.limiterRpm /= 2;
    def.engine.brakeTorque *= 256;
    def.gearbox.shiftUpRpm /= 2;
    def.gearbox.shiftDownRpm /= 2;
    def.gearbox.shiftTime *= 2;
    def.differential.preload *= 256;
    def.aerodynamics.dragArea *= 16;
    def.aerodynamics.liftArea *= 16;
    return def;
}

TEST(Vehicle, DrivesAlikeAtFourTimesTheSize) {
    World small, large;
    small.create(StaticBody{.shape = Box{{500, 1, 500}}, .position = {0, -1, 0}});
    large.create(StaticBody{.shape = Box{{2000, 4, 2000}}, .position = {0, -4, 0}});
    Vehicle car(small, hatchback(), {.position = {0, 0.25, 0}, .heading = 0.5f, .speed = 5});
    Vehicle lorry(large, enlarged(), {.position = {0, 1, 0}, .heading = 0.5f, .speed = 10});
    for (int i = 0; i < 600; ++i) {
        const float steer = i % 100 < 50 ? 0.5f : -0.3f;
        car.input = lorry.input = {.throttle = i < 400 ? 1.0f : 0.0f, .brake = i < 450 ? 0.0f : 0.8f, .steer = steer};
        small.step(kStep);
        large.step(2 * kStep);
        const Pose a = small.pose(car.chassis()), b = large.pose(lorry.chassis());
        ASSERT_EQ(4 * a.position.x, b.position.x) << i;
        ASSERT_EQ(4 * a.position.y, b.position.y) << i;
        ASSERT_EQ(4 * a.position.z, b.position.z) << i;
        ASSERT_EQ(a.rotation, b.rotation) << i;
        ASSERT_EQ(car.telemetry().engine.rpm, 2 * lorry.telemetry().engine.rpm) << i;
    }
}

TEST(Vehicle, SavesAndRestoresToTheSameBits) {
    Road road;
    Vehicle car(road.world, hatchback());
    car.input = {.throttle = 0.7f, .steer = 0.3f};
    run(road.world, 3);
    std::vector<std::byte> state(road.world.saveSize());
    road.world.save(state);
    run(road.world, 2);
    const auto hash = road.world.hash();
    const Pose pose = road.world.pose(car.chassis());
    const float rpm = car.telemetry().engine.rpm;
    car.input = {.brake = 1};
    run(road.world, 1);
    EXPECT_NE(road.world.hash(), hash);
    road.world.restore(state);
    EXPECT_EQ(car.input.throttle, 0.7f);
    run(road.world, 2);
    EXPECT_EQ(road.world.hash(), hash);
    EXPECT_EQ(road.world.pose(car.chassis()), pose);
    EXPECT_EQ(car.telemetry().engine.rpm, rpm);
}

TEST(Vehicle, SleepsWhenParkedAndWakesForTheDriver) {
    Road road(0.1f);
    Vehicle car(road.world, hatchback());
    road.world.setPose(car.chassis(), {{}, road.tilt});
    car.input.handbrake = 1;
    run(road.world, 20);
    EXPECT_FALSE(road.world.isAwake(car.chassis()));
    const Pose parked = road.world.pose(car.chassis());
    run(road.world, 1);
    EXPECT_EQ(road.world.pose(car.chassis()), parked);
    car.input.handbrake = 0;
    run(road.world, 0.1);
    EXPECT_TRUE(road.world.isAwake(car.chassis()));
    EXPECT_LT(car.telemetry().speed, -0.02f);
}

TEST(Vehicle, LivesBesideOthersAndMovesInMemory) {
    Road road;
    std::vector<Vehicle> cars;
    for (int i = 0; i < 5; ++i)
        cars.emplace_back(road.world, hatchback(), VehiclePlacement{.position = {4.0 * i, 0, 0}});
    for (Vehicle& car : cars) car.input.throttle = 0.5f;
    run(road.world, 2);
    for (const Vehicle& car : cars) EXPECT_NEAR(car.telemetry().speed, cars[0].telemetry().speed, 0.01f);
    EXPECT_GT(cars[0].telemetry().speed, 1);
    const BodyId chassis = cars.back().chassis();
    cars.pop_back();
    EXPECT_FALSE(road.world.isValid(chassis));
    run(road.world, 1);
}

TEST(Vehicle, RejectsABadDefinition) {
    World world;
    VehicleDef def = hatchback();
    def.wheels[1].radius = -0.3f;
    try {
        Vehicle car(world, def);
        FAIL();
    } catch (const std::invalid_argument& error) {
        EXPECT_STREQ(error.what(), "vehicle hatchback: /wheels/1/radius is -0.3 m, must be in [0.001, 1000]");
    }
    EXPECT_TRUE(world.bodies().empty());
}

/// Inputs beyond their range, or that are no numbers, count as the nearest that is allowed or as none.
TEST(Vehicle, SurvivesAnyInput) {
    Road road;
    Vehicle car(road.world, hatchback());
    const float nan = std::nanf("");
    car.input = {.throttle = nan, .brake = -3, .steer = 1e30f, .handbrake = nan, .clutch = 7, .gear = -50};
    run(road.world, 2);
    EXPECT_TRUE(isFinite(road.world.pose(car.chassis()).position));
    EXPECT_EQ(car.telemetry().gear, -1);
}

}  // namespace
}  // namespace ragtop
