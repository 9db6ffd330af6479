#include "ragtop/vehicle.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <stdexcept>
#include <vector>

#include "hatchback.h"
#include "ragtop/world.h"

namespace ragtop {
namespace {

constexpr double kStep = 1.0 / 60;
constexpr float kGravity = 9.81f;

/// A plane of the given slope (rise over run along the direction in which a car of heading 0 looks), and a car on it.
struct Road {
    World world;
    Quat tilt;

    explicit Road(float slope = 0, const WorldSettings& settings = {}) : world(settings) {
        tilt = rotationAbout({1, 0, 0}, -std::atan(slope));
        const Vec3 down = rotate(tilt, {0, -1, 0});
        world.create(StaticBody{.shape = Box{{2000, 1, 2000}}, .position = DVec3(down), .rotation = tilt});
    }
};

WorldSettings awake() {
    WorldSettings settings;
    settings.sleeping = false;
    return settings;
}

VehicleDef plainTires(float friction) {
    VehicleDef def = hatchback();
    for (WheelDef& wheel : def.wheels) {
        wheel.tire.longitudinalFriction = wheel.tire.lateralFriction = friction;
        wheel.tire.rollingResistance = 0;
    }
    def.aerodynamics.dragArea = 0;
    return def;
}

float totalLoad(const Vehicle& car) {
    float sum = 0;
    for (const WheelTelemetry& wheel : car.telemetry().wheels) sum += wheel.load;
    return sum;
}

void run(World& world, double seconds, double dt = kStep) {
    const int steps = static_cast<int>(std::lround(seconds / dt));
    for (int i = 0; i < steps; ++i) world.step(dt);
}

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
    for (int i = 0; i < 5; ++i) cars.emplace_back(road.world, hatchback(), VehiclePlacement{.position = {4.0 * i, 0, 0}});
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
