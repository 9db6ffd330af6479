#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "road.h"
#include "suspension.h"

/// Dampers by curves, stops that yield, and anti-roll bars.
namespace ragtop {
namespace {

constexpr float kStrutLoad = 3000;

/// A strut on a tire that hardly yields.
StrutSpec strutOf(const SuspensionDef& def) {
    WheelDef wheel;
    wheel.suspension = def;
    wheel.tire.radialStiffness = 1e9f;
    return makeStrut(wheel, kStrutLoad, kGravity);
}

SuspensionDef curved() {
    SuspensionDef def;
    def.stiffness = 25000.0f;
    def.travelUp = def.travelDown = 0.2f;
    def.compressionCurve = {{0.05f, 300}, {0.3f, 600}, {1, 800}};
    def.reboundCurve = {{0.1f, 800}, {0.5f, 1400}};
    return def;
}

/// Ground that goes up and down at one speed: what a cycle of stroke a takes is a (D(v) − D(−v)), by the curve, beyond
/// its last point too.
TEST(Damper, DissipatesPerCycleWhatItsCurveSays) {
    const StrutSpec strut = strutOf(curved());
    struct Case {
        float speed, up, down;
    };
    for (const Case& at :
         {Case{0.025f, 150, 200}, Case{0.2f, 480, 950}, Case{0.65f, 700, 1625}, Case{1.2f, 857.1429f, 2450}}) {
        const float h = 1.0f / 1000, amplitude = 40 * h * at.speed;
        float compression = 0;
        double work = 0;
        for (int i = 0; i < 160; ++i) {
            const float way = (i / 40 % 2 == 0 ? 1.0f : -1.0f) * h * at.speed;
            const float squash = squashUnder(strut, springForce(strut, compression) + damperForce(strut, way / h));
            const StrutVisit visit = solveStrut(strut, compression, squash, 1, h, 0, -way / h);
            compression += visit.way;
            work += static_cast<double>(visit.impulse / h * visit.way);
        }
        // Two cycles; the spring of a backward Euler step takes k v² h² more each.
        const double lost = 2 * static_cast<double>(amplitude * (at.up + at.down)) +
                            80 * 25000.0 * static_cast<double>(h * at.speed * h * at.speed);
        EXPECT_NEAR(work, lost, 3e-3 * lost) << at.speed;
        EXPECT_NEAR(damperForce(strut, at.speed), at.up, 1e-3f);
        EXPECT_NEAR(damperForce(strut, -at.speed), -at.down, 1e-3f);
    }
}

/// Backward Euler finds the speed at which the curve, and not one of its lines beyond its ends, balances what presses.
TEST(Damper, FindsTheOneLineOfItsCurveThatHolds) {
    SuspensionDef def = curved();
    def.stiffness = 1e-2f;
    def.springCompression = 0.0f;
    const StrutSpec strut = strutOf(def);
    const float h = 1.0f / 240;
    for (const float force : {100.0f, 450.0f, 700.0f, 1000.0f}) {
        // A tire that is squashed by what the force takes, on ground that gives way to it.
        const float speed = force <= 300   ? force / 6000
                            : force <= 600 ? 0.05f + (force - 300) / 1200
                                           : 0.3f + (force - 600) / (200 / 0.7f);
        const StrutVisit visit = solveStrut(strut, 0, squashUnder(strut, force), 1, h, 0, -speed);
        EXPECT_NEAR(visit.way / h, speed, 2e-3f * speed) << force;
        EXPECT_NEAR(visit.impulse / h, force, 3e-3f * force) << force;
    }
}

/// A tire on ground that stays, squashed by what the closed form says of the strut, moves it no more.
TEST(Stops, BalanceTheForceOfTheirLaw) {
    SuspensionDef def;
    def.stiffness = 25000.0f;
    def.travelUp = 0.08f;
    def.travelDown = 0.1f;
    def.bumpStopStiffness = 4;
    def.bumpStopProgression = 3;
    def.droopStopStiffness = 2.0f;
    def.droopStopProgression = 5;
    def.springCompression = 0.3f;
    const StrutSpec strut = strutOf(def);
    const float k = 25000;
    const auto law = [&](float x) {
        const float s = std::max(x - 0.08f, 0.0f), e = std::max(-0.1f - x, 0.0f);
        return 7500 + k * x + 4 * k * s * (1 + 3 * s / (2 * 0.04f)) - 2 * k * e * (1 + 5 * e / (2 * 0.05f)) +
               20 * 4 * k * std::max(x - 0.12f, 0.0f);
    };
    for (const float x : {-0.12f, -0.09f, 0.0f, 0.07f, 0.09f, 0.11f, 0.13f}) {
        EXPECT_NEAR(springForce(strut, x), law(x), 1e-5f * 30000) << x;
        // From elsewhere it goes there: long steps leave the damper nothing.
        for (const float from : {x, 0.5f * x, x > 0 ? 0.1f : -0.1f}) {
            const float tire = squashUnder(strut, law(x));
            const StrutVisit visit = solveStrut(strut, from, tire + x - from, 1, 1e5f, 0, 0);
            EXPECT_NEAR(from + visit.way, x, 1e-4f) << x << " from " << from;
            EXPECT_NEAR(visit.impulse / 1e5f, law(x), 1e-3f * law(x)) << x << " from " << from;
        }
    }
}

/// Struts without dampers or stops in the way, and the same tires on all wheels.
VehicleDef withBars(float front, float rear) {
    VehicleDef def = plainTires(1);
    def.chassis.centerOfMass = Vec3{0, 0.5f, 0};
    for (WheelDef& wheel : def.wheels) {
        wheel.suspension.stiffness = 30000.0f;
        wheel.suspension.springCompression = {};
    }
    def.antiRollBars = {{0, front}, {1, rear}};
    return def;
}

/// N m/rad of an axle of track t, on springs k, a bar b and tires k_t: t²/2 · 1/(1/(k + 2 b) + 1/k_t).
double rollStiffness(double bar, double tire) {
    const double track = 2 * 0.74, strut = 30000 + 2 * bar;
    return 0.5 * track * track / (1 / strut + 1 / tire);
}

/// Pushed at its centre by F, at the height h over the ground about which it rolls: K φ = F h + m g h φ. Axles share
/// what is moved from side to side by their stiffnesses.
TEST(AntiRollBar, RollsACarByTheClosedForm) {
    const double mass = 1200, g = static_cast<double>(kGravity), height = 0.5, push = 1500;
    const double tire = mass * g / 4 / (0.05 * 0.3);
    for (const auto& [front, rear] :
         {std::pair{0.0f, 0.0f}, std::pair{20000.0f, 0.0f}, std::pair{10000.0f, 40000.0f}}) {
        Road road(0, awake());
        Vehicle car(road.world, withBars(front, rear));
        car.input.brake = 1;
        for (int i = 0; i < 600; ++i) {
            road.world.applyForce(car.chassis(), {static_cast<float>(push), 0, 0},
                                  road.world.centerOfMass(car.chassis()));
            road.world.step(kStep);
        }
        const double kf = rollStiffness(static_cast<double>(front), tire),
                     kr = rollStiffness(static_cast<double>(rear), tire);
        const double roll = push * height / (kf + kr - mass * g * height);
        const VehicleTelemetry& now = car.telemetry();
        EXPECT_NEAR(std::abs(static_cast<double>(now.roll)), roll, 0.01 * roll) << front << ", " << rear;
        const auto moved = [&](std::size_t left) {
            return static_cast<double>(now.wheels[left].load - now.wheels[left + 1].load);
        };
        EXPECT_NEAR(moved(0) / moved(2), kf / kr, 0.01 * kf / kr) << front << ", " << rear;
        const double bar = static_cast<double>(front * (now.wheels[0].compression - now.wheels[1].compression));
        EXPECT_NEAR(static_cast<double>(now.wheels[0].antiRollForce), bar, 1e-3 * std::abs(bar));
        EXPECT_NEAR(totalLoad(car), mass * g, 1e-3 * mass * g);
    }
}

/// In a steady turn: m a h = (K − m g h) φ with the lateral acceleration v · yaw rate.
TEST(AntiRollBar, RollsACarInASteadyTurn) {
    const double mass = 1200, g = static_cast<double>(kGravity), height = 0.5;
    const double tire = mass * g / 4 / (0.05 * 0.3);
    for (const float bar : {0.0f, 20000.0f}) {
        Road road;
        Vehicle car(road.world, withBars(bar, bar), {.position = {}, .speed = 15});
        car.input = {.steer = -0.05f, .clutch = 1};
        run(road.world, 3);
        const VehicleTelemetry& now = car.telemetry();
        const double acceleration = static_cast<double>(now.speed * now.yawRate);
        ASSERT_GT(acceleration, 1);
        const double roll =
            mass * acceleration * height / (2 * rollStiffness(static_cast<double>(bar), tire) - mass * g * height);
        EXPECT_NEAR(static_cast<double>(now.roll), roll, 0.03 * roll) << bar;
    }
}

/// A wheel in the air hangs where its spring balances the bar: load + k x + b (x − y) = 0, with y the other wheel's
/// place.
TEST(AntiRollBar, LiftsAWheelInTheAir) {
    SuspensionDef def;
    def.stiffness = 25000.0f;
    const StrutSpec strut = strutOf(def);
    const float bar = 30000, other = 0.05f, h = 1.0f / 240;
    float compression = 0;
    for (int i = 0; i < 480; ++i) compression += fallOfWheel(strut, compression, h, {bar * (compression - other), bar});
    EXPECT_NEAR(compression, (bar * other - kStrutLoad) / (25000 + bar), 1e-5f);
}

std::string complaint(const VehicleDef& def) { return whyInvalid(def); }

TEST(Suspension, RefusesCurvesAndBarsThatAreNone) {
    VehicleDef def = hatchback();
    def.wheels[1].suspension.reboundCurve = {{0.1f, 100}, {0.1f, 200}};
    EXPECT_EQ(complaint(def), "/wheels/1/suspension/reboundCurve/1/speed is 0.1, must be above the point before, 0.1");
    def.wheels[1].suspension.reboundCurve = {{0.1f, 100}, {0.2f, 50}};
    EXPECT_EQ(complaint(def),
              "/wheels/1/suspension/reboundCurve/1/force is 50, must not be below the point before, 100");
    def.wheels[1].suspension.reboundCurve = {{-0.1f, 100}};
    EXPECT_EQ(complaint(def), "/wheels/1/suspension/reboundCurve/0/speed is -0.1 m/s, must be in [1e-06, 10000]");
    def = hatchback();
    def.wheels[0].suspension.droopStopStiffness = -1.0f;
    EXPECT_EQ(complaint(def), "/wheels/0/suspension/droopStopStiffness is -1, must be in [0.001, 1000]");
    def = hatchback();
    def.antiRollBars = {{3, 1000}};
    EXPECT_EQ(complaint(def), "/antiRollBars/0/axle is 3, which has 0 wheels, must be one of 2");
    def.antiRollBars = {{1, 1000}, {1, 2000}};
    EXPECT_EQ(complaint(def), "/antiRollBars/1/axle is 1, must be that of no other");
    def.antiRollBars = {{0, -5}};
    EXPECT_EQ(complaint(def), "/antiRollBars/0/stiffness is -5 N/m, must be in [0, 1e+12]");
}

/// A car that has come to rest weighs what it weighs, also on springs on which a slow swing is a large force.
TEST(VehicleSuspension, FallsAsleepInBalance) {
    for (const VehicleLevel level : {VehicleLevel::rays, VehicleLevel::full}) {
        for (const float frequency : {1.0f, 3.0f, 7.0f}) {
            for (const double dt : {1.0 / 30, 1.0 / 60, 1.0 / 240}) {
                Road road;
                VehicleDef def = hatchback();
                def.level = level;
                for (WheelDef& wheel : def.wheels) wheel.suspension.frequency = frequency;
                Vehicle car(road.world, def, {.position = {0, 0.07, 0}});
                car.input.brake = 1;
                double t = 0;
                for (; t < 10 && road.world.isAwake(car.chassis()); t += dt) road.world.step(dt);
                EXPECT_FALSE(road.world.isAwake(car.chassis())) << frequency << " Hz at " << dt;
                EXPECT_NEAR(totalLoad(car), 1200 * kGravity, 0.01f * 1200 * kGravity) << frequency << " Hz at " << dt;
            }
        }
    }
}

}  // namespace
}  // namespace ragtop
