#include <gtest/gtest.h>

#include <cmath>

#include "road.h"

/// What the air does besides drag and the lift of the whole car.
namespace ragtop {
namespace {

WorldSettings weightless() {
    WorldSettings settings = awake();
    settings.gravity = {0, 0, 0};
    return settings;
}

VehicleDef inAir(const AerodynamicsDef& air) {
    VehicleDef def = hatchback();
    def.aerodynamics = air;
    return def;
}

/// Each axle bears ½ ρ A v² more of its own, whatever the other has.
TEST(Air, PressesEachAxleByItsOwnLift) {
    for (const auto& [front, rear] : {std::pair{-1.0f, -2.0f}, std::pair{0.5f, -1.5f}, std::pair{1.0f, -1.0f}}) {
        Road road;
        Vehicle car(road.world, inAir({.dragArea = 0, .axleLifts = {{0, front}, {1, rear}}}),
                    {.position = {0, 0, -500}, .speed = 40});
        car.input.clutch = 1;
        run(road.world, 4);
        const VehicleTelemetry& now = car.telemetry();
        const float pressure = 0.5f * 1.2f * now.speed * now.speed, least = 0.02f * 3 * pressure;
        const auto gained = [&](std::size_t i) {
            return now.wheels[i].load + now.wheels[i + 1].load - car.staticLoads()[i] - car.staticLoads()[i + 1];
        };
        // What rolling resists, at the ground, moves some load from the front to the rear.
        EXPECT_NEAR(gained(0), -front * pressure, least) << front;
        EXPECT_NEAR(gained(2), -rear * pressure, least) << rear;
        EXPECT_NEAR(now.lift, (front + rear) * pressure, 1e-3f * 3 * pressure);
    }
}

/// Thrown sideways: v = v₀/(1 + c v₀ t) with c = ½ ρ A/m.
TEST(Air, StopsADriftByTheClosedForm) {
    World world(weightless());
    Vehicle car(world, inAir({.dragArea = 0, .sideArea = 4}), {.position = {0, 100, 0}});
    world.setVelocity(car.chassis(), {40, 0, 0}, {});
    run(world, 10, 1.0 / 240);
    const double c = 0.5 * 1.2 * 4 / 1200, expected = 40 / (1 + c * 40 * 10);
    EXPECT_NEAR(world.linearVelocity(car.chassis()).x, expected, 1e-3 * expected);
    EXPECT_LT(car.telemetry().sideForce, 0);
}

/// A fin: the nose swings about where the car goes, I ψ″ = −½ ρ Y v² sin ψ; one without stays as it is.
TEST(Air, SwingsTheNoseAboutItsWay) {
    const float speed = 50, volume = 3, inertia = 1700;
    World world(weightless());
    Vehicle car(world, inAir({.dragArea = 0, .yawVolume = volume}), {.position = {0, 100, 0}, .heading = 0.05f});
    world.setVelocity(car.chassis(), {0, 0, speed}, {});
    const double period =
        2 * 3.14159265358979 / std::sqrt(0.5 * 1.2 * static_cast<double>(volume * speed * speed / inertia));
    run(world, 0.5 * period, 1.0 / 960);
    EXPECT_NEAR(car.telemetry().heading, -0.05f, 1e-3f);
    run(world, 0.5 * period, 1.0 / 960);
    EXPECT_NEAR(car.telemetry().heading, 0.05f, 1e-3f);
}

TEST(Air, RefusesLiftWhereThereIsNoAxle) {
    EXPECT_EQ(whyInvalid(inAir({.axleLifts = {{7, 1}}})),
              "/aerodynamics/axleLifts/0/axle is 7, which has no wheels, must be one that has");
    EXPECT_EQ(whyInvalid(inAir({.axleLifts = {{1, 1}, {1, 2}}})),
              "/aerodynamics/axleLifts/1/axle is 1, must be that of no other");
    EXPECT_EQ(whyInvalid(inAir({.sideArea = -1})), "/aerodynamics/sideArea is -1 m², must be in [0, 1000000]");
}

/// Pressed down by q |A| with the struts at rest and by q p more per m that it sinks, an axle on springs k to a wheel sinks
/// by q |A|/(2 k − q p).
TEST(Air, ThatPressesMoreTheLowerItHoldsAnAxleMakesItsSpringsSofter) {
    VehicleDef def = hatchback();
    constexpr float kStiffness = 24000, kArea = -1.5f, kPerHeight = 12, kWind = 50;
    for (WheelDef& wheel : def.wheels) wheel.suspension.stiffness = kStiffness;
    def.antiRollBars.clear();
    def.aerodynamics = {.dragArea = 0, .axleLifts = {{0, kArea, kPerHeight}, {1, kArea, kPerHeight}}};
    Road road(0, awake());
    Vehicle car(road.world, def, {});
    car.input = {.brake = 1, .handbrake = 1, .clutch = 1};
    run(road.world, 6);
    std::vector<float> still;
    for (const WheelTelemetry& wheel : car.telemetry().wheels) still.push_back(wheel.compression);
    car.input.wind = {0, 0, -kWind};
    run(road.world, 10);
    const float q = 0.5f * def.aerodynamics.airDensity * kWind * kWind;
    for (std::size_t i = 0; i < still.size(); ++i) {
        const float sunk = car.telemetry().wheels[i].compression - still[i];
        // From where it stands, which is its place at rest but for some micrometres of what is rounded.
        EXPECT_NEAR(sunk, q * (-kArea + kPerHeight * still[i]) / (2 * kStiffness - q * kPerHeight), 0.01f * sunk);
        EXPECT_GT(sunk, 0.05f);
    }
}

}  // namespace
}  // namespace ragtop
