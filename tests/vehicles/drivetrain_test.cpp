#include "drivetrain.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "engine.h"
#include "gearbox.h"
#include "hatchback.h"

namespace ragtop {
namespace {

constexpr float kStep = 1.0f / 240;

/// A drivetrain on a stand: rolls that turn freely, each held back by a torque.
struct Stand {
    VehicleDef def;
    Drivetrain drivetrain;
    std::vector<float> resistances;

    explicit Stand(const VehicleDef& d) : def(d), drivetrain(d), resistances(d.wheels.size(), 0.0f) {}

    void step(const DrivetrainInput& input, const std::vector<float>& torque) {
        for (std::size_t i = 0; i < torque.size(); ++i) {
            drivetrain.spin[i] += kStep * torque[i] / drivetrain.inertia()[i];
        }
        drivetrain.begin(def, input, resistances, kStep);
        for (int i = 0; i < 200; ++i) {
            if (drivetrain.sweep(def, kStep) <= 1e-6f * kStep) break;
        }
        drivetrain.end(kStep);
    }
    void turnAt(int gear, float axleSpeed) {
        drivetrain.gearbox.gear = gear;
        drivetrain.engineSpeed = gearing(def.gearbox, gear) * axleSpeed;
        for (float& spin : drivetrain.spin) spin = axleSpeed;
    }
};

VehicleDef withDifferential(DifferentialType type) {
    VehicleDef def = hatchback();
    def.differential.type = type;
    def.gearbox.automatic = false;
    def.gearbox.efficiency = 1;
    return def;
}

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

/// Torque at a wheel: what it does to a freely turning one plus what the stand takes.
TEST(Differential, OpenGivesEqualTorques) {
    Stand stand(withDifferential(DifferentialType::open));
    stand.turnAt(2, 40);
    const std::vector<float> road{-30, -300};
    const std::vector<float> before = stand.drivetrain.spin;
    for (int i = 0; i < 24; ++i) stand.step({.throttle = 1}, road);
    std::vector<double> torque;
    for (std::size_t i = 0; i < 2; ++i) {
        const double change = stand.drivetrain.spin[i] - before[i];
        torque.push_back(change * stand.drivetrain.inertia()[i] / (24 * kStep) - road[i]);
    }
    EXPECT_GT(torque[0], 100);
    EXPECT_NEAR(torque[0], torque[1], 1e-3 * torque[0]);
    EXPECT_GT(stand.drivetrain.spin[0], stand.drivetrain.spin[1] + 1);
}

TEST(Differential, LockedGivesEqualSpeeds) {
    Stand stand(withDifferential(DifferentialType::locked));
    stand.turnAt(2, 40);
    for (int i = 0; i < 24; ++i) {
        stand.step({.throttle = 1}, {-30, -300});
        ASSERT_NEAR(stand.drivetrain.spin[0], stand.drivetrain.spin[1], 1e-3f);
    }
}

/// A clutch pack that slips passes exactly preload + ratio · torque of the axle.
TEST(Differential, LimitedSlipSharesTorqueByPreloadAndRatio) {
    Stand stand(withDifferential(DifferentialType::limitedSlip));
    stand.turnAt(2, 40);
    for (int i = 0; i < 12; ++i) stand.step({.throttle = 1}, {0, -600});
    const float axleTorque = gearing(stand.def.gearbox, 2) * stand.drivetrain.clutch;
    const DifferentialDef& d = stand.def.differential;
    EXPECT_GT(stand.drivetrain.spin[0], stand.drivetrain.spin[1] + 1);
    EXPECT_NEAR(-stand.drivetrain.differential[0], d.preload + d.lockingRatio * axleTorque, 0.01f * axleTorque);

    Stand gripping(withDifferential(DifferentialType::limitedSlip));
    gripping.turnAt(2, 40);
    for (int i = 0; i < 24; ++i) gripping.step({.throttle = 1}, {-180, -220});
    EXPECT_NEAR(gripping.drivetrain.spin[0], gripping.drivetrain.spin[1], 1e-3f);
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
        drivetrain.begin(def, {}, stand.resistances, kStep);
        float tires[2] = {};
        for (int sweep = 0; sweep < sweeps; ++sweep) {
            for (std::size_t i = 0; i < 2; ++i) {
                const float inertia = drivetrain.inertia()[i];
                const float free = drivetrain.spin[i] + radius * tires[i] / inertia;
                tires[i] = kGrip * (radius * free - kTravel) / (1 + kGrip * radius * radius / inertia);
                drivetrain.spin[i] = free - radius * tires[i] / inertia;
                drivetrain.grip(i, radius, kGrip);
            }
            drivetrain.sweep(def, kStep);
        }
        return tires[0];
    };
    EXPECT_GT(swept(200), 1);
    EXPECT_NEAR(swept(4), swept(200), 1e-3f * swept(200));
}

}  // namespace
}  // namespace ragtop
