#pragma once

#include "ragtop/vehicle_def.h"

namespace ragtop {

/// A front-driven hatchback, made in code so that these tests read no files.
inline VehicleDef hatchback() {
    VehicleDef def;
    def.name = "hatchback";
    def.chassis.shapes = {{Box{{0.80f, 0.25f, 1.90f}}, {{0, 0.55f, 0}, {}}},
                          {Box{{0.65f, 0.25f, 1.00f}}, {{0, 1.05f, -0.30f}, {}}}};
    def.chassis.mass = 1200;
    def.chassis.centerOfMass = Vec3{0, 0.52f, 0.12f};
    def.chassis.inertia = Vec3{1500, 1700, 420};
    WheelDef wheel;
    wheel.radius = 0.30f;
    wheel.width = 0.195f;
    wheel.mass = 17;
    wheel.position = {0.74f, 0.30f, 1.26f};
    wheel.steerFactor = 1;
    wheel.driveShare = 1;
    wheel.brakeTorque = 2000;
    wheel.axle = 0;
    for (const float side : {0.74f, -0.74f}) {
        wheel.position.x = side;
        def.wheels.push_back(wheel);
    }
    wheel.position.z = -1.26f;
    wheel.steerFactor = wheel.driveShare = 0;
    wheel.brakeTorque = 1000;
    wheel.handbrakeTorque = 1500;
    wheel.axle = 1;
    for (const float side : {0.74f, -0.74f}) {
        wheel.position.x = side;
        def.wheels.push_back(wheel);
    }
    return def;
}

inline constexpr float kHatchbackWheelbase = 2.52f;

}  // namespace ragtop
