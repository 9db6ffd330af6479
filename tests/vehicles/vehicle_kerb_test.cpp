#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "road.h"

/// Wheels meet what comes from ahead, from the side and at an angle.
namespace ragtop {
namespace {

constexpr float kAt = 8;  ///< m ahead, of the kerb

void layKerb(World& world, float height) {
    const float half = 0.5f * height;
    world.create(StaticBody{.shape = Box{{200, half, 200}},
                            .position = {0, static_cast<double>(half), static_cast<double>(kAt + 200)}});
}

struct Climb {
    double apex = 0;  ///< m that the car rises
    double load = 0;  ///< N, largest of a wheel
};

/// A car that rolls freely up a kerb.
Climb climb(const VehicleDef& def, float height, float speed, float heading, double hz) {
    Road road(0, awake());
    layKerb(road.world, height);
    Vehicle car(road.world, def, {.position = {}, .heading = heading, .speed = speed});
    car.input.clutch = 1;
    const double seconds = static_cast<double>((kAt + 4) / (speed * std::cos(heading))) + 1;
    Climb most;
    double energy = 0;
    for (double t = 0; t < seconds; t += 1 / hz) {
        road.world.step(1 / hz);
        if (t == 0) energy = road.world.energy();
        EXPECT_LT(road.world.energy(), 1.001 * energy) << t;
        most.apex = std::max(most.apex, road.world.pose(car.chassis()).position.y);
        for (const WheelTelemetry& wheel : car.telemetry().wheels)
            most.load = std::max(most.load, static_cast<double>(wheel.peakLoad));
    }
    return most;
}

/// The way of a car over a kerb, and what its wheels bear, is that of its tires and struts, and not of the length of a
/// step.
TEST(VehicleKerb, IsClimbedAlikeAtAnyStep) {
    for (const float height : {0.05f, 0.1f, 0.2f}) {
        for (const float speed : {20 / 3.6f, 50 / 3.6f, 150 / 3.6f}) {
            SCOPED_TRACE(std::to_string(height) + " m at " + std::to_string(speed) + " m/s");
            const Climb reference = climb(hatchback(), height, speed, 0, 1000);
            EXPECT_GT(reference.apex, height);
            for (const double hz : {60.0, 120.0}) {
                const Climb found = climb(hatchback(), height, speed, 0, hz);
                EXPECT_NEAR(found.apex, reference.apex, 0.05 * reference.apex) << hz;
                EXPECT_NEAR(found.load, reference.load, 0.05 * reference.load) << hz;
            }
        }
    }
}

/// At an angle an edge comes up beside the middle of the tread at once.
TEST(VehicleKerb, ThrowsACarAsHighAtAnAngle) {
    for (const float height : {0.05f, 0.1f, 0.15f}) {
        for (const float speed : {20 / 3.6f, 50 / 3.6f, 100 / 3.6f}) {
            SCOPED_TRACE(std::to_string(height) + " m at " + std::to_string(speed) + " m/s");
            const double reference = climb(hatchback(), height, speed, 0.785f, 1000).apex;
            EXPECT_GT(reference, height);
            for (const double hz : {60.0, 120.0}) {
                EXPECT_NEAR(climb(hatchback(), height, speed, 0.785f, hz).apex, reference, 0.05 * reference) << hz;
            }
        }
    }
}

/// Sideways over ice: the sides of the wheels meet the kerb, at which the car stays.
TEST(VehicleKerb, StopsACarThatSlidesAgainstItSideways) {
    for (const double hz : {30.0, 60.0, 120.0}) {
        Road road(0, awake());
        layKerb(road.world, 0.2f);
        VehicleDef def = hatchback();
        for (WheelDef& wheel : def.wheels) wheel.tire.lateralFriction = wheel.tire.longitudinalFriction = 0.02f;
        Vehicle car(road.world, def, {.position = {0, 0, 4}, .heading = 0.5f * kPi});
        road.world.setVelocity(car.chassis(), {0, 0, 3}, {});
        run(road.world, 4, 1 / hz);
        const Pose pose = road.world.pose(car.chassis());
        EXPECT_LT(pose.position.z, kAt - 0.74f) << hz;
        EXPECT_GT(rotate(pose.rotation, {0, 1, 0}).y, 0.99f) << hz;
    }
}

/// From the side at any height between ground and hub, and at any speed: it bounces or stays, on the side it came from.
TEST(VehicleKerb, LetsNoBallThroughAWheel) {
    for (const float speed : {3.0f, 10.0f, 30.0f}) {
        for (int k = 0; k < 20; ++k) {
            Road road;
            Vehicle car(road.world, hatchback(), {.position = {}});
            car.input = {.brake = 1, .handbrake = 1};
            const float part = static_cast<float>(k) / 20;
            const double up = 0.1 + 0.15 * static_cast<double>(part), along = 1.26 + 0.1 * std::cos(7.0 * k);
            const BodyId ball =
                road.world.create(DynamicBody{.shape = Sphere{0.08f}, .density = 500, .position = {2, up, along}});
            road.world.setVelocity(ball, {-speed, 0, 0}, {});
            run(road.world, 0.4 + 1 / static_cast<double>(speed));
            EXPECT_GT(road.world.pose(ball).position.x, 0.74) << k << " at " << speed;
        }
    }
}

}  // namespace
}  // namespace ragtop
