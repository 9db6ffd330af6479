#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <random>
#include <string>
#include <utility>

#include "road.h"

namespace ragtop {
namespace {

/// All wheels locked: v²/(2 μ g), whatever the load transfer, once the tires have wound up.
TEST(Vehicle, StopsInTheDistanceOfFriction) {
    for (const float friction : {1.0f, 0.5f}) {
        for (const double dt : {1.0 / 30, 1.0 / 60, 1.0 / 120}) {
            VehicleDef def = plainTires(friction);
            for (WheelDef& wheel : def.wheels) wheel.brakeTorque = 1e5f;
            const float speed = 100 / 3.6f;
            Road road;
            Vehicle car(road.world, def, {.position = {0, 0, -500}, .heading = 0, .speed = speed});
            run(road.world, 0.5, dt);
            const double v = car.telemetry().speed;
            const double from = road.world.pose(car.chassis()).position.z;
            car.input = {.brake = 1, .clutch = 1};
            run(road.world, 10, dt);
            const double distance = road.world.pose(car.chassis()).position.z - from;
            EXPECT_NEAR(distance, v * v / (2 * static_cast<double>(friction * kGravity)), 0.02 * distance) << dt;
            EXPECT_NEAR(road.world.pose(car.chassis()).position.x, 0, 0.05);
        }
    }
}

/// A pedal as a function of the slip ratio of the wheel that slips most.
using Foot = std::function<float(float slip)>;

double brakingDistance(const VehicleDef& def, const Material& ground, const Foot& pedal, double from = 100 / 3.6) {
    World world;
    world.create(StaticBody{.shape = Box{{2000, 1, 2000}}, .position = {0, -1, 0}, .material = ground});
    Vehicle car(world, def, {.position = {0, 0, -1500}, .speed = static_cast<float>(from)});
    car.input.clutch = 1;
    run(world, 0.5);
    const double v = car.telemetry().speed, start = world.pose(car.chassis()).position.z;
    for (int i = 0; i < 6000 && car.telemetry().speed > 0.01f; ++i) {
        float slip = 0;
        for (const WheelTelemetry& wheel : car.telemetry().wheels) slip = std::min(slip, wheel.slipRatio);
        car.input.brake = pedal(slip);
        world.step(kStep);
    }
    return (world.pose(car.chassis()).position.z - start) * (from / v) * (from / v);
}

float stamp(float) { return 1; }

/// Ice has a twelfth of the grip: a locked car brakes with slidingShare μ times that, and so it does by its table.
TEST(Vehicle, BrakesOnIceAsTheSurfaceSays) {
    VehicleDef def = plainTires(1);
    for (WheelDef& wheel : def.wheels) {
        wheel.brakeTorque = 1e5f;
        wheel.tire.slidingShare = 0.8f;
        wheel.tire.surfaces = {{.surface = 1, .grip = 0.1f}};
    }
    const double speed = 10;
    const auto expected = [&](double grip) { return speed * speed / (2 * 0.8 * grip * 9.81); };
    const double ice = expected(0.05 / 0.6);
    EXPECT_NEAR(brakingDistance(def, {.friction = 0.05f}, stamp, speed), ice, 0.02 * ice);
    EXPECT_NEAR(brakingDistance(def, {.friction = 0.6f, .surface = 1}, stamp, speed), expected(0.1),
                0.02 * expected(0.1));
}

/// The best of feet that keep the tires where they just slide stops within what friction at its largest allows; locked
/// wheels need 1/slidingShare as far.
TEST(Vehicle, BrakesBetterThanLockedByWhatSlidingLoses) {
    VehicleDef def = plainTires(1);
    // Hardly any pitching, and rear brakes that follow the loads, so that all wheels are at their best at once.
    def.chassis.centerOfMass = Vec3{0, 0.02f, 0};
    for (WheelDef& wheel : def.wheels) {
        wheel.brakeTorque = wheel.axle == 0 ? 1500.0f : 1425.0f;
        wheel.tire.slidingShare = 0.8f;
    }
    const float most = def.chassis.mass * kGravity / 4 * def.wheels[0].radius / 1500;
    double best = 1000;
    for (const float aim : {0.14f, 0.155f, 0.17f, 0.18f}) {
        for (const float gain : {2.0f, 3.0f, 4.0f}) {
            const auto foot = [&](float slip) { return most * (1 + gain * (slip + aim)); };
            best = std::min(best, brakingDistance(def, {}, foot));
        }
    }
    EXPECT_NEAR(brakingDistance(def, {}, stamp) / best, 1 / 0.8, 0.02 / 0.8);
}

/// Loads that sway as it settles do not let its treads go. The way is that of a minute.
TEST(Vehicle, StandsAtNineTenthsOfWhatItsTiresHold) {
    constexpr float kSlope = 0.45f;
    for (int k = 0; k < 16; ++k) {
        Road road(kSlope, awake());
        Vehicle car(road.world, plainTires(0.5f), {.position = {0, 0, 0}});
        const Quat heading = rotationAbout({0, 1, 0}, static_cast<float>(k) * kPi / 8);
        road.world.setPose(car.chassis(), {{}, road.tilt * heading});
        car.input = {.brake = 1, .clutch = 1};
        run(road.world, 5, kStep);
        const DVec3 stood = road.world.pose(car.chassis()).position;
        run(road.world, 60, kStep);
        EXPECT_LT(length(relative(road.world.pose(car.chassis()).position, stood)), 1e-4f) << k;
    }
}

/// Rolling down freely: m g sin θ on the mass and the wheels' inertia, I/r² each.
TEST(Vehicle, RollsDownhillWithTheInertiaOfItsWheels) {
    const float slope = 0.1f;
    Road road(slope, awake());
    const VehicleDef def = plainTires(1);
    Vehicle car(road.world, def, {.position = {0, 0, 0}});
    road.world.setPose(car.chassis(), {{}, road.tilt});
    car.input.gear = 0;
    run(road.world, 2);
    const float before = car.telemetry().speed;
    run(road.world, 2);
    const double spinning = 4 * 0.75 * static_cast<double>(def.wheels[0].mass);
    const double mass = static_cast<double>(def.chassis.mass);
    const double expected = -static_cast<double>(kGravity) * std::sin(std::atan(0.1)) * mass / (mass + spinning);
    EXPECT_NEAR((car.telemetry().speed - before) / 2, expected, 0.005 * std::abs(expected));
}

TEST(Vehicle, DrivesATopGearAtItsRatio) {
    Road road;
    VehicleDef def = plainTires(1);
    def.gearbox.automatic = false;
    Vehicle car(road.world, def, {.position = {0, 0, -1500}, .speed = 30});
    car.input = {.throttle = 0.1f, .gear = 5};
    run(road.world, 3);
    const float axle = 0.5f * (car.telemetry().wheels[0].angularSpeed + car.telemetry().wheels[1].angularSpeed);
    const float ratio = def.gearbox.ratios.back() * def.gearbox.finalDrive;
    EXPECT_NEAR(car.telemetry().engine.rpm, axle * ratio * 30 / kPi, 1e-3f * car.telemetry().engine.rpm);
    EXPECT_NEAR(car.telemetry().speed, axle * def.wheels[0].radius, 0.005f * car.telemetry().speed);
}

/// Slow circle: the tires hardly slip and the car turns about the point that its wheels agree on, ω = v tan δ/L with v
/// of the middle of the rear axle.
TEST(Vehicle, CirclesSlowlyAboutTheAckermannPoint) {
    const float angle = 0.3f;
    Road road;
    VehicleDef def = plainTires(1);
    def.steering.maxAngle = angle;
    Vehicle car(road.world, def, {.position = {}, .speed = 2});
    for (const float steer : {-1.0f, 1.0f}) {
        car.input = {.steer = steer, .gear = 0};
        for (int i = 0; i < 240; ++i) {
            car.input.throttle = 0;
            const Vec3 forward = rotate(road.world.pose(car.chassis()).rotation, {0, 0, 1});
            road.world.applyForce(car.chassis(), 2000 * (2 - car.telemetry().speed) * forward,
                                  road.world.centerOfMass(car.chassis()));
            road.world.step(kStep);
        }
        const Pose pose = road.world.pose(car.chassis());
        const Vec3 rear = road.world.velocityAt(car.chassis(), transformPoint(pose, {0, 0.3f, -1.26f}));
        const float v = dot(rear, rotate(pose.rotation, {0, 0, 1}));
        const float yaw = road.world.angularVelocity(car.chassis()).y;
        EXPECT_NEAR(yaw, -steer * v * std::tan(angle) / kHatchbackWheelbase, 0.03f * std::abs(yaw));
        EXPECT_GT(v, 1);
    }
}

/// Linear bicycle car: yaw gain V/(L + K V²) with K = (1/C_f − 1/C_r)/g for stiffnesses proportional to load. The brush
/// loses a share C α/(3 μ) of its stiffness, below 1 % at 0.03 g.
TEST(Vehicle, UndersteersByItsTireStiffnesses) {
    const float front = 12, rear = 16, speed = 20, angle = 0.0025f;
    VehicleDef def = plainTires(1);
    for (WheelDef& wheel : def.wheels) wheel.tire.corneringStiffness = wheel.axle == 0 ? front : rear;
    def.steering.maxAngle = angle;
    Road road;
    Vehicle car(road.world, def, {.position = {}, .speed = speed});
    car.input = {.steer = 1, .gear = 0};
    run(road.world, 4);
    const float v = car.telemetry().speed;
    const float K = (1 / front - 1 / rear) / kGravity;
    const float expected = -angle * v / (kHatchbackWheelbase + K * v * v);
    EXPECT_NEAR(road.world.angularVelocity(car.chassis()).y, expected, 0.02f * std::abs(expected));
}

TEST(Vehicle, AcceleratesAsItsPowerAllows) {
    Road road;
    Vehicle car(road.world, hatchback(), {.position = {0, 0, -1500}});
    car.input = {.throttle = 1};
    double time = 0;
    while (car.telemetry().speed < 100 / 3.6f && time < 30) {
        road.world.step(kStep);
        time += kStep;
    }
    RecordProperty("zeroToHundred", std::to_string(time));
    // Energy alone: ½ m v² at the engine's largest power is a bound from below.
    float power = 0;
    for (const TorquePoint& p : hatchback().engine.torqueCurve) power = std::max(power, p.rpm * p.torque * kPi / 30);
    EXPECT_GT(time, 0.5 * 1200 * 27.78 * 27.78 / static_cast<double>(power));
    EXPECT_LT(time, 14);
}

TEST(Vehicle, AcceleratesAlikeAtAnyRate) {
    double distance[3];
    int k = 0;
    for (const double dt : {1.0 / 30, 1.0 / 60, 1.0 / 240}) {
        Road road;
        VehicleDef def = plainTires(1);
        def.gearbox.shiftTime = 0;
        Vehicle car(road.world, def, {.position = {0, 0, -500}, .speed = 15});
        car.input = {.throttle = 1, .gear = 2};
        run(road.world, 4, dt);
        distance[k++] = road.world.pose(car.chassis()).position.z + 500;
    }
    EXPECT_NEAR(distance[0], distance[2], 0.01 * distance[2]);
    EXPECT_NEAR(distance[1], distance[2], 0.005 * distance[2]);
}

TEST(Vehicle, ReversesInReverseGear) {
    Road road;
    Vehicle car(road.world, hatchback());
    run(road.world, 1);
    car.input = {.throttle = 0.5f, .gear = -1};
    run(road.world, 3);
    EXPECT_LT(car.telemetry().speed, -1);
    EXPECT_EQ(car.telemetry().gear, -1);
}

TEST(Vehicle, SpinsItsWheelsWithoutGripAndGoesNowhereFast) {
    World world;
    world.create(StaticBody{.shape = Box{{200, 1, 200}}, .position = {0, -1, 0}, .material = {.friction = 0.003f}});
    Vehicle car(world, hatchback());
    car.input.throttle = 1;
    run(world, 5);
    EXPECT_LT(car.telemetry().speed, 5);
    EXPECT_GT(car.telemetry().wheels[0].slipRatio, 0.5f);
}

/// Tread and contact point sway by the 5 mm/s of the push at most, each, and slip is told over 1 m/s at least.
TEST(Vehicle, HardlySlipsWhileItStands) {
    for (const float slope : {0.0f, 0.1f}) {
        for (const float brake : {0.0f, 1.0f}) {
            if (slope > 0 && brake == 0) continue;
            Road road(slope, awake());
            Vehicle car(road.world, hatchback());
            road.world.setPose(car.chassis(), {{}, road.tilt});
            car.input = {.brake = brake, .gear = 0};
            run(road.world, 5);
            road.world.setVelocity(car.chassis(), rotate(road.tilt, {0.003f, 0, 0.004f}), {});
            for (int i = 0; i < 120; ++i) {
                road.world.step(kStep);
                for (const WheelTelemetry& wheel : car.telemetry().wheels) {
                    ASSERT_LT(std::abs(wheel.slipRatio), 0.01f) << "step " << i;
                    ASSERT_LT(std::abs(wheel.slipAngle), 0.01f) << "step " << i;
                }
            }
        }
    }
}

TEST(Vehicle, TellsThatAWheelIsLocked) {
    Road road;
    Vehicle car(road.world, hatchback(), {.speed = 20});
    car.input = {.handbrake = 1};
    run(road.world, 0.5);
    for (const int i : {2, 3}) EXPECT_EQ(car.telemetry().wheels[static_cast<std::size_t>(i)].slipRatio, -1);
}

VehicleDef winged(float area) {
    VehicleDef def = hatchback();
    def.aerodynamics.dragArea = 0;
    def.aerodynamics.liftArea = area;
    return def;
}

/// Lift acts across the flow. Along it there is none, so that a car that falls straight down falls freely.
TEST(Vehicle, WingsDoNotPullDownWhatFalls) {
    World world;
    Vehicle car(world, winged(-50), {.position = {0, 1000, 0}});
    run(world, 2);
    EXPECT_NEAR(world.linearVelocity(car.chassis()).y, -2 * kGravity, 1e-4f * 2 * kGravity);
}

/// And it takes no power, however strong it is.
TEST(Vehicle, WingsTurnTheFlightAndKeepItsSpeed) {
    for (const float area : {-3.0f, 3.0f, 1e3f, 1e6f}) {
        World world;
        world.setSettings({.gravity = {0, 0, 0}});
        Vehicle car(world, winged(area), {.position = {0, 1000, 0}, .speed = 50});
        run(world, 2);
        EXPECT_NEAR(length(world.linearVelocity(car.chassis())), 50, 1e-3f) << area;
        EXPECT_GT(area * world.linearVelocity(car.chassis()).y, 0) << area;
    }
}

TEST(Vehicle, IsPressedDownByItsWings) {
    Road road;
    const float area = -3;
    Vehicle car(road.world, winged(area), {.position = {0, 0, -500}, .speed = 50});
    run(road.world, 4);
    const float speed = car.telemetry().speed, pressed = 0.5f * 1.2f * -area * speed * speed;
    EXPECT_NEAR(totalLoad(car), 1200 * kGravity + pressed, 2e-3f * pressed);
}

/// A kart: wheels so light that a tire answers a hundred times what turns them.
VehicleDef lockedKart(VehicleLevel level) {
    VehicleDef def = hatchback();
    def.level = level;
    def.chassis.shapes = {{Box{{0.45f, 0.08f, 0.7f}}, {{0, 0.2f, 0}, {}}}};
    def.chassis.mass = 150;
    def.chassis.centerOfMass = Vec3{0, 0.25f, -0.05f};
    def.chassis.inertia = Vec3{22, 45, 24};
    def.differential.type = DifferentialType::locked;
    for (TorquePoint& point : def.engine.torqueCurve) point.torque *= 0.12f;
    def.engine.inertia *= 0.12f;
    def.engine.brakeTorque *= 0.12f;
    for (WheelDef& wheel : def.wheels) {
        wheel.position = {0.75f * wheel.position.x, 0.13f, 0.42f * wheel.position.z};
        wheel.radius = wheel.width = 0.13f;
        wheel.mass = 1.5f;
        wheel.brakeTorque = wheel.handbrakeTorque = 100;
        wheel.driveShare = wheel.axle == 1 ? 1.0f : 0.0f;
        wheel.suspension = {.travelUp = 0.015f, .travelDown = 0.015f, .frequency = 6};
        wheel.tire.relaxationLength = 0.13f;
    }
    return def;
}

TEST(VehicleDriving, LightWheelsOnALockedAxleLandWithoutTurning) {
    for (const VehicleLevel level : {VehicleLevel::rays, VehicleLevel::full}) {
        for (const double dt : {1.0 / 30, 1.0 / 60, 1.0 / 120}) {
            Road road;
            Vehicle car(road.world, lockedKart(level), {.position = {0, 0.6, 0}, .heading = 0.8f});
            car.input.gear = 0;
            for (double t = 0; t < 1.5; t += dt) {
                road.world.step(dt);
                for (const WheelTelemetry& wheel : car.telemetry().wheels)
                    ASSERT_LT(std::abs(wheel.angularSpeed), 2) << static_cast<int>(level) << " " << t << " at " << dt;
            }
        }
    }
}

/// What is alike on both sides goes straight.
TEST(VehicleDriving, LightWheelsOnALockedAxleDriveStraight) {
    for (const VehicleLevel level : {VehicleLevel::rays, VehicleLevel::full}) {
        for (const double dt : {1.0 / 30, 1.0 / 60, 1.0 / 120}) {
            Road road;
            Vehicle car(road.world, lockedKart(level));
            car.input.throttle = 1;
            run(road.world, 6, dt);
            const DVec3 at = road.world.pose(car.chassis()).position;
            EXPECT_LT(std::abs(at.x), 1e-3 * at.z) << static_cast<int>(level) << " at " << dt;
        }
    }
}

/// A model car of 2 kg, and what weighs a thousand times as much on wheels of 1 m.
VehicleDef scaledCar(float mass, float radius, VehicleLevel level) {
    VehicleDef def = hatchback();
    const float scale = radius / 0.3f;
    def.level = level;
    def.chassis.shapes = {{Box{{0.6f * scale, 0.25f * scale, 1.6f * scale}}, {{0, 0.55f * scale, 0}, {}}}};
    def.chassis.mass = mass;
    def.chassis.centerOfMass = Vec3{0, 0.5f * scale, 0.1f * scale};
    def.chassis.inertia = mass * scale * scale * Vec3{1.25f, 1.4f, 0.35f};
    for (WheelDef& wheel : def.wheels) {
        wheel.position = scale * wheel.position;
        wheel.radius = radius;
        wheel.width = 0.65f * radius;
        wheel.mass = 0.014f * mass;
        wheel.brakeTorque = 1.3f * mass * kGravity * radius / 4;
        wheel.handbrakeTorque = 0;
        wheel.suspension.frequency = 1.4f / std::sqrt(scale);
        wheel.suspension.travelUp = wheel.suspension.travelDown = 0.33f * radius;
        wheel.tire.relaxationLength = radius;
    }
    def.differential.type = DifferentialType::limitedSlip;
    def.differential.preload *= mass / 1200;
    return def;
}

/// As full cars do at any size: brakes hold wheels of hardly an inertia as well, on rays too.
TEST(VehicleDriving, CarsOfAnySizeStandOnASlope) {
    for (const VehicleLevel level : {VehicleLevel::rays, VehicleLevel::full}) {
        for (const auto& [mass, radius] : {std::pair{2.0f, 0.05f}, {150.0f, 0.13f}, {5000.0f, 1.0f}}) {
            for (const double dt : {1.0 / 30, 1.0 / 60, 1.0 / 240}) {
                for (const float heading : {0.4f, 1.9f}) {
                    Road road(0.2f, awake());
                    Vehicle car(road.world, scaledCar(mass, radius, level));
                    road.world.setPose(car.chassis(), {DVec3{}, road.tilt * rotationAbout({0, 1, 0}, heading)});
                    car.input.brake = 1;
                    run(road.world, 8, dt);
                    const DVec3 before = road.world.pose(car.chassis()).position;
                    run(road.world, 10, dt);
                    EXPECT_LT(length(relative(road.world.pose(car.chassis()).position, before)), 1e-4f)
                        << mass << " kg at level " << static_cast<int>(level) << ", " << dt << " s, " << heading;
                }
            }
        }
    }
}

/// Steered to and fro at 15 m/s and 0.2 g, as far as a thousand steps a second have it: at 60 a second substeps share
/// solves, at random steps some do.
TEST(VehicleDriving, SlalomsAlikeAtAnyStep) {
    const auto largestTurn = [](const std::function<double()>& nextStep) {
        Road road;
        Vehicle car(road.world, hatchback(), {.position = {0, 0, -500}, .speed = 15});
        float most = 0;
        for (double time = 0, dt = nextStep(); time < 8; time += dt, dt = nextStep()) {
            const auto middle = static_cast<float>(time + 0.5 * dt);
            car.input.steer = 0.1f * sinCos(2 * kPi / 3 * middle).sin;
            car.input.throttle = std::clamp(0.5f * (15 - car.telemetry().speed) + 0.1f, 0.0f, 1.0f);
            road.world.step(dt);
            if (time > 2) most = std::max(most, std::abs(road.world.angularVelocity(car.chassis()).y));
        }
        return static_cast<double>(most);
    };
    const double truth = largestTurn([] { return 1e-3; });
    EXPECT_GT(truth, 0.1);
    EXPECT_NEAR(largestTurn([] { return 1.0 / 60; }) / truth, 1, 0.002);
    EXPECT_NEAR(largestTurn([] { return 1.0 / 30; }) / truth, 1, 0.005);
    std::mt19937 random(1);
    const auto anyStep = [&] { return 0.01 + 0.04 * static_cast<double>(random() >> 8) / (1 << 24); };
    for (int run = 0; run < 3; ++run) EXPECT_NEAR(largestTurn(anyStep) / truth, 1, 0.03);
}

/// Locked wheels bring a car to rest, and treads and carcasses under μ N throw it back at μ g/ω at most, ω² = C g/σ, by
/// twice their μ g/ω², also where a law of slip has the locked wheel bent by all of σ.
TEST(VehicleDriving, StopsOnLockedWheelsWithoutBeingThrownBack) {
    for (const bool isMagic : {false, true}) {
        for (const float speed : {2.0f, 20.0f}) {
            VehicleDef def = hatchback();
            for (WheelDef& wheel : def.wheels) {
                wheel.brakeTorque = 5000;
                if (isMagic) wheel.tire.magicFormula.emplace();
                if (!isMagic) wheel.tire.slipCurves.emplace();
            }
            Road road(0, awake());
            Vehicle car(road.world, def, {.speed = speed});
            const double sway = std::sqrt(15.0 * 9.81 / static_cast<double>(def.wheels[0].tire.relaxationLength));
            const double most = 1.1 * 9.81 / sway;
            car.input = {.brake = 1, .handbrake = 1, .clutch = 1, .gear = 0};
            double farthest = 0;
            for (int i = 0; i < 300; ++i) {
                road.world.step(kStep);
                farthest = std::max(farthest, road.world.pose(car.chassis()).position.z);
                ASSERT_GT(car.telemetry().speed, -most) << isMagic << " " << speed << " " << i;
            }
            EXPECT_NEAR(car.telemetry().speed, 0, 1e-2);
            EXPECT_LT(farthest - road.world.pose(car.chassis()).position.z, 2 * most / sway) << isMagic << " " << speed;
        }
    }
}

/// A step of steering at 30 m/s has a car turn faster at first than it does then, which is damping as the step has it:
/// forces of the ends of substeps damp the yaw by half a substep.
TEST(VehicleDriving, OvershootsAStepOfSteeringAlikeAtAnyStep) {
    const auto overshoot = [](double dt) {
        Road road;
        Vehicle car(road.world, hatchback(), {.position = {0, 0, -500}, .speed = 30});
        car.input.clutch = 1;
        run(road.world, 1, dt);
        car.input.steer = 0.05f;
        float most = 0, last = 0;
        for (double time = 0; time < 3; time += dt) {
            road.world.step(dt);
            last = std::abs(road.world.angularVelocity(car.chassis()).y);
            most = std::max(most, last);
        }
        return static_cast<double>(most / last);
    };
    const double truth = overshoot(1e-3);
    EXPECT_GT(truth, 1.03);
    EXPECT_NEAR(overshoot(1.0 / 60) / truth, 1, 0.005);
    EXPECT_NEAR(overshoot(1.0 / 30) / truth, 1, 0.02);
}

}  // namespace
}  // namespace ragtop
