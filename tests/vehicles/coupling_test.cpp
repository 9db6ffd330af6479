#include "coupling.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "drive_stand.h"
#include "engine.h"

namespace ragtop {
namespace {

VehicleDef withCoupling(CouplingType type) {
    VehicleDef def = withDifferential(DifferentialType::open);
    def.gearbox.coupling = type;
    def.engine.torqueCurve = {{0, 120}};
    return def;
}

/// Against brakes that hold, K(0) ω² is the engine's torque, and the gears get R(0) times it.
TEST(Converter, StallsWhereItTakesTheEnginesTorque) {
    const VehicleDef def = withCoupling(CouplingType::converter);
    Stand stand(def);
    for (int i = 0; i < 2400; ++i) stand.step({.throttle = 1, .brake = 1}, {});
    const ConverterPoint stalled = def.gearbox.converterMap.front();
    const double speed = std::sqrt(120 / static_cast<double>(stalled.capacity));
    EXPECT_NEAR(stand.drivetrain.engineSpeed, speed, 1e-3 * speed);
    const double held = -static_cast<double>(stand.drivetrain.brake[0] + stand.drivetrain.brake[1]);
    const double asked = 120 * static_cast<double>(stalled.torqueRatio * gearing(def.gearbox, 1));
    EXPECT_NEAR(held, asked, 2e-3 * asked);
}

/// Steadily driven at a speed ratio between two points of the map it passes what the map says.
TEST(Converter, PassesWhatItsMapSays) {
    const VehicleDef def = withCoupling(CouplingType::converter);
    for (const float ratio : {0.0f, 0.3f, 0.6f, 0.7f, 0.9f}) {
        const ConverterPoint point = converterAt(def.gearbox, ratio);
        const float pump = 200;
        const CouplingLaw law = couplingLaw(def, {.engineSpeed = pump, .shaftSpeed = ratio * pump});
        EXPECT_NEAR((pump - ratio * pump) / law.give, point.capacity * pump * pump,
                    1e-4f * point.capacity * pump * pump);
        EXPECT_FLOAT_EQ(law.torqueRatio, point.torqueRatio);
    }
    EXPECT_FLOAT_EQ(converterAt(def.gearbox, 0.3f).torqueRatio, 1.7f);
}

/// Also of a shaft in reverse, which stands at −0, and of an engine that has all but stopped.
TEST(Converter, PassesWhatIsANumberAtAnySpeeds) {
    const VehicleDef def = withCoupling(CouplingType::converter);
    const float most = def.gearbox.converterMap.front().torqueRatio;
    for (const float engine : {0.0f, 1e-42f, 1e-30f, 1e-15f, 1.0f, 1e4f}) {
        for (const float shaft : {-0.0f, 0.0f, -1e-42f, 1e-42f, -1.0f, 1e-15f, 200.0f}) {
            for (const float pedal : {0.0f, 0.999f, 1.0f}) {
                const CouplingLaw law = couplingLaw(def, {.engineSpeed = engine, .shaftSpeed = shaft, .pedal = pedal});
                EXPECT_TRUE(std::isfinite(law.give)) << engine << " " << shaft << " " << pedal;
                EXPECT_GE(law.torqueRatio, 1) << engine << " " << shaft << " " << pedal;
                EXPECT_LE(law.torqueRatio, most) << engine << " " << shaft << " " << pedal;
            }
        }
    }
}

TEST(Converter, IsBridgedFromItsLockUpRatio) {
    VehicleDef def = withCoupling(CouplingType::converter);
    def.gearbox.lockUpRatio = 0.85f;
    Stand stand(def);
    stand.turnAt(3, 60);
    stand.drivetrain.engineSpeed *= 1.1f;
    for (int i = 0; i < 48; ++i) stand.step({.throttle = 0.2f}, {-40, -40});
    const float shaft = stand.drivetrain.shaftSpeed(def.gearbox);
    EXPECT_NEAR(stand.drivetrain.engineSpeed, shaft, 1e-3f * shaft);
    def.gearbox.lockUpRatio.reset();
    Stand fluid(def);
    fluid.turnAt(3, 60);
    for (int i = 0; i < 48; ++i) fluid.step({.throttle = 0.2f}, {-40, -40});
    EXPECT_GT(fluid.drivetrain.engineSpeed, 1.01f * fluid.drivetrain.shaftSpeed(def.gearbox));
}

/// The engine comes to the new gear's speed at the end of the shift, and the wheels are driven all the while.
TEST(DualClutch, HandsOverWithoutAPauseInDrive) {
    VehicleDef def = withCoupling(CouplingType::dualClutch);
    def.gearbox.shiftTime = 0.2f;
    Stand stand(def);
    stand.turnAt(2, 60);
    stand.drivetrain.gearbox.gear = 3;
    stand.drivetrain.gearbox.shiftTimer = def.gearbox.shiftTime;
    const float apart = stand.drivetrain.engineSpeed - stand.drivetrain.shaftSpeed(def.gearbox);
    ASSERT_GT(apart, 100);
    for (int i = 1; stand.drivetrain.gearbox.shiftTimer > 0; ++i) {
        stand.step({.throttle = 1}, {-300, -300});
        EXPECT_GT(stand.drivetrain.clutch, 110);
        const float slip = stand.drivetrain.engineSpeed - stand.drivetrain.shaftSpeed(def.gearbox);
        // The rest is gone by the share h/t of each step, the wheels' own change of speed coming besides.
        EXPECT_LT(slip, apart * (1 - static_cast<float>(i - 2) * kSubstep / def.gearbox.shiftTime));
        stand.drivetrain.gearbox.shiftTimer = std::max(stand.drivetrain.gearbox.shiftTimer - kSubstep, 0.0f);
    }
    EXPECT_NEAR(stand.drivetrain.engineSpeed, stand.drivetrain.shaftSpeed(def.gearbox), 0.05f * apart);

    def.gearbox.coupling = CouplingType::clutch;
    Stand single(def);
    single.turnAt(2, 60);
    single.drivetrain.gearbox = {.gear = 3, .shiftTimer = 0.2f};
    single.step({.throttle = 1}, {});
    EXPECT_EQ(single.drivetrain.clutch, 0);
}

/// While its ratios last the engine stays at the speed for its throttle, whatever the car does.
TEST(ContinuousGearbox, HoldsTheEngineAtTheSpeedForItsThrottle) {
    VehicleDef def = withCoupling(CouplingType::clutch);
    GearboxDef& box = def.gearbox;
    box.continuous = true;
    box.automatic = true;
    box.shiftTime = 1;
    GearboxState state;
    const float rpm = box.shiftDownRpm + 0.6f * (box.shiftUpRpm - box.shiftDownRpm);
    for (int i = 0; i < 6000; ++i) {
        const float axle = 0.025f * static_cast<float>(i);
        shift(box, state, {}, axle, 0.6f, kSubstep);
        EXPECT_EQ(state.gear, 1);
        const float engine = revolutionsPerMinute(axle * gearing(box, state));
        const float wanted = std::clamp(rpm, revolutionsPerMinute(axle * box.ratios.back() * box.finalDrive),
                                        revolutionsPerMinute(axle * box.ratios.front() * box.finalDrive));
        EXPECT_NEAR(engine, wanted, 0.01f * rpm) << axle;
    }
    EXPECT_FLOAT_EQ(state.ratio, box.ratios.back());
    const float before = state.ratio;
    shift(box, state, {}, 10, 1, kSubstep);
    EXPECT_NEAR(state.ratio - before, kSubstep * (box.ratios.front() - box.ratios.back()), 1e-5f);
}

TEST(ElectricMotor, HasLevelTorqueAndThenLevelPower) {
    VehicleDef def = withCoupling(CouplingType::clutch);
    def.engine.electric = ElectricMotorDef{.torque = 250, .power = 80e3f, .regeneration = 0.4f};
    def.engine.limiterRpm = 15000;
    for (const float speed : {-100.0f, 0.0f, 300.0f}) EXPECT_FLOAT_EQ(fullTorque(def.engine, speed), 250);
    for (const float speed : {-800.0f, 400.0f, 1200.0f})
        EXPECT_FLOAT_EQ(fullTorque(def.engine, speed), 80e3f / std::abs(speed));

    // Free of load it takes I ω²/2 of work to a speed: the time of both parts follows from torque and power.
    Stand stand(def);
    stand.drivetrain.gearbox.gear = 0;
    EXPECT_EQ(stand.drivetrain.engineSpeed, 0);
    const double I = static_cast<double>(def.engine.inertia), base = 320, last = 900;
    const double seconds = I * base / 250 + I * (last * last - base * base) / (2 * 80e3);
    const int steps = static_cast<int>(std::lround(seconds * 240));
    for (int i = 0; i < steps; ++i) stand.step({.throttle = 1}, {});
    // Torque is taken at the beginning of each step: half a step's worth of its fall.
    EXPECT_NEAR(stand.drivetrain.engineSpeed, last, 0.01 * last);
}

/// It brakes by a share of its torque, gives the energy back, and stands when it has stopped.
TEST(ElectricMotor, GivesBackWhatItBrakes) {
    VehicleDef def = withCoupling(CouplingType::clutch);
    def.engine.electric = ElectricMotorDef{.torque = 250, .power = 80e3f, .regeneration = 0.4f};
    Stand stand(def);
    stand.turnAt(1, 10);
    stand.drivetrain.spin[2] = stand.drivetrain.spin[3] = 0;
    const double before = stand.drivetrain.rotatingEnergy(def.engine);
    stand.step({}, {});
    EXPECT_NEAR(stand.drivetrain.engine.friction, -0.4f * 250, 1e-3f);
    for (int i = 0; i < 480; ++i) stand.step({}, {});
    EXPECT_NEAR(stand.drivetrain.engineSpeed, 0, 1e-4f);
    EXPECT_NEAR(stand.drivetrain.work.engine, -before, 1e-3 * before);
}

/// b = 1 − e^(−t/τ), and the torque lacks the share of the turbo times the rest.
TEST(Turbo, BoostGoesTowardsTheThrottleInItsTime) {
    VehicleDef def = withCoupling(CouplingType::clutch);
    def.engine.turbo = TurboDef{.share = 0.5f, .spoolTime = 0.5f};
    def.engine.limiterRpm = 1e6f;
    Stand stand(def);
    stand.drivetrain.gearbox.gear = 0;
    const double from = static_cast<double>(stand.drivetrain.engineSpeed);
    for (int i = 0; i < 240; ++i) stand.step({.throttle = 1}, {});
    const double h = static_cast<double>(kSubstep), left = std::pow(1 + h / 0.5, -240);
    EXPECT_NEAR(left, std::exp(-2.0), 0.01);
    EXPECT_NEAR(stand.drivetrain.boost, 1 - left, 1e-5);
    // Σ h (1 − (1 − b)/2) with 1 − b = (1 + h/τ)^−i.
    const double torqueSeconds = 120 * (1 - 0.5 * 0.5 * (1 - left));
    EXPECT_NEAR(stand.drivetrain.engineSpeed - from, torqueSeconds / static_cast<double>(def.engine.inertia), 0.1);
}

TEST(Engine, ResistsByWhatGrowsWithItsSpeedToo) {
    VehicleDef def = withCoupling(CouplingType::clutch);
    def.engine.brakeViscosity = 0.1f;
    Stand stand(def);
    stand.drivetrain.gearbox.gear = 0;
    stand.drivetrain.engineSpeed = 500;
    stand.step({}, {});
    EXPECT_NEAR(stand.drivetrain.engine.friction, -(def.engine.brakeTorque + 50), 1e-3f);
}

TEST(DirectDrive, TurnsEachWheelByItsOwnTorque) {
    Stand stand(withCoupling(CouplingType::clutch));
    stand.drivetrain.gearbox.gear = 0;
    const float torques[] = {40, -20, 10, 0};
    const double idling = stand.drivetrain.rotatingEnergy(stand.def.engine);
    for (int i = 0; i < 120; ++i) stand.step({.wheelTorques = torques}, {});
    double turning = 0;
    for (std::size_t i = 0; i < 4; ++i) {
        const double speed = 0.5 * static_cast<double>(torques[i] / stand.drivetrain.inertia()[i]);
        EXPECT_NEAR(stand.drivetrain.spin[i], speed, 1e-4 * std::abs(speed));
        turning += 0.5 * static_cast<double>(stand.drivetrain.inertia()[i]) * speed * speed;
    }
    const double gained = stand.drivetrain.rotatingEnergy(stand.def.engine) - idling;
    EXPECT_NEAR(gained, turning, 1e-3 * turning);
    EXPECT_NEAR(stand.drivetrain.work.engine, gained, 1e-4 * turning);
}

/// Whatever couples and however it is driven: the engine's work is in what turns, in each loss, or on the road; and a
/// coupling, a differential and pads only lose.
TEST(DriveWork, IsInWhatTurnsOrLost) {
    for (const CouplingType coupling : {CouplingType::clutch, CouplingType::dualClutch, CouplingType::converter}) {
        for (std::size_t type = 0; type < enumNames(DifferentialType{}).size(); ++type) {
            VehicleDef def = withCoupling(coupling);
            def.gearbox.efficiency = 0.9f;
            def.gearbox.lockUpRatio = 0.9f;
            def.differential.type = static_cast<DifferentialType>(type);
            def.engine.turbo = TurboDef{};
            Stand stand(def);
            std::ranges::fill(stand.resistances, 20.0f);
            std::mt19937 dice(static_cast<unsigned>(type));
            std::uniform_real_distribution<float> any(0, 1);
            const DriveWork& work = stand.drivetrain.work;
            const double before = stand.drivetrain.rotatingEnergy(def.engine);
            double through = 0, last = 0;
            for (int i = 0; i < 960; ++i) {
                if (i % 60 == 0)
                    stand.drivetrain.gearbox = {.gear = i / 240 + 1, .shiftTimer = i % 240 == 0 ? 0.2f : 0};
                const float road = -150 * any(dice);
                const DrivetrainInput input{.throttle = any(dice), .brake = i % 200 < 20 ? 0.2f : 0, .lock = any(dice)};
                stand.step(input, {road, 0.3f * road});
                through += std::abs(work.engine - last);
                last = work.engine;
            }
            const double lost = work.clutch + work.gears + work.differentials + work.brakes + work.rolling;
            const double kept = stand.drivetrain.rotatingEnergy(def.engine) - before - stand.road;
            for (const double loss : {work.clutch, work.gears, work.differentials, work.brakes, work.rolling})
                EXPECT_GE(loss, 0);
            EXPECT_GT(through, 1e4);
            EXPECT_NEAR(work.engine, kept + lost, 1e-5 * through)
                << enumNames(CouplingType{})[static_cast<std::size_t>(coupling)];
        }
    }
}

}  // namespace
}  // namespace ragtop
