#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <string>

#include "road.h"

/// Cars among things that nobody has placed for them: what they meet is no source of energy, whatever it is.
namespace ragtop {
namespace {

struct ObstacleDice {
    std::mt19937 engine;
    double between(double from, double to) { return std::uniform_real_distribution<double>(from, to)(engine); }
    float number(double from, double to) { return static_cast<float>(between(from, to)); }
    bool coin() { return between(0, 1) < 0.5; }
};

/// All that moves and all that is wound up, less what engine and motors gave, J.
double ungivenEnergy(const World& world, const Vehicle& car) {
    const EnergyTelemetry& energy = car.telemetry().energy;
    return world.energy() + energy.rotating + energy.elastic - energy.engine;
}

/// Stumps and lumps to two thirds of a wheel's radius, most of them met by one wheel only.
void addLumps(World& world, ObstacleDice& dice, float radius) {
    for (int i = 0; i < 24; ++i) {
        const DVec3 at{dice.between(-1.2, 1.2), 0, 3 + dice.between(0, 20)};
        if (dice.coin()) {
            world.create(StaticBody{.shape = Sphere{dice.number(0.2, 1.2) * radius},
                                    .position = at - DVec3{0, 0.3 * static_cast<double>(radius), 0}});
        } else {
            const Vec3 half{dice.number(0.1, 1), dice.number(0.1, 0.6) * radius, dice.number(0.05, 0.6)};
            world.create(StaticBody{
                .shape = Box{half}, .position = at, .rotation = rotationAbout({0, 1, 0}, dice.number(-3, 3))});
        }
    }
}

void addRubble(World& world, ObstacleDice& dice, float radius) {
    for (int i = 0; i < 40; ++i) {
        const float size = dice.number(0.1, 0.8) * radius;
        DynamicBody body;
        body.shape = dice.coin() ? Shape{Box{{size, dice.number(0.3, 1) * size, size}}} : Shape{Sphere{size}};
        body.density = dice.number(50, 2000);
        body.position = {dice.between(-2, 2), static_cast<double>(size) + dice.between(0, 0.6),
                         4 + dice.between(0, 12)};
        world.create(body);
    }
}

struct DrawnRun {
    VehicleDef def = hatchback();
    double dt = kStep;
    float speed = 0;
};

DrawnRun draw(ObstacleDice& dice) {
    DrawnRun drawn;
    if (dice.coin()) drawn.def.level = VehicleLevel::rays;
    const double steps[] = {1.0 / 30, 1.0 / 60, 1.0 / 120, 1.0 / 240};
    drawn.dt = steps[static_cast<std::size_t>(dice.between(0, 3.999))];
    const float frequency = dice.number(0.6, 6), damping = dice.number(0, 1);
    for (WheelDef& wheel : drawn.def.wheels) {
        wheel.suspension.frequency = frequency;
        wheel.suspension.dampingRatio = damping;
    }
    drawn.speed = dice.number(0.5, 18);
    return drawn;
}

/// Over what it had: of 1 % of speed and weight, and of any one step.
void expectNoGain(World& world, Vehicle& car, const DrawnRun& drawn, float speed) {
    world.step(drawn.dt);  // Springs that are held until now count from here on.
    const double first = ungivenEnergy(world, car), mass = static_cast<double>(drawn.def.chassis.mass);
    const double had = mass * (0.5 * static_cast<double>(speed * speed) + 9.81 * 0.5);
    double most = first;
    for (double t = 0; t < 5; t += drawn.dt) {
        world.step(drawn.dt);
        most = std::max(most, ungivenEnergy(world, car) - 0.005 * std::max(car.telemetry().energy.engine, 0.0));
    }
    EXPECT_LT(most - first, 0.005 * had) << "level " << static_cast<int>(drawn.def.level) << ", " << drawn.dt << " s, "
                                         << speed << " m/s";
}

TEST(VehicleObstacles, GiveARollingCarNoEnergy) {
    for (unsigned seed = 1; seed <= 24; ++seed) {
        SCOPED_TRACE("seed " + std::to_string(seed));
        ObstacleDice dice{std::mt19937(seed)};
        const DrawnRun drawn = draw(dice);
        Road road;
        addLumps(road.world, dice, drawn.def.wheels[0].radius);
        Vehicle car(road.world, drawn.def, {.speed = drawn.speed});
        car.input.gear = 0;
        if (dice.coin()) car.input.steer = dice.number(-1, 1);
        expectNoGain(road.world, car, drawn, drawn.speed);
    }
}

TEST(VehicleObstacles, ThatAreLooseGiveADrivenCarNoEnergy) {
    for (unsigned seed = 1; seed <= 16; ++seed) {
        SCOPED_TRACE("seed " + std::to_string(seed));
        ObstacleDice dice{std::mt19937(seed)};
        const DrawnRun drawn = draw(dice);
        Road road;
        addRubble(road.world, dice, drawn.def.wheels[0].radius);
        Vehicle car(road.world, drawn.def, {.speed = 0.5f * drawn.speed});
        car.input.throttle = dice.number(0.3, 1);
        if (dice.coin()) car.input.steer = dice.number(-1, 1);
        expectNoGain(road.world, car, drawn, 0.5f * drawn.speed);
    }
}

/// A car of which wheels are in the ground is pushed out by its bodywork, and its wheels come out of it as they are.
TEST(VehicleObstacles, InWhichWheelsArePutDoNotShootThemOut) {
    for (const VehicleLevel level : {VehicleLevel::rays, VehicleLevel::full}) {
        for (int k = 0; k < 12; ++k) {
            ObstacleDice dice{std::mt19937(static_cast<unsigned>(k))};
            VehicleDef def = hatchback();
            def.level = level;
            Road road;
            Vehicle car(road.world, def);
            const Quat attitude = rotationAbout({dice.number(-1, 1), dice.number(-1, 1), dice.number(-1, 1)}, 1.4f);
            road.world.setPose(car.chassis(), {{0, 1.1, 0}, attitude});
            car.input.brake = 1;
            double most = 0;
            for (double t = 0; t < 2; t += kStep) {
                road.world.step(kStep);
                most = std::max(most, road.world.pose(car.chassis()).position.y);
            }
            EXPECT_LT(most, 2.0) << k << " at level " << static_cast<int>(level);
        }
    }
}

}  // namespace
}  // namespace ragtop
