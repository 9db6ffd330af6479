#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <deque>
#include <random>
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

/// Braked at any heading, on what the wheels hold: after it has settled the car stays, though its rotation is known to
/// 1e-7 rad alone.
TEST(Vehicle, HoldsOnASlopeForGood) {
    for (const double dt : {1.0 / 30, 1.0 / 60, 1.0 / 120}) {
        for (const float slope : {0.3f, 0.7f}) {
            for (int k = 0; k < 16; k += 5) {
                const float heading = 0.125f * kPi * static_cast<float>(k);
                Road road(slope, awake());
                Vehicle car(road.world, plainTires(1), {.position = {}, .heading = heading});
                road.world.setPose(car.chassis(), {{}, road.tilt * rotationAbout({0, 1, 0}, heading)});
                car.input = {.brake = 1, .handbrake = 1};
                run(road.world, 10, dt);
                const DVec3 from = road.world.pose(car.chassis()).position;
                run(road.world, 30, dt);
                const Vec3 drift = relative(road.world.pose(car.chassis()).position, from);
                EXPECT_LT(length(drift), 1e-4f) << slope << " at " << heading << " " << dt;
                EXPECT_LT(length(road.world.linearVelocity(car.chassis())), 2e-5f) << slope << " at " << heading;
            }
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
        wheel.tire.radialStiffness = 1e6f;
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

/// What lies between a wheel and the road passes the wheel's load on, and with it the car's height, to a tenth of its
/// own.
TEST(Vehicle, StandsOnALightBrickAsOnAFixedOne) {
    const float half = 0.04f;
    const Box shape{{0.12f, half, 0.12f}};
    const DVec3 place{0.74, 0.04, 1.26};
    const double volume = 8 * 0.12 * 0.12 * 0.04;
    double fixedHeight = 0;
    for (const double mass : {0.0, 1.0, 5.0, 100.0}) {
        Road road(0, awake());
        const BodyId brick = mass > 0
                                 ? road.world.create(DynamicBody{
                                       .shape = shape, .density = static_cast<float>(mass / volume), .position = place})
                                 : road.world.create(StaticBody{.shape = shape, .position = place});
        Vehicle car(road.world, hatchback(), {.position = {0, 0.1, 0}});
        car.input.brake = 1;
        run(road.world, 10);
        const WheelTelemetry& wheel = car.telemetry().wheels[0];
        EXPECT_EQ(wheel.ground, brick);
        const double height = wheel.pose.position.y;
        if (mass == 0) {
            fixedHeight = height;
            EXPECT_NEAR(height, 0.30 + 2 * half, 2e-3);
            continue;
        }
        double handedOn = -mass * static_cast<double>(kGravity);
        road.world.forEachContact(brick, [&](const Contact& contact) { handedOn += contact.normalForce; });
        EXPECT_NEAR(handedOn, wheel.load, 0.01f * wheel.load) << mass;
        EXPECT_NEAR(height, fixedHeight, 0.1 * 2 * half) << mass;
    }
}

/// A brick of any size and weight, turned, with a wheel up to half of its half widths beside its middle.
struct Brick {
    Vec3 half;
    float mass = 0, yaw = 0, beside = 0, before = 0;

    explicit Brick(std::mt19937& dice) {
        const auto between = [&](float from, float to) {
            return std::uniform_real_distribution<float>(from, to)(dice);
        };
        half = {between(0.08f, 0.2f), between(0.01f, 0.06f), between(0.08f, 0.2f)};
        mass = 0.5f * std::exp(between(0, std::log(200.0f)));
        yaw = between(-1.5f, 1.5f);
        beside = between(-0.5f, 0.5f) * half.x;
        before = between(-0.5f, 0.5f) * half.z;
    }
};

/// Height of the wheel of a car that was let down on it; checks what of its load goes through the brick.
double heightOn(const Brick& brick, double hz, bool moves) {
    Road road(0, awake());
    const Quat turn = rotationAbout({0, 1, 0}, brick.yaw);
    const DVec3 place = DVec3{0.74, 0, 1.26} + rotate(turn, {brick.beside, brick.half.y, brick.before});
    const float density = brick.mass / (8 * brick.half.x * brick.half.y * brick.half.z);
    const BodyId body =
        moves ? road.world.create(
                    DynamicBody{.shape = Box{brick.half}, .density = density, .position = place, .rotation = turn})
              : road.world.create(StaticBody{.shape = Box{brick.half}, .position = place, .rotation = turn});
    Vehicle car(road.world, hatchback(), {.position = {0, 2 * static_cast<double>(brick.half.y) + 0.02, 0}});
    car.input.brake = 1;
    run(road.world, 6, 1 / hz);
    const WheelTelemetry& wheel = car.telemetry().wheels[0];
    EXPECT_EQ(wheel.ground, body) << brick.mass << " kg, " << hz << " Hz";
    if (!moves) return wheel.pose.position.y;
    float handedOn = -brick.mass * kGravity;
    road.world.forEachContact(body, [&](const Contact& contact) { handedOn += contact.normalForce; });
    EXPECT_NEAR(handedOn, wheel.load, 0.01f * wheel.load) << brick.mass << " kg, " << hz << " Hz";
    return wheel.pose.position.y;
}

TEST(Vehicle, StandsOnAnyBrickAsOnAFixedOne) {
    std::mt19937 dice(3);
    for (int i = 0; i < 24; ++i) {
        const Brick brick(dice);
        const double hz = 30 << i % 3;
        EXPECT_NEAR(heightOn(brick, hz, true), heightOn(brick, hz, false), 0.2 * static_cast<double>(brick.half.y))
            << brick.mass << " kg, " << hz << " Hz";
    }
}

/// Through a heap of bricks: what is squeezed out from under the wheels does not leave faster than the car goes.
TEST(Vehicle, ShootsNoRubbleAway) {
    const float speed = 15;
    Road road;
    std::vector<BodyId> bricks;
    for (int i = 0; i < 60; ++i) {
        const double across = -1 + 0.4 * (i % 6), along = 10 + 0.25 * (i / 6), up = 0.041 + 0.082 * (i % 2);
        bricks.push_back(road.world.create(DynamicBody{.shape = Box{{0.1f, 0.04f, 0.06f}},
                                                       .density = 1560,
                                                       .position = {across, up, along},
                                                       .rotation = rotationAbout({0, 1, 0}, 0.7f * (i % 5))}));
    }
    Vehicle car(road.world, hatchback(), {.position = {}, .speed = speed});
    for (int i = 0; i < 120; ++i) {
        road.world.step(kStep);
        for (const BodyId brick : bricks) ASSERT_LT(length(road.world.linearVelocity(brick)), speed) << i;
    }
    EXPECT_GT(road.world.pose(car.chassis()).position.z, 13);
}

/// The side of the next slab of a road is no wall to a wheel that drifts over to it, however slowly.
TEST(Vehicle, DriftsOverASeamAsOverOneFloor) {
    for (const double hz : {30.0, 60.0, 120.0, 240.0}) {
        for (const float speed : {20.0f, 35.0f}) {
            for (const float drift : {0.02f, 0.06f}) {
                World world(awake());
                for (const float side : {-500.0f, 500.0f})
                    world.create(StaticBody{.shape = Box{{500, 1, 2000}}, .position = {side, -1, 0}});
                Vehicle car(world, plainTires(1), {.position = {0.85, 0, 0}, .heading = -drift, .speed = speed});
                car.input = {.clutch = 1};
                Vec3 before = world.linearVelocity(car.chassis());
                for (int i = 0; i < static_cast<int>(4 * hz); ++i) {
                    world.step(1 / hz);
                    const Vec3 now = world.linearVelocity(car.chassis());
                    ASSERT_LT(length(now - before), 1e-3f + 0.1f / static_cast<float>(hz)) << hz << " Hz, " << speed;
                    before = now;
                }
                EXPECT_LT(world.pose(car.chassis()).position.x, -0.74);
            }
        }
    }
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

/// A plate on ice: what the car pushes off with, the plate gets with the opposite sign, whatever its mass. With rays
/// the lightest is of 10 kg: of a kilogram the one solve of a step makes next to nothing.
TEST(Vehicle, PushesTheGroundBack) {
    const auto pushes = [](VehicleLevel level, double mass, double dt) {
        World world(awake());
        world.create(StaticBody{.shape = Box{{50, 1, 80}}, .position = {0, -1.1, 0}, .material = {.friction = 0}});
        const double volume = 8 * 5 * 0.05 * 60;
        const auto plate = world.create(DynamicBody{.shape = Box{{5, 0.05f, 60}},
                                                    .density = static_cast<float>(mass / volume),
                                                    .position = {0, -0.05, 0},
                                                    .material = {.friction = 0.6f}});
        VehicleDef def = plainTires(1);
        def.level = level;
        Vehicle car(world, def);
        car.input = {.clutch = 1, .gear = 1};
        const auto momentum = [&](BodyId body) {
            return static_cast<double>(world.mass(body).mass * world.linearVelocity(body).z);
        };
        run(world, 2, dt);
        const double before = momentum(car.chassis()) + momentum(plate);
        car.input = {.throttle = 0.5f, .gear = 1};
        run(world, 2, dt);
        EXPECT_GT(momentum(car.chassis()), 10 * std::min(mass, 100.0));
        EXPECT_NEAR(momentum(car.chassis()) + momentum(plate), before, 1e-3 * momentum(car.chassis()))
            << mass << " kg, level " << static_cast<int>(level);
    };
    for (const double mass : {1.0, 10.0, 100.0, 2000.0, 10000.0}) {
        pushes(VehicleLevel::full, mass, kStep);
        pushes(VehicleLevel::full, mass, 2 * kStep);
        pushes(VehicleLevel::rays, mass, kStep);
    }
}

/// Forces of tires are over grip: also where there is none they are numbers, and loads stay.
TEST(Vehicle, StandsOnGroundWithoutFriction) {
    for (int law = 0; law < 3; ++law) {
        for (const VehicleLevel level : {VehicleLevel::rays, VehicleLevel::full}) {
            for (const float friction : {0.0f, 1e-30f}) {
                SCOPED_TRACE(testing::Message() << law << " " << static_cast<int>(level) << " " << friction);
                VehicleDef def = plainTires(1);
                for (WheelDef& wheel : def.wheels) {
                    if (law == 1) wheel.tire.magicFormula.emplace();
                    if (law == 2) wheel.tire.slipCurves.emplace();
                }
                def.level = level;
                World world(awake());
                StaticBody ice{.shape = Box{{500, 1, 500}}, .position = {0, -1, 0}};
                ice.material.friction = friction;
                world.create(ice);
                Vehicle car(world, def, {.position = {0, 0.02, 0}, .speed = 10});
                car.input = {.throttle = 0.5f, .steer = 0.3f};
                run(world, 3);
                EXPECT_NEAR(totalLoad(car), 1200 * kGravity, 0.01f * 1200 * kGravity);
                EXPECT_NEAR(length(world.linearVelocity(car.chassis())), 10, 1e-3f);
                EXPECT_GT(car.telemetry().energy.engine, 1000);
            }
        }
    }
}

/// Wheels stand across edges of triangles there, on the one or the other of which they lie as high.
TEST(Vehicle, FallsAsleepWhereverItIsParkedOnHills) {
    constexpr int kSide = 61, kCars = 6;
    std::mt19937 dice(1);
    std::vector<float> heights;
    for (int i = 0; i < kSide * kSide; ++i) heights.push_back(0.2f * static_cast<float>(dice() >> 8) / (1 << 24));
    for (const VehicleLevel level : {VehicleLevel::rays, VehicleLevel::full}) {
        for (const double dt : {1.0 / 30, 1.0 / 60, 1.0 / 120}) {
            World world;
            world.create(StaticBody{.shape = HeightField(kSide, kSide, 1.5f, heights), .position = {-45, 0, -45}});
            VehicleDef def = hatchback();
            def.level = level;
            std::deque<Vehicle> cars;
            for (int i = 0; i < kCars * kCars; ++i) {
                const float heading = 0.7f * static_cast<float>(i);
                cars.emplace_back(world, def,
                                  VehiclePlacement{.position = {12.1 * (i % kCars) - 30, 0.3, 12.3 * (i / kCars) - 30},
                                                   .heading = heading});
                cars.back().input.handbrake = 1;
            }
            run(world, 10, dt);
            for (const Vehicle& car : cars)
                EXPECT_FALSE(world.isAwake(car.chassis())) << static_cast<int>(level) << " " << dt;
        }
    }
}

}  // namespace
}  // namespace ragtop
