#pragma once

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

}  // namespace ragtop
