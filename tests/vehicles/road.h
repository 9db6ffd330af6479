#pragma once

#include <gtest/gtest.h>

#include <cmath>

#include "hatchback.h"
#include "ragtop/vehicle.h"
#include "ragtop/world.h"

namespace ragtop {

inline constexpr double kStep = 1.0 / 60;
inline constexpr float kGravity = 9.81f;

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

inline WorldSettings awake() {
    WorldSettings settings;
    settings.sleeping = false;
    return settings;
}

inline VehicleDef plainTires(float friction) {
    VehicleDef def = hatchback();
    for (WheelDef& wheel : def.wheels) {
        wheel.tire.longitudinalFriction = wheel.tire.lateralFriction = friction;
        wheel.tire.slidingShare = 1;
        wheel.tire.rollingResistance = 0;
    }
    def.aerodynamics.dragArea = 0;
    return def;
}

inline float totalLoad(const Vehicle& car) {
    float sum = 0;
    for (const WheelTelemetry& wheel : car.telemetry().wheels) sum += wheel.load;
    return sum;
}

inline void run(World& world, double seconds, double dt = kStep) {
    const int steps = static_cast<int>(std::lround(seconds / dt));
    for (int i = 0; i < steps; ++i) world.step(dt);
}

/// Braked on 30 % it moves by less than 0.1 mm in 20 s, 5 s after it was put there.
inline void expectBrakesHoldOnASlope(const VehicleDef& def) {
    for (const double dt : {1.0 / 30, 1.0 / 60, 1.0 / 120}) {
        Road road(0.3f, awake());
        Vehicle car(road.world, def);
        road.world.setPose(car.chassis(), {DVec3{}, road.tilt});
        car.input.brake = 1;
        run(road.world, 5, dt);
        const DVec3 before = road.world.pose(car.chassis()).position;
        run(road.world, 20, dt);
        EXPECT_LT(length(relative(road.world.pose(car.chassis()).position, before)), 1e-4f) << dt;
    }
}

}  // namespace ragtop
