#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <functional>
#include <stdexcept>
#include <vector>

#include "ragtop/vehicle.h"
#include "road.h"

namespace ragtop {
namespace {

/// A car drives, and is changed.
struct Drive : Road {
    Vehicle car;
    explicit Drive(const VehicleDef& def = hatchback(), float speed = 0)
        : Road(0, awake()), car(world, def, {.speed = speed}) {}
    double height() { return world.pose(car.chassis()).position.y; }
};

TEST(VehicleChange, TheSameDefinitionChangesNothing) {
    Drive changed, untouched;
    for (Drive* one : {&changed, &untouched}) {
        one->car.input.throttle = 1;
        run(one->world, 2);
    }
    for (int i = 0; i < 30; ++i) {
        changed.car.setDef(hatchback());
        run(changed.world, 0.1);
        run(untouched.world, 0.1);
        ASSERT_EQ(changed.world.hash(), untouched.world.hash()) << i;
    }
}

TEST(VehicleChange, KeepsTheMotion) {
    Drive drive(hatchback(), 20);
    drive.car.input.throttle = 0.4f;
    run(drive.world, 1);
    const Vec3 speed = drive.world.linearVelocity(drive.car.chassis());
    const Pose pose = drive.world.pose(drive.car.chassis());
    const float rpm = drive.car.telemetry().engine.rpm, spin = drive.car.telemetry().wheels[0].angularSpeed;
    const int gear = drive.car.telemetry().gear;
    VehicleDef def = hatchback();
    def.aerodynamics.dragArea = 2;
    def.wheels[0].suspension.frequency = 2;
    def.wheels[2].tire.lateralFriction = 0.5f;
    def.engine.inertia = 0.3f;
    drive.car.setDef(def);
    EXPECT_EQ(drive.world.linearVelocity(drive.car.chassis()), speed);
    EXPECT_EQ(drive.world.pose(drive.car.chassis()), pose);
    EXPECT_EQ(drive.car.telemetry().engine.rpm, rpm);
    EXPECT_EQ(drive.car.telemetry().wheels[0].angularSpeed, spin);
    EXPECT_EQ(drive.car.telemetry().gear, gear);
    EXPECT_EQ(drive.car.def().aerodynamics.dragArea, 2);
}

/// After a change the car ends where one made like that from the beginning does.
TEST(VehicleChange, EndsLikeACarMadeSo) {
    VehicleDef heavy = hatchback();
    heavy.chassis.mass = 1600;
    heavy.chassis.centerOfMass = Vec3{0, 0.5f, 0};
    heavy.chassis.inertia = Vec3{2000, 2300, 600};
    Drive changed, made(heavy);
    run(changed.world, 2);
    changed.car.setDef(heavy);
    run(changed.world, 5);
    run(made.world, 7);
    EXPECT_NEAR(changed.height(), made.height(), 1e-4);
    EXPECT_NEAR(totalLoad(changed.car), 1600 * kGravity, 1e-3f * 1600 * kGravity);
    for (std::size_t i = 0; i < 4; ++i) {
        EXPECT_NEAR(changed.car.telemetry().wheels[i].load, made.car.telemetry().wheels[i].load, 5);
        EXPECT_EQ(changed.car.staticLoads()[i], made.car.staticLoads()[i]);
    }
}

/// F = k x: with its compression given, a spring that is stiffer by a share s carries the load with x/(1 + s).
TEST(VehicleChange, StifferSpringsOfOneLengthLiftTheCar) {
    VehicleDef def = hatchback();
    const Drive plain;
    const auto loads = plain.car.staticLoads();
    constexpr float kCompression = 0.13f;
    for (std::size_t i = 0; i < def.wheels.size(); ++i) {
        def.wheels[i].suspension.springCompression = kCompression;
        def.wheels[i].suspension.stiffness = loads[i] / kCompression;
    }
    Drive drive(def);
    run(drive.world, 5);
    const double before = drive.height();
    EXPECT_NEAR(before, 0, 1e-3);
    for (WheelDef& wheel : def.wheels) *wheel.suspension.stiffness *= 1.3f;
    drive.car.setDef(def);
    run(drive.world, 5);
    EXPECT_NEAR(drive.height() - before, kCompression * (1 - 1 / 1.3), 2e-4);
    // And more mass presses it down: x = m g/k.
    def.chassis.mass *= 1.3f;
    drive.car.setDef(def);
    run(drive.world, 5);
    EXPECT_NEAR(drive.height(), before, 2e-4);
}

TEST(VehicleChange, FewerGearsAreShiftedInto) {
    Drive drive(hatchback(), 35);
    drive.car.input.throttle = 0.3f;
    run(drive.world, 1);
    ASSERT_GE(drive.car.telemetry().gear, 4);
    VehicleDef def = hatchback();
    def.gearbox.ratios.resize(2);
    drive.car.setDef(def);
    EXPECT_EQ(drive.car.telemetry().gear, 2);
    run(drive.world, 1);
    EXPECT_LE(drive.car.telemetry().gear, 2);
}

TEST(VehicleChange, DifferentialsComeAndGo) {
    Drive drive(hatchback(), 10);
    VehicleDef def = hatchback();
    for (const auto type : {DifferentialType::locked, DifferentialType::open, DifferentialType::limitedSlip}) {
        def.differential.type = type;
        drive.car.setDef(def);
        drive.car.input = {.throttle = 0.5f, .steer = 0.3f};
        run(drive.world, 1);
        const auto wheels = drive.car.telemetry().wheels;
        const float difference = std::abs(wheels[0].angularSpeed - wheels[1].angularSpeed);
        EXPECT_EQ(difference > 0.1f, type == DifferentialType::open) << difference;
    }
}

TEST(VehicleChange, ASleepingCarWakes) {
    Road road;
    Vehicle car(road.world, hatchback(), {});
    run(road.world, 10);
    ASSERT_FALSE(road.world.isAwake(car.chassis()));
    VehicleDef def = hatchback();
    def.wheels[0].position.y -= 0.03f;
    car.setDef(def);
    EXPECT_TRUE(road.world.isAwake(car.chassis()));
}

TEST(VehicleChange, WhatCannotBeIsRefused) {
    Drive drive(hatchback(), 5);
    const std::uint64_t before = drive.world.hash();
    const auto refused = [&](const std::function<void(VehicleDef&)>& change) {
        VehicleDef def = hatchback();
        change(def);
        EXPECT_THROW(drive.car.setDef(def), std::invalid_argument);
    };
    refused([](VehicleDef& def) { def.wheels.pop_back(); });
    refused([](VehicleDef& def) { def.wheels.push_back(def.wheels[0]); });
    refused([](VehicleDef& def) { def.chassis.shapes.pop_back(); });
    refused([](VehicleDef& def) { def.wheels[1].radius = 0.35f; });
    refused([](VehicleDef& def) { def.wheels[3].width = 0.25f; });
    refused([](VehicleDef& def) { def.wheels[0].suspension.axis = {0, 1, -0.1f}; });
    refused([](VehicleDef& def) { def.chassis.mass = -1; });
    refused([](VehicleDef& def) { def.wheels[0].suspension.springCompression = -1.0f; });
    refused([](VehicleDef& def) { def.engine.limiterRpm = 10; });
    EXPECT_EQ(drive.world.hash(), before);
    EXPECT_EQ(drive.car.def().wheels.size(), 4u);
    EXPECT_THROW(drive.car.place({.speed = NAN}), std::invalid_argument);
    EXPECT_EQ(drive.world.hash(), before);
}

/// A wheel collides as what the car was made with; another size would be one for the ground and another for walls.
TEST(VehicleChange, SaysWhichWheelKeepsItsShape) {
    Drive drive;
    VehicleDef def = hatchback();
    def.wheels[2].radius = 0.35f;
    try {
        drive.car.setDef(def);
        FAIL();
    } catch (const std::invalid_argument& error) {
        EXPECT_STREQ(error.what(),
                     "vehicle hatchback: /wheels/2/radius is 0.35, must stay 0.3, because its shape is made with the "
                     "car");
    }
}

/// A state means what it does under the definition that it was saved with: taken for another one's, it would go another
/// way. Nothing of it is taken, and under its own definition it is again.
TEST(VehicleChange, AStateOfAnotherDefinitionIsRefused) {
    Drive drive(hatchback(), 15);
    run(drive.world, 1);
    std::vector<std::byte> state(drive.world.saveSize());
    drive.world.save(state);
    run(drive.world, 1);
    const std::uint64_t later = drive.world.hash();
    VehicleDef def = hatchback();
    def.wheels[2].tire.lateralFriction = 0.5f;
    drive.car.setDef(def);
    const std::uint64_t before = drive.world.hash();
    try {
        drive.world.restore(state);
        FAIL();
    } catch (const std::invalid_argument& error) {
        EXPECT_STREQ(error.what(),
                     "the state of module 'vehicle' was saved under another definition, must be that of now");
    }
    EXPECT_EQ(drive.world.hash(), before);
    def = hatchback();
    def.name = "of another name";
    drive.car.setDef(def);
    drive.world.restore(state);
    run(drive.world, 1);
    EXPECT_EQ(drive.world.hash(), later);
}

/// A car that is put somewhere goes on like one made there.
TEST(VehicleChange, PlacedAnewItIsANewCar) {
    Drive moved(hatchback(), 15), made(hatchback(), 15);
    moved.car.input = {.throttle = 1, .steer = 1};
    run(moved.world, 3);
    moved.world.setVelocity(moved.car.chassis(), {1, 8, 0}, {3, 1, 5});
    run(moved.world, 1);
    moved.car.place({.position = {2, 0, 3}, .heading = 0, .speed = 15});
    moved.car.input = {};
    for (int i = 0; i < 120; ++i) {
        moved.world.step(kStep);
        made.world.step(kStep);
    }
    const DVec3 a = moved.world.pose(moved.car.chassis()).position, b = made.world.pose(made.car.chassis()).position;
    EXPECT_NEAR(a.x - 2, b.x, 1e-4);
    EXPECT_NEAR(a.y, b.y, 1e-4);
    EXPECT_NEAR(a.z - 3, b.z, 1e-3);
    EXPECT_EQ(moved.car.telemetry().gear, made.car.telemetry().gear);
}

}  // namespace
}  // namespace ragtop
