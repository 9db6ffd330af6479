#include "ragtop/telemetry.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>
#include <string>

#include "road.h"

namespace ragtop {
namespace {

TEST(Telemetry, ChannelsHaveNamesUnitsAndMeaningsOfTheirOwn) {
    std::set<std::string_view> ofWheel, ofCar;
    int all = 0;
    const auto note = [&](std::set<std::string_view>& names) {
        return [&](const TelemetryChannel& channel, double value) {
            EXPECT_TRUE(names.insert(channel.name).second) << channel.name;
            EXPECT_FALSE(channel.unit.empty() || channel.meaning.empty()) << channel.name;
            EXPECT_TRUE(std::isfinite(value)) << channel.name;
            ++all;
        };
    };
    Road road;
    Vehicle car(road.world, hatchback());
    forEachChannel(car.telemetry(), note(ofCar));
    for (const WheelTelemetry& wheel : car.telemetry().wheels) {
        ofWheel.clear();
        forEachChannel(wheel, note(ofWheel));
    }
    EXPECT_GE(all, 60);
}

/// Locked wheels on level ground: what the chassis loses is what patches and air turn into heat, but for what pitching
/// moves between struts and chassis.
TEST(Telemetry, PowerOfSlipAndAirIsTheEnergyThatBrakingTakes) {
    VehicleDef def = hatchback();
    for (WheelDef& wheel : def.wheels) wheel.brakeTorque = 1e5f;
    Road road(0, awake());
    Vehicle car(road.world, def, {.speed = 30});
    car.input.brake = 1;
    car.input.clutch = 1;
    run(road.world, 1);
    const double dt = 1.0 / 240, before = static_cast<double>(car.telemetry().kineticEnergy);
    double heat = 0;
    for (int i = 0; i < 240; ++i) {
        const auto power = [&] {
            const VehicleTelemetry& now = car.telemetry();
            float sum = now.drag * now.speed;
            for (const WheelTelemetry& wheel : now.wheels) sum += wheel.slipPower;
            return static_cast<double>(sum);
        };
        const double first = power();
        road.world.step(dt);
        heat += 0.5 * dt * (first + power());
    }
    const double lost = before - static_cast<double>(car.telemetry().kineticEnergy);
    EXPECT_GT(lost, 1e5);
    EXPECT_NEAR(heat, lost, 0.01 * lost);
}

/// Standing on level ground, springs carry what wheels bear, no tire slips, and nothing tilts.
TEST(Telemetry, OfACarAtRestIsThatOfRest) {
    Road road(0, awake());
    Vehicle car(road.world, hatchback());
    car.input.handbrake = 0.5f;
    run(road.world, 5);
    const VehicleTelemetry& now = car.telemetry();
    for (const float zero : {now.yawRate, now.pitchRate, now.rollRate, now.pitch, now.roll, now.climbSpeed})
        EXPECT_NEAR(zero, 0, 1e-3f);
    EXPECT_EQ(now.handbrake, 0.5f);
    for (const WheelTelemetry& wheel : now.wheels) {
        EXPECT_NEAR(wheel.springForce, wheel.load, 1e-3f * wheel.load);
        EXPECT_NEAR(wheel.camber, 0, 1e-3f);
        EXPECT_LT(wheel.gripUsed, 0.01f);
        EXPECT_NEAR(wheel.slipPower, 0, 1e-2f);
    }
}

/// A car turned by known angles tells them.
TEST(Telemetry, AnglesAreThoseThatTheCarWasTurnedBy) {
    World world;
    Vehicle car(world, hatchback());
    const Quat rotation =
        rotationAbout({0, 1, 0}, 0.5f) * rotationAbout({1, 0, 0}, 0.2f) * rotationAbout({0, 0, 1}, 0.1f);
    world.setPose(car.chassis(), {{0, 50, 0}, rotation});
    world.setVelocity(car.chassis(), rotate(rotation, {1, 0, 4}), rotate(rotation, {0.1f, 0.2f, 0.3f}));
    world.step(1e-5);
    const VehicleTelemetry& now = car.telemetry();
    EXPECT_NEAR(now.heading, 0.5f, 1e-4f);
    EXPECT_NEAR(now.pitch, 0.2f, 1e-4f);
    EXPECT_NEAR(now.roll, 0.1f, 1e-4f);
    EXPECT_NEAR(now.speed, 4, 1e-3f);
    EXPECT_NEAR(now.sideSpeed, 1, 1e-3f);
    EXPECT_NEAR(now.pitchRate, 0.1f, 1e-4f);
    EXPECT_NEAR(now.yawRate, 0.2f, 1e-4f);
    EXPECT_NEAR(now.rollRate, 0.3f, 1e-4f);
}

}  // namespace
}  // namespace ragtop
