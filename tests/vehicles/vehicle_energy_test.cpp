#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "road.h"

namespace ragtop {
namespace {

double energyOf(const World& world, const Vehicle& car) {
    const double height = world.centerOfMass(car.chassis()).y;
    return static_cast<double>(car.telemetry().kineticEnergy) +
           static_cast<double>(world.mass(car.chassis()).mass * kGravity) * height;
}

/// A wheel that lands within a substep is met there, and not found in the ground after it, squashed for nothing.
TEST(VehicleEnergy, FallsOnItsTiresForNothingByNoStep) {
    for (const double hz : {30, 60, 120}) {
        for (const float height : {0.05f, 0.2f, 0.5f, 1.0f}) {
            Road road(0, awake());
            VehicleDef def = hatchback();
            for (WheelDef& wheel : def.wheels) {
                wheel.suspension.dampingRatio = 0;
                wheel.suspension.travelUp = wheel.suspension.travelDown = 0.3f;
            }
            Vehicle car(road.world, def, {.position = {0, static_cast<double>(height), 0}});
            car.input.clutch = 1;
            road.world.step(1 / hz);
            const auto now = [&] { return energyOf(road.world, car) + car.telemetry().energy.elastic; };
            const double first = now();
            double most = first;
            for (int i = 0; i < 3 * hz; ++i) {
                road.world.step(1 / hz);
                most = std::max(most, now());
            }
            const double fall = static_cast<double>(def.chassis.mass * kGravity * height);
            EXPECT_LT(most - first, 2e-3 * fall) << hz << " " << height;
        }
    }
}

/// A car that is stopped sways on its treads, without any damping of theirs: what it gets back they held.
TEST(VehicleEnergy, TreadsGiveBackWhatTheyHold) {
    VehicleDef def = plainTires(1);
    for (WheelDef& wheel : def.wheels) {
        wheel.tire.dampingRatio = 0;
        wheel.tire.relaxationLength = 1;
    }
    Road road(0, awake());
    Vehicle car(road.world, def, {.position = {0, 0, 0}, .speed = 0.5f});
    car.input = {.brake = 1, .clutch = 1, .gear = 0};
    const double moved = 0.5 * static_cast<double>(def.chassis.mass) * 0.25;
    double least = 0, most = 0, back = 0;
    for (int i = 0; i < 120; ++i) {
        road.world.step(kStep);
        const EnergyTelemetry& energy = car.telemetry().energy;
        const double now = energyOf(road.world, car) + energy.elastic + energy.rotating;
        least = i == 0 ? now : std::min(least, now);
        most = std::max(most, now - least);
        if (car.telemetry().speed < 0) back = std::max(back, static_cast<double>(car.telemetry().kineticEnergy));
    }
    EXPECT_GT(back, 0.1 * moved);
    EXPECT_LT(most, 0.01 * moved);
}

/// What a driver does on a lap: full throttle through the gears, bends, brakes, and a stretch on a loose pedal.
VehicleInput lap(double t) {
    VehicleInput input;
    if (t < 12) input.throttle = 1;
    if (t >= 4 && t < 16) input.steer = static_cast<float>(0.25 * std::sin(1.2 * t));
    if (t >= 12 && t < 14) input.brake = 0.5f;
    if (t >= 14 && t < 22) input.throttle = 0.6f;
    if (t >= 26) input.brake = 0.8f;
    input.differentialLock = t < 8 ? 1.0f : 0.0f;
    return input;
}

struct LapWork {
    double engine = 0, missing = 0;
    EnergyTelemetry energy;
};

LapWork driveLap(const VehicleDef& def, double dt, float slope) {
    Road road(slope, awake());
    Vehicle car(road.world, def, {.position = {0, 0.02, 0}});
    for (int i = 0; i < 120; ++i) road.world.step(dt);
    const EnergyTelemetry from = car.telemetry().energy;
    const double before = energyOf(road.world, car) + from.rotating;
    for (int i = 0; static_cast<double>(i) * dt < 30; ++i) {
        car.input = lap(static_cast<double>(i) * dt);
        road.world.step(dt);
    }
    const EnergyTelemetry& to = car.telemetry().energy;
    const auto losses = [](const EnergyTelemetry& e) {
        return e.clutch + e.gears + e.differentials + e.brakes + e.rolling + e.slip + e.struts + e.air;
    };
    const double kept = energyOf(road.world, car) + to.rotating - before;
    return {to.engine - from.engine, to.engine - from.engine - kept - (losses(to) - losses(from)), to};
}

/// Engine work = Δenergy + every loss, within 0.1 %, however it is coupled and geared.
TEST(VehicleEnergy, OfALapIsTheEnginesWork) {
    for (const CouplingType coupling : {CouplingType::clutch, CouplingType::dualClutch, CouplingType::converter}) {
        for (const DifferentialType type : {DifferentialType::open, DifferentialType::limitedSlip,
                                            DifferentialType::viscous, DifferentialType::active}) {
            VehicleDef def = hatchback();
            def.gearbox.coupling = coupling;
            def.differential.type = type;
            const LapWork work = driveLap(def, kStep, 0);
            EXPECT_GT(work.engine, 5e5);
            EXPECT_NEAR(work.missing, 0, 0.001 * work.engine) << static_cast<int>(coupling) << static_cast<int>(type);
        }
    }
}

/// The step and the slope of the road do not matter to it.
TEST(VehicleEnergy, ClosesAtAnyStepAndUphill) {
    for (const double dt : {1.0 / 30, 1.0 / 120}) {
        for (const float slope : {0.0f, 0.05f}) {
            VehicleDef def = hatchback();
            def.engine.turbo = TurboDef{};
            const LapWork work = driveLap(def, dt, slope);
            EXPECT_NEAR(work.missing, 0, 0.001 * work.engine) << dt << " " << slope;
        }
    }
}

/// Σ M/r = (m + Σ I/r²) a, also out of sleep; what is no number is no torque.
TEST(DirectDrive, AcceleratesTheCarByItsTorques) {
    VehicleDef def = plainTires(1);
    Road road;
    Vehicle car(road.world, def);
    run(road.world, 8);
    ASSERT_FALSE(road.world.isAwake(car.chassis()));
    car.input.gear = 0;
    car.input.wheelTorques = {60, 60, 60, 60, 0, std::nanf("")};
    run(road.world, 5);
    const float radius = def.wheels[0].radius, spun = 4 * 0.75f * def.wheels[0].mass;
    const double expected = static_cast<double>(240 / radius / (def.chassis.mass + spun) * 5);
    EXPECT_NEAR(static_cast<double>(car.telemetry().speed), expected, 0.01 * expected);
    car.input.wheelTorques = {};
    run(road.world, 1);
    EXPECT_NEAR(static_cast<double>(car.telemetry().speed), expected, 0.01 * expected);
}

/// Drag is that of the flow, v − w: against the wind (v + w)², and nothing for a car that goes with it.
TEST(Wind, BlowsAtTheCarWithTheSpeedOfTheFlow) {
    for (const float wind : {20.0f, 0.0f, -15.0f}) {
        VehicleDef def = plainTires(1);
        def.aerodynamics.dragArea = 2;
        Road road;
        Vehicle car(road.world, def, {.position = {0, 0, -500}, .speed = 20});
        car.input.gear = 0;
        car.input.wind = {0, 0, wind};
        run(road.world, 1);
        const float before = car.telemetry().speed;
        run(road.world, 2);
        const float after = car.telemetry().speed, flow = 0.5f * (before + after) - wind;
        const float spun = 4 * 0.75f * def.wheels[0].mass;
        const float force = 0.5f * def.aerodynamics.airDensity * 2 * flow * std::abs(flow);
        const float lost = 2 * force / (def.chassis.mass + spun);
        // The flow changes by less than a tenth meanwhile, so that its mean square is that of the mean within 0.1 %.
        EXPECT_NEAR(before - after, lost, 0.01f * lost + 2e-3f) << wind;
        EXPECT_NEAR(car.telemetry().drag, 0.5f * def.aerodynamics.airDensity * 2 * (after - wind) * (after - wind),
                    0.01f * std::abs(force) + 0.1f);
    }
}

/// A car with a motor and one gear gets back a part of what it brakes.
TEST(VehicleEnergy, AMotorTakesBackWhatItBrakes) {
    VehicleDef def = hatchback();
    def.engine.electric = ElectricMotorDef{.torque = 250, .power = 90e3f, .regeneration = 0.4f};
    def.engine.limiterRpm = 14000;
    def.gearbox.ratios = {2.0f};
    Road road;
    Vehicle car(road.world, def, {.position = {0, 0, -500}});
    car.input = {.throttle = 1};
    run(road.world, 12);
    const double top = car.telemetry().energy.engine;
    const double kinetic = static_cast<double>(car.telemetry().kineticEnergy);
    EXPECT_GT(car.telemetry().speed, 25);
    car.input = {};
    run(road.world, 60);
    EXPECT_NEAR(car.telemetry().speed, 0, 0.3);
    const double back = top - car.telemetry().energy.engine;
    EXPECT_GT(back, 0.4 * kinetic);
    EXPECT_LT(back, kinetic);
}

/// Pads on slopes and stops: what discs hold is what pads took less what the air did, and what stands cools as
/// (1 + h k/C)⁻ⁿ.
TEST(BrakeHeat, IsTheWorkOfThePadsLessWhatTheAirTook) {
    VehicleDef def = hatchback();
    constexpr float kCapacity = 4000, kCooling = 40;
    for (WheelDef& wheel : def.wheels) {
        wheel.brakeHeatCapacity = kCapacity;
        wheel.brakeCooling = wheel.brakeCoolingPerSpeed = 0;
    }
    const auto heat = [](const Vehicle& car) {
        double sum = 0;
        for (const WheelTelemetry& wheel : car.telemetry().wheels)
            sum += static_cast<double>(kCapacity * wheel.brakeTemperature);
        return sum;
    };
    for (const double hz : {30.0, 60.0, 120.0}) {
        Road road(0, awake());
        Vehicle car(road.world, def, {.speed = 30});
        car.input = {.brake = 0.4f, .clutch = 1};
        run(road.world, 10, 1 / hz);
        // Half of the energy at first, at least; what is told is rounded to single precision.
        EXPECT_GT(heat(car), 0.5 * 0.5 * 1200 * 900);
        EXPECT_NEAR(heat(car), car.telemetry().energy.brakes, 1e-6 * heat(car));

        VehicleDef airy = def;
        for (WheelDef& wheel : airy.wheels) wheel.brakeCooling = kCooling;
        const double before = heat(car);
        car.setDef(airy);
        run(road.world, 20, 1 / hz);
        const double h = 1 / (hz * road.world.settings().substeps), steps = 20 / h;
        const double left = std::exp(-steps * std::log1p(h * static_cast<double>(kCooling / kCapacity)));
        EXPECT_NEAR(heat(car), before * left, 1e-4 * before);
    }
}

TEST(BrakeHeat, TakesTorqueOfPadsThatFade) {
    VehicleDef def = hatchback();
    for (WheelDef& wheel : def.wheels) {
        wheel.brakeHeatCapacity = 4000;
        wheel.brakeCooling = wheel.brakeCoolingPerSpeed = 0;
        wheel.brakeFade = 0.01f;
    }
    Road road(0, awake());
    Vehicle car(road.world, def, {.speed = 30});
    car.input = {.brake = 0.2f, .clutch = 1};
    run(road.world, 3, 1.0 / 60);
    for (std::size_t i = 0; i < def.wheels.size(); ++i) {
        const WheelTelemetry& wheel = car.telemetry().wheels[i];
        ASSERT_GT(wheel.brakeTemperature, 3);
        const float pads = 0.2f * def.wheels[i].brakeTorque / (1 + 0.01f * wheel.brakeTemperature);
        const float rolls = def.wheels[i].tire.rollingResistance * wheel.load * wheel.radius;
        // A step's heat changes pads by less than a thousandth.
        EXPECT_NEAR(-wheel.brakeTorque, pads + rolls, 2e-3f * pads);
    }
    // A save holds it.
    std::vector<std::byte> saved(road.world.saveSize());
    road.world.save(saved);
    const float warm = car.telemetry().wheels[0].brakeTemperature;
    run(road.world, 1, 1.0 / 60);
    EXPECT_GT(car.telemetry().wheels[0].brakeTemperature, warm);
    road.world.restore(saved);
    EXPECT_EQ(car.telemetry().wheels[0].brakeTemperature, warm);
}

}  // namespace
}  // namespace ragtop
