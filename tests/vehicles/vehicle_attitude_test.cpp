#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "hardpoints.h"
#include "road.h"

/// A car at any attitude is a passive body on springs: with nobody at the wheel it only loses energy.
namespace ragtop {
namespace {

struct Fall {
    double energyAtFirst = 0;
    double mostEnergy = 0;
    double asleepAfter = 0;  ///< s; the time given where it never sleeps
};

Fall letGo(World& world, const Vehicle& car, double seconds, double dt) {
    Fall fall;
    fall.energyAtFirst = fall.mostEnergy = world.energy();
    fall.asleepAfter = seconds;
    for (double t = 0; t < seconds; t += dt) {
        world.step(dt);
        fall.mostEnergy = std::max(fall.mostEnergy, world.energy());
        if (world.isAwake(car.chassis())) continue;
        fall.asleepAfter = t;
        break;
    }
    return fall;
}

/// All brakes on.
void park(Vehicle& car) { car.input = {.brake = 1, .handbrake = 1}; }

/// One of 36.
Quat attitude(int k) {
    const auto angle = [](int twelfths) { return static_cast<float>(twelfths) * kPi / 6; };
    return rotationAbout({0, 0, 1}, angle(k % 12)) * rotationAbout({1, 0, 0}, angle(k / 12));
}

TEST(VehicleAttitude, DroppedAtAnyItLosesEnergyAndSleeps) {
    for (const double dt : {1.0 / 30, 1.0 / 60, 1.0 / 120}) {
        for (int k = 0; k < 36; ++k) {
            SCOPED_TRACE("attitude " + std::to_string(k) + " at " + std::to_string(dt) + " s");
            Road road;
            Vehicle car(road.world, hatchback());
            road.world.setPose(car.chassis(), {{0, 3, 0}, attitude(k)});
            park(car);
            const Fall fall = letGo(road.world, car, 12, dt);
            EXPECT_LT(fall.mostEnergy, 1.001 * fall.energyAtFirst);
            EXPECT_LT(fall.asleepAfter, 10);
        }
    }
}

/// On its side, between an edge of the body and one of the cabin: rigid ones would rock for up to 12 s.
TEST(VehicleAttitude, OnLinkagesDroppedAtAnyItSleeps) {
    for (const VehicleLevel level : {VehicleLevel::full, VehicleLevel::linkages}) {
        for (int k = 0; k < 36; ++k) {
            SCOPED_TRACE("attitude " + std::to_string(k) + " at level " + std::to_string(static_cast<int>(level)));
            Road road;
            VehicleDef def = withLinkages({frontStruts(), rearArms()});
            def.level = level;
            Vehicle car(road.world, def);
            road.world.setPose(car.chassis(), {{0, 3, 0}, attitude(k)});
            park(car);
            EXPECT_LT(letGo(road.world, car, 12, 1.0 / 120).asleepAfter, 10);
        }
    }
}

/// As much as dents of bodywork and sides of wheels take, and more where the definition says so.
TEST(VehicleAttitude, ResistsRockingInProportionToItsWheels) {
    for (const float scale : {0.1f, 1.0f, 3.0f}) {
        for (const float given : {0.0f, 0.5f}) {
            VehicleDef def = hatchback();
            for (WheelDef& wheel : def.wheels) wheel.radius *= scale;
            def.chassis.material.rollingResistance = given;
            Road road;
            const Vehicle car(road.world, def);
            const auto shapes = road.world.shapes(car.chassis());
            for (std::size_t i = 0; i < shapes.size(); ++i) {
                const float arm = (i < def.chassis.shapes.size() ? 0.14f : 0.06f) * 0.3f * scale;
                EXPECT_FLOAT_EQ(road.world.material(shapes[i]).rollingResistance, std::max(given, arm)) << i;
            }
        }
    }
}

/// With what springs and tires hold, also on springs that are slack where wheels hang.
TEST(VehicleAttitude, DroppedOnAnySpringsItHasNoMoreThanAtFirst) {
    for (const float frequency : {1.0f, 2.0f, 3.0f, 5.0f}) {
        for (const double dt : {1.0 / 30, 1.0 / 120}) {
            VehicleDef def = hatchback();
            for (WheelDef& wheel : def.wheels) wheel.suspension.frequency = frequency;
            Road road(0, awake());
            Vehicle car(road.world, def);
            road.world.setPose(car.chassis(), {{0, 3, 0}, rotationAbout({0, 0, 1}, 0.1f)});
            park(car);
            const auto energy = [&] {
                const EnergyTelemetry& held = car.telemetry().energy;
                return road.world.energy() + held.elastic + held.rotating;
            };
            road.world.step(dt);
            const double first = energy();
            for (double t = 0; t < 3; t += dt) {
                road.world.step(dt);
                ASSERT_LT(energy(), 1.001 * first) << frequency << " Hz, " << t << " s at " << dt;
            }
        }
    }
}

TEST(VehicleAttitude, RollingOverItLosesEnergyAndSleeps) {
    for (const float speed : {4.0f, 5.0f, 8.0f, 12.0f, 16.0f, 20.0f, 24.0f, 25.0f, 28.0f}) {
        Road road;
        Vehicle car(road.world, hatchback(), {.position = {0, 0.5, 0}});
        road.world.setVelocity(car.chassis(), {speed, 0, 0.5f * speed}, {0, 0.2f * speed, -0.4f * speed});
        park(car);
        const Fall fall = letGo(road.world, car, 15, kStep);
        EXPECT_LT(fall.mostEnergy, 1.001 * fall.energyAtFirst) << speed;
        EXPECT_LE(fall.asleepAfter, 10 + kStep / 2) << speed;  // told in whole steps
    }
}

/// A car on its side is turned up by a torque. Its lower wheels come to the ground from inside of the bodywork's reach,
/// deeper than their struts are long at that tilt; what they then carry is paid for by the torque alone.
TEST(VehicleAttitude, TurnedUprightItGainsTheWorkOfTheTorqueAtMost) {
    for (const double dt : {1.0 / 30, 1.0 / 60, 1.0 / 120}) {
        Road road(0, awake());
        VehicleDef def = hatchback();
        def.chassis.material.friction = 0.8f;
        Vehicle car(road.world, def);
        const BodyId chassis = car.chassis();
        road.world.setPose(chassis, {{0, 0.82, 0}, rotationAbout({0, 0, 1}, 0.5f * kPi)});
        park(car);
        run(road.world, 2, dt);
        const double before = road.world.energy();
        double work = 0;
        for (double t = 0; t < 6; t += dt) {
            const bool up = rotate(road.world.pose(chassis).rotation, {0, 1, 0}).y > 0.75f;
            const float torque = up || t > 3 ? 0.0f : -7000.0f;
            const float spinBefore = road.world.angularVelocity(chassis).z;
            road.world.applyTorque(chassis, {0, 0, torque});
            road.world.step(dt);
            const float spin = 0.5f * (spinBefore + road.world.angularVelocity(chassis).z);
            work += static_cast<double>(torque * spin) * dt;
            ASSERT_LT(road.world.energy(), 1.001 * (before + work)) << t << " s at " << dt;
        }
        EXPECT_NEAR(road.world.pose(chassis).position.y, 0, 1e-3) << dt;
        for (const WheelTelemetry& wheel : car.telemetry().wheels) EXPECT_NEAR(wheel.compression, 0, 1e-3) << dt;
    }
}

/// Hubs that rise along a leaning axis take the car along: where its tires stick, it moves by tan φ of what it sinks.
TEST(VehicleAttitude, OnLeaningStrutsItSinksAlongThem) {
    const float lean = 0.4f;  // tan φ
    VehicleDef def = hatchback();
    for (WheelDef& wheel : def.wheels) {
        wheel.suspension.axis = {lean, 1, 0};
        wheel.tire.corneringStiffness = 100;
        wheel.tire.radialStiffness = 3e6f;
    }
    Road road(0, awake());
    Vehicle car(road.world, def);
    park(car);
    run(road.world, 4);
    const DVec3 before = road.world.pose(car.chassis()).position;
    for (int i = 0; i < 240; ++i) {
        road.world.applyForce(car.chassis(), {0, -4000, 0}, road.world.centerOfMass(car.chassis()));
        road.world.step(kStep);
    }
    const Vec3 moved = relative(road.world.pose(car.chassis()).position, before);
    EXPECT_LT(moved.y, -0.03f);
    EXPECT_NEAR(moved.x, lean * moved.y, 0.02f * std::abs(lean * moved.y));
    EXPECT_NEAR(totalLoad(car), 1200 * kGravity + 4000, 10);
}

}  // namespace
}  // namespace ragtop
