#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "drive_stand.h"
#include "engine.h"
#include "gearbox.h"

namespace ragtop {
namespace {

TEST(Engine, FollowsItsTorqueCurve) {
    EngineDef def;
    def.torqueCurve = {{1000, 100}, {3000, 200}, {5000, 150}};
    EXPECT_FLOAT_EQ(fullTorque(def, radiansPerSecond(500)), 100);
    EXPECT_FLOAT_EQ(fullTorque(def, radiansPerSecond(2000)), 150);
    EXPECT_FLOAT_EQ(fullTorque(def, radiansPerSecond(4000)), 175);
    EXPECT_FLOAT_EQ(fullTorque(def, radiansPerSecond(9000)), 150);
    EXPECT_FLOAT_EQ(peakTorque(def), 200);
}

TEST(Engine, IdlesAndKeepsToItsLimiter) {
    Stand stand(withDifferential(DifferentialType::open));
    stand.drivetrain.gearbox.gear = 0;
    stand.drivetrain.engineSpeed = 0;
    for (int i = 0; i < 480; ++i) stand.step({}, {});
    EXPECT_NEAR(revolutionsPerMinute(stand.drivetrain.engineSpeed), stand.def.engine.idleRpm, 0.1);
    for (int i = 0; i < 960; ++i) stand.step({.throttle = 1}, {});
    EXPECT_NEAR(revolutionsPerMinute(stand.drivetrain.engineSpeed), stand.def.engine.limiterRpm, 1);
}

/// Free revving: I dω/dt = T(ω), so a level torque reaches ω after I Δω/T.
TEST(Engine, RevsUpByTorqueOverInertia) {
    VehicleDef def = withDifferential(DifferentialType::open);
    def.engine.torqueCurve = {{0, 100}};
    Stand stand(def);
    stand.drivetrain.gearbox.gear = 0;
    stand.drivetrain.engineSpeed = 200;
    for (int i = 0; i < 48; ++i) stand.step({.throttle = 1}, {});
    EXPECT_NEAR(stand.drivetrain.engineSpeed, 200 + 0.2 * 100 / def.engine.inertia, 0.01);
}

TEST(Gearbox, TopGearTurnsTheEngineByItsRatio) {
    Stand stand(withDifferential(DifferentialType::open));
    const int top = static_cast<int>(stand.def.gearbox.ratios.size());
    stand.turnAt(top, 100);
    const float brake = -40;
    for (int i = 0; i < 240; ++i) stand.step({.throttle = 0.3f}, {brake, brake});
    const float axle = 0.5f * (stand.drivetrain.spin[0] + stand.drivetrain.spin[1]);
    const float ratio = stand.def.gearbox.ratios.back() * stand.def.gearbox.finalDrive;
    EXPECT_NEAR(stand.drivetrain.engineSpeed / axle, ratio, 1e-4f * ratio);
}

TEST(Gearbox, ShiftsUpAndDownWithoutHunting) {
    GearboxDef def;
    GearboxState state;
    int changes = 0, highest = 1;
    const auto drive = [&](float from, float to) {
        for (int i = 0; i <= 3000; ++i) {
            const int before = state.gear;
            shift(def, state, {}, from + (to - from) * static_cast<float>(i) / 3000, 0.7f, 0.01f);
            changes += state.gear != before ? 1 : 0;
            highest = std::max(highest, state.gear);
        }
    };
    const int gears = static_cast<int>(def.ratios.size());
    drive(0, 200);
    EXPECT_EQ(highest, gears);
    EXPECT_EQ(changes, gears - 1);
    drive(200, 0);
    EXPECT_EQ(state.gear, 1);
    EXPECT_EQ(changes, 2 * (gears - 1));
}

/// To the nearest step, whatever is left of it by rounding.
TEST(Gearbox, ChangesInTheTimeThatItIsGiven) {
    for (const float time : {0.0f, 0.05f, 0.1f, 0.25f, 0.3f, 1.0f}) {
        for (const int hz : {24, 30, 60, 90, 120, 240, 1000}) {
            GearboxDef def;
            def.shiftTime = time;
            const float dt = 1 / static_cast<float>(hz);
            GearboxState state;
            shift(def, state, 1, 0, 0, dt);
            shift(def, state, 2, 0, 0, dt);
            int steps = 0;
            for (; state.shiftTimer > 0; ++steps) shift(def, state, 2, 0, 0, dt);
            EXPECT_NEAR(static_cast<float>(steps) * dt, time, 0.501f * dt) << hz << " Hz";
        }
    }
}

TEST(Gearbox, ObeysTheDriver) {
    GearboxDef def;
    GearboxState state;
    shift(def, state, -1, 0, 0, 0.01f);
    EXPECT_EQ(state.gear, -1);
    EXPECT_LT(gearing(def, state.gear), 0);
    shift(def, state, 99, 0, 0, 0.01f);
    EXPECT_EQ(state.gear, static_cast<int>(def.ratios.size()));
    shift(def, state, 0, 0, 0, 0.01f);
    EXPECT_EQ(gearing(def, state.gear), 0);
}

TEST(Clutch, LeavesTheStandingCarAloneAtIdle) {
    const VehicleDef def = hatchback();
    EXPECT_EQ(clutchCapacity(def, radiansPerSecond(def.engine.idleRpm), 0, 0, 0), 0);
    const float most = 2 * peakTorque(def.engine);
    EXPECT_FLOAT_EQ(clutchCapacity(def, radiansPerSecond(3000), radiansPerSecond(3000), 1, 0), most);
    EXPECT_EQ(clutchCapacity(def, radiansPerSecond(3000), radiansPerSecond(3000), 1, 1), 0);
}

/// A locked brake holds any torque up to its own.
TEST(Brakes, HoldUpToTheirTorqueAndNoMore) {
    Stand stand(withDifferential(DifferentialType::open));
    stand.drivetrain.gearbox.gear = 0;
    const float capacity = stand.def.wheels[0].brakeTorque;
    for (int i = 0; i < 240; ++i) stand.step({.brake = 1}, {0.99f * capacity, -0.99f * capacity});
    EXPECT_NEAR(stand.drivetrain.spin[0], 0, 1e-4);
    EXPECT_NEAR(stand.drivetrain.spin[1], 0, 1e-4);
    for (int i = 0; i < 240; ++i) stand.step({.brake = 1}, {1.01f * capacity});
    EXPECT_NEAR(stand.drivetrain.spin[0], 0.01 * capacity / stand.drivetrain.inertia()[0], 0.1);
}

/// Tires that grip by g of impulse per speed of slip hold light wheels harder than the engine turns them. Shafts that
/// know of it agree with them at once, where visits in turn come nearer by g r²/(I + g r²) each.
TEST(Drivetrain, AgreesWithItsTiresInAFewSweeps) {
    constexpr float kGrip = 40, kTravel = 12;
    VehicleDef def = withDifferential(DifferentialType::open);
    def.gearbox.clutchTorque = 1e6f;
    const auto swept = [&](int sweeps) {
        Stand stand(def);
        Drivetrain& drivetrain = stand.drivetrain;
        const float radius = def.wheels[0].radius;
        stand.turnAt(2, kTravel / radius);
        drivetrain.engineSpeed += 30;
        drivetrain.begin(def, {}, stand.resistances, kSubstep);
        float tires[2] = {};
        for (int sweep = 0; sweep < sweeps; ++sweep) {
            for (std::size_t i = 0; i < 2; ++i) {
                const float inertia = drivetrain.inertia()[i];
                const float free = drivetrain.spin[i] + radius * tires[i] / inertia;
                tires[i] = kGrip * (radius * free - kTravel) / (1 + kGrip * radius * radius / inertia);
                drivetrain.spin[i] = free - radius * tires[i] / inertia;
                drivetrain.grip(i, radius, kGrip);
            }
            drivetrain.sweep(def, kSubstep);
        }
        return tires[0];
    };
    EXPECT_GT(swept(200), 1);
    EXPECT_NEAR(swept(4), swept(200), 1e-3f * swept(200));
}

}  // namespace
}  // namespace ragtop
