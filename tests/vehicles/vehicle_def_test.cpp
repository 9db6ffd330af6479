#include <gtest/gtest.h>

#include <functional>
#include <limits>
#include <string>

#include "hatchback.h"

namespace ragtop {
namespace {

TEST(VehicleDef, HatchbackIsValid) { EXPECT_EQ(whyInvalid(hatchback()), ""); }

struct Wrong {
    const char* message;  ///< the beginning
    std::function<void(VehicleDef&)> spoil;
};

TEST(VehicleDef, NamesFieldValueAndWhatIsAllowed) {
    const Wrong cases[] = {
        {"/wheels/1/radius is -0.3 m, must be in [0.001, 1000]", [](VehicleDef& d) { d.wheels[1].radius = -0.3f; }},
        {"/chassis/mass is nan kg, must be in",
         [](VehicleDef& d) { d.chassis.mass = std::numeric_limits<float>::quiet_NaN(); }},
        {"/chassis/shapes is empty", [](VehicleDef& d) { d.chassis.shapes.clear(); }},
        {"/chassis/shapes/0/shape", [](VehicleDef& d) { d.chassis.shapes[0].shape = Sphere{-1}; }},
        {"/chassis/shapes/0/frame/rotation has length 2, must be 1",
         [](VehicleDef& d) { d.chassis.shapes[0].frame.rotation.w = 2; }},
        {"/chassis/inertia/1 is -1 kg m²", [](VehicleDef& d) { d.chassis.inertia->y = -1; }},
        {"/chassis/material/friction is -1, must be in [0, 10]",
         [](VehicleDef& d) { d.chassis.material.friction = -1; }},
        {"/wheels has 2 wheels, must have 3 or more", [](VehicleDef& d) { d.wheels.resize(2); }},
        {"/wheels/0/suspension/travelUp is 0 m", [](VehicleDef& d) { d.wheels[0].suspension.travelUp = 0; }},
        {"/wheels/0/suspension/stiffness is 0 N/m", [](VehicleDef& d) { d.wheels[0].suspension.stiffness = 0.0f; }},
        {"/gearbox/ratios has 1 ratio, must have 2 or more where continuous is true",
         [](VehicleDef& d) {
             d.gearbox.ratios = {3};
             d.gearbox.continuous = true;
         }},
        {"/gearbox/converterMap has 1 points, must have 2 or more",
         [](VehicleDef& d) { d.gearbox.converterMap.resize(1); }},
        {"/gearbox/converterMap/0/speedRatio is 0.1, must be 0 in the first point",
         [](VehicleDef& d) { d.gearbox.converterMap[0].speedRatio = 0.1f; }},
        {"/gearbox/converterMap/2/speedRatio is 0.5, must be above the point before, 0.6",
         [](VehicleDef& d) { d.gearbox.converterMap[2].speedRatio = 0.5f; }},
        {"/gearbox/converterMap/3/speedRatio is 0.9, must be 1 in the last point",
         [](VehicleDef& d) { d.gearbox.converterMap[3].speedRatio = 0.9f; }},
        {"/gearbox/converterMap/1/torqueRatio is 1.8, must be at most 1 over speedRatio, 1.6",
         [](VehicleDef& d) { d.gearbox.converterMap[1].torqueRatio = 1.8f; }},
        {"/gearbox/converterMap/3/capacity is 0.001, must be 0 where speeds are equal",
         [](VehicleDef& d) { d.gearbox.converterMap[3].capacity = 0.001f; }},
        {"/engine/electric/power is 0 W", [](VehicleDef& d) { d.engine.electric = ElectricMotorDef{.power = 0}; }},
        {"/engine/turbo/share is 2, must be in [0, 1]", [](VehicleDef& d) { d.engine.turbo = TurboDef{.share = 2}; }},
        {"/differential/torqueBias is 0.5, must be in [1, 1000]",
         [](VehicleDef& d) { d.differential.torqueBias = 0.5f; }},
        {"/wheels/2/suspension/axis is (1, 0, 0), must be within",
         [](VehicleDef& d) {
             d.wheels[2].suspension.axis = {1, 0, 0};
         }},
        {"/wheels/3/tire/relaxationLength is 0 m", [](VehicleDef& d) { d.wheels[3].tire.relaxationLength = 0; }},
        {"/wheels/1/tire/slidingShare is 1.5, must be in [0.1, 1]",
         [](VehicleDef& d) { d.wheels[1].tire.slidingShare = 1.5f; }},
        {"/wheels/1/tire/surfaces/1/surface is 3, must be that of no other",
         [](VehicleDef& d) {
             d.wheels[1].tire.surfaces = {{.surface = 3}, {.surface = 3}};
         }},
        {"/wheels/2/position makes the wheel carry -",
         [](VehicleDef& d) {
             d.chassis.centerOfMass = Vec3{0, 0.5f, 2};
         }},
        {"/wheels stand in a line",
         [](VehicleDef& d) {
             for (WheelDef& wheel : d.wheels) wheel.position.x = 0;
         }},
        {"/steering/maxAngle is 2 rad, must be in [0, 1.5]", [](VehicleDef& d) { d.steering.maxAngle = 2; }},
        {"/engine/torqueCurve is empty", [](VehicleDef& d) { d.engine.torqueCurve.clear(); }},
        {"/engine/torqueCurve/1/rpm is 800, must be above the point before, 800",
         [](VehicleDef& d) { d.engine.torqueCurve[1].rpm = 800; }},
        {"/engine/torqueCurve/2/torque is -5 N m", [](VehicleDef& d) { d.engine.torqueCurve[2].torque = -5; }},
        {"/engine/limiterRpm is 500, must be above idleRpm, 850", [](VehicleDef& d) { d.engine.limiterRpm = 500; }},
        {"/gearbox/ratios is empty", [](VehicleDef& d) { d.gearbox.ratios.clear(); }},
        {"/gearbox/ratios/1 is 4, must be below the gear before, 3.6", [](VehicleDef& d) { d.gearbox.ratios[1] = 4; }},
        {"/gearbox/efficiency is 1.2, must be in [0.1, 1]", [](VehicleDef& d) { d.gearbox.efficiency = 1.2f; }},
        {"/gearbox/shiftUpRpm is 1000, must be above shiftDownRpm, 1800",
         [](VehicleDef& d) { d.gearbox.shiftUpRpm = 1000; }},
        {"/differential/lockingRatio is 2, must be in [0, 1]", [](VehicleDef& d) { d.differential.lockingRatio = 2; }},
        {"/aerodynamics/dragArea is -1 m²", [](VehicleDef& d) { d.aerodynamics.dragArea = -1; }},
    };
    for (const Wrong& wrong : cases) {
        VehicleDef def = hatchback();
        wrong.spoil(def);
        const std::string why = whyInvalid(def);
        EXPECT_EQ(why.substr(0, std::string(wrong.message).size()), wrong.message) << why;
    }
}

}  // namespace
}  // namespace ragtop
