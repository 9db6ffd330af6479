#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>
#include <string>

#include "any_vehicle.h"
#include "ragtop/tasks.h"
#include "road.h"

namespace ragtop {
namespace {

bool isSomewhere(const Pose& pose) { return isFinite(pose.position) && isFinite(pose.rotation); }

/// A car of any definition on a floor, with bricks before it and bricks far away.
struct Yard {
    World world;
    Vehicle car;

    Yard(const VehicleDef& def, float speed, int threads)
        : world({}, {.tasks = threads > 1 ? threadTasks(threads) : serialTasks()}),
          car((lay(world), world), def, {.position = {0, 0.02, 0}, .speed = speed}) {}

    static void lay(World& world) {
        world.create(StaticBody{.shape = Box{{200, 1, 200}}, .position = {0, -1, 0}});
        for (int i = 0; i < 20; ++i) {
            const double column = i % 5, row = 0.05 + 0.1 * (i / 5);
            for (const DVec3& at : {DVec3{0.3 * column - 0.6, 0.05, 3 + 10 * row}, DVec3{150 + column, row, 0}})
                world.create(DynamicBody{.shape = Box{{0.1f, 0.05f, 0.05f}}, .density = 2000, .position = at});
        }
    }

    ::testing::AssertionResult isFiniteEverywhere() {
        for (const BodyId body : world.bodies()) {
            const bool moves = isFinite(world.linearVelocity(body)) && isFinite(world.angularVelocity(body));
            if (!moves || !isSomewhere(world.pose(body)))
                return ::testing::AssertionFailure() << "body " << body.index << " is nowhere";
        }
        const VehicleTelemetry& seen = car.telemetry();
        float sum = seen.speed + seen.engine.rpm + seen.engine.torque + seen.clutchTorque;
        for (const WheelTelemetry& wheel : seen.wheels) {
            sum += wheel.load + wheel.longitudinalForce + wheel.lateralForce + wheel.slipRatio + wheel.slipAngle;
            sum += wheel.angularSpeed + wheel.rotation + wheel.steerAngle + wheel.compression;
            if (!isFinite(wheel.contactPoint) || !isFinite(wheel.contactNormal) || !isSomewhere(wheel.pose))
                return ::testing::AssertionFailure() << "a wheel is nowhere";
        }
        if (!std::isfinite(sum)) return ::testing::AssertionFailure() << "telemetry is not finite";
        return ::testing::AssertionSuccess();
    }
};

void drive(unsigned seed, int threads) {
    AnyVehicle any(seed);
    const VehicleDef def = any.draw();
    const float speeds[] = {0, 0, 10, 80};
    Yard yard(def, speeds[any.index(4)], threads);
    for (int i = 0; i < 60; ++i) {
        if (i % 15 == 0) {
            const auto pedal = [&] { return static_cast<float>(any.between(-0.5, 1.5)); };
            yard.car.input = {.throttle = pedal(), .brake = pedal() - 0.5f, .steer = 2 * pedal() - 1};
        }
        ASSERT_NO_THROW(yard.world.step(kStep));
        ASSERT_TRUE(yard.isFiniteEverywhere()) << "in step " << i;
    }
}

TEST(AnyVehicleFile, StepsWithoutAThrowOrANumberThatIsNone) {
    // Others with --gtest_random_seed, from 1 on; without it every run draws the same.
    const auto first = static_cast<unsigned>(GTEST_FLAG_GET(random_seed));
    for (unsigned i = 0; i < 300; ++i) {
        SCOPED_TRACE("vehicle " + std::to_string(1000 * first + i));
        drive(1000 * first + i, i % 10 == 0 ? 2 : 1);
    }
}

/// Cars on linkages whose brakes hold their wheels as the car is stopped for numbers that are none.
TEST(AnyVehicleFile, WheelsThatBrakesHoldAreStoppedWithTheirCar) {
    for (const unsigned seed : {9085u, 11135u, 451274u, 34186218u, 99323036u, 99323235u}) {
        SCOPED_TRACE("vehicle " + std::to_string(seed));
        drive(seed, 1);
    }
}

/// The car is stopped and the world goes on, on any number of threads.
TEST(AnyVehicleFile, ForcesThatAreNoNumbersAreLeftOutAndCounted) {
    for (const int threads : {1, 2}) {
        VehicleDef def = hatchback();
        def.aerodynamics = {.dragArea = 0, .liftArea = 0, .center = {1e4f, 1e4f, 1e4f}, .airDensity = 1e4f};
        def.aerodynamics.liftArea = -1e6f;
        Yard yard(def, 80, threads);
        for (int i = 0; i < 60; ++i) ASSERT_NO_THROW(yard.world.step(kStep));
        ASSERT_TRUE(yard.isFiniteEverywhere());
    }
    Road road;
    StepModule asking;
    BodyId victim = road.world.create(DynamicBody{.shape = Box{}, .position = {0, 5, 0}});
    asking.user = &victim;
    asking.beforeSubstep = [](void* user, World& world, double) {
        world.applyImpulse(*static_cast<BodyId*>(user), {NAN, 0, 0}, {});
    };
    asking.afterStep = [](void* user, World& world, double) {
        world.applyTorque(*static_cast<BodyId*>(user), {0, INFINITY, 0});
    };
    road.world.add(&asking);
    ASSERT_NO_THROW(road.world.step(kStep));
    EXPECT_EQ(road.world.stats().outOfRange, 5u);  // four substeps and an end
    road.world.remove(&asking);
    EXPECT_THROW(road.world.applyTorque(victim, {0, INFINITY, 0}), std::invalid_argument);
}

}  // namespace
}  // namespace ragtop
