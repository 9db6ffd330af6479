#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "drive_stand.h"

namespace ragtop {
namespace {

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
        torque.push_back(change * stand.drivetrain.inertia()[i] / (24 * kSubstep) - road[i]);
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

/// How a car on split friction stands: the wheel on ice is free, and the other one is held, or pulled where the car
/// drives the engine.
struct SplitRoad {
    double slipping = 0, gripping = 0;  ///< N m of the drivetrain on the wheels
    float through = 0;                  ///< N m of the engine through the gears
};

SplitRoad onSplitRoad(const VehicleDef& def, const DrivetrainInput& input, float road = -600) {
    constexpr int kSteps = 12;
    Stand stand(def);
    stand.turnAt(2, 40);
    const float apart = road < 0 ? 20 : -20;
    stand.drivetrain.spin[0] += apart;
    stand.drivetrain.spin[1] -= apart;
    stand.step(input, {0, road});
    const std::vector<float> before = stand.drivetrain.spin;
    float through = 0;
    for (int i = 0; i < kSteps; ++i) {
        stand.step(input, {0, road});
        through += gearing(def.gearbox, 2) * stand.drivetrain.clutch / kSteps;
    }
    EXPECT_GT((stand.drivetrain.spin[0] - stand.drivetrain.spin[1]) * apart, 0);
    return {stand.torqueOn(0, before[0], kSteps, 0), stand.torqueOn(1, before[1], kSteps, road), through};
}

/// Impulses of single precision at speeds of 40 rad/s: 12 steps of I ω 6e-8/h.
constexpr double kRounding = 0.05;  // N m

/// Plates that slip let torques differ by exactly preload + ratio · torque, by another ratio when the wheels drive.
TEST(Differential, PlatesLetTorquesDifferByPreloadAndRatio) {
    VehicleDef def = withDifferential(DifferentialType::limitedSlip);
    DifferentialDef& d = def.differential;
    d.coastLockingRatio = 0.1f;
    const SplitRoad driven = onSplitRoad(def, {.throttle = 1}), coasting = onSplitRoad(def, {}, 600);
    EXPECT_GT(driven.through, 500);
    EXPECT_NEAR(driven.gripping - driven.slipping, d.preload + d.lockingRatio * driven.through, kRounding);
    EXPECT_NEAR(driven.gripping + driven.slipping, driven.through, kRounding);
    EXPECT_LT(coasting.through, -100);
    EXPECT_NEAR(coasting.slipping - coasting.gripping, d.preload - *d.coastLockingRatio * coasting.through, kRounding);

    Stand gripping(def);
    gripping.turnAt(2, 40);
    for (int i = 0; i < 24; ++i) gripping.step({.throttle = 1}, {-180, -220});
    EXPECT_NEAR(gripping.drivetrain.spin[0], gripping.drivetrain.spin[1], 1e-3f);
}

TEST(Differential, HelicalGivesTheHeldWheelTheBiasTimesTheOther) {
    VehicleDef def = withDifferential(DifferentialType::helical);
    for (const float bias : {1.0f, 2.5f, 5.0f}) {
        def.differential.torqueBias = bias;
        const SplitRoad road = onSplitRoad(def, {.throttle = 1});
        EXPECT_NEAR(road.gripping, static_cast<double>(bias) * road.slipping,
                    kRounding * static_cast<double>(1 + bias));
        EXPECT_NEAR(road.gripping + road.slipping, road.through, kRounding);
    }
}

TEST(Differential, ActivePassesWhatTheDriverAsksFor) {
    const VehicleDef def = withDifferential(DifferentialType::active);
    for (const float lock : {0.0f, 0.25f}) {
        const SplitRoad road = onSplitRoad(def, {.throttle = 1, .lock = lock});
        EXPECT_NEAR(road.gripping - road.slipping, static_cast<double>(2 * lock * def.differential.activeTorque),
                    2 * kRounding);
        EXPECT_NEAR(road.gripping + road.slipping, road.through, kRounding);
    }
}

/// Without drive the difference of two wheels decays by 1 + 2 h c/I a step, c Δω² being what is lost.
TEST(Differential, ViscousPassesTorqueByTheDifferenceOfSpeeds) {
    VehicleDef def = withDifferential(DifferentialType::viscous);
    Stand stand(def);
    stand.drivetrain.gearbox.gear = 0;
    stand.drivetrain.spin = {50, 30, 0, 0};
    const double before = stand.drivetrain.rotatingEnergy(def.engine);
    constexpr int kSteps = 6;
    for (int i = 0; i < kSteps; ++i) stand.step({}, {});
    const auto& spin = stand.drivetrain.spin;
    const double rate = 2.0 * static_cast<double>(def.differential.viscosity / stand.drivetrain.inertia()[0]);
    EXPECT_NEAR(spin[0] - spin[1], 20 / std::pow(1 + rate * static_cast<double>(kSubstep), kSteps), 1e-4);
    EXPECT_NEAR(spin[0] + spin[1], 80, 1e-4);
    EXPECT_NEAR(stand.drivetrain.work.differentials,
                before + stand.drivetrain.work.engine - stand.drivetrain.rotatingEnergy(def.engine), 1e-3);
}

/// Between axles the same laws hold for the torques of the axles.
TEST(Differential, HelicalBetweenAxlesHoldsForTheirTorques) {
    VehicleDef def = withDifferential(DifferentialType::open);
    for (WheelDef& wheel : def.wheels) wheel.driveShare = 1;
    def.centerDifferential.type = DifferentialType::helical;
    Stand stand(def);
    stand.turnAt(2, 40);
    for (const std::size_t i : {0U, 1U}) stand.drivetrain.spin[i] += 20;
    for (const std::size_t i : {2U, 3U}) stand.drivetrain.spin[i] -= 20;
    const std::vector<float> road{0, 0, -300, -300};
    stand.step({.throttle = 1}, road);
    const std::vector<float> before = stand.drivetrain.spin;
    for (int i = 0; i < 12; ++i) stand.step({.throttle = 1}, road);
    std::vector<double> torque;
    for (std::size_t i = 0; i < 4; ++i) torque.push_back(stand.torqueOn(i, before[i], 12, road[i]));
    const double bias = static_cast<double>(def.centerDifferential.torqueBias);
    EXPECT_GT(torque[0], 50);
    EXPECT_NEAR(torque[2] + torque[3], bias * (torque[0] + torque[1]), 4 * kRounding);
    EXPECT_NEAR(torque[2], torque[3], kRounding);
}

}  // namespace
}  // namespace ragtop
