#include <gtest/gtest.h>

#include "ragtop/joint.h"
#include "road.h"

/// A car and what it pulls are one tree of joints, on which two modules act.
namespace ragtop {
namespace {

/// On a slope: a car, and a trailer that is a car of another weight, all brakes on.
struct Pair {
    Road road;
    Vehicle car, trailer;

    Pair(float slope, float heading, float weight)
        : road(slope, awake()),
          car(road.world, braked(1200), {.position = {}}),
          trailer(road.world, braked(weight), {.position = {0, 0, -5}}) {
        const Quat rotation = road.tilt * rotationAbout({0, 1, 0}, heading);
        place(car, rotation, 0);
        place(trailer, rotation, -5);
        road.world.create(BallDef{.bodies = {.a = car.chassis(),
                                             .b = trailer.chassis(),
                                             .frameA = {{0, 0.45f, -2.5f}, {}},
                                             .frameB = {{0, 0.45f, 2.5f}, {}}}});
        brake(1);
    }
    static VehicleDef braked(float mass) {
        VehicleDef def = hatchback();
        const float weight = mass / def.chassis.mass;
        def.chassis.mass = mass;
        def.chassis.inertia = weight * *def.chassis.inertia;
        for (WheelDef& wheel : def.wheels) wheel.brakeTorque = wheel.handbrakeTorque = 4000 * weight;
        return def;
    }
    void place(const Vehicle& vehicle, const Quat& rotation, float along) {
        road.world.setPose(vehicle.chassis(), {DVec3(rotate(rotation, {0, 0, along})), rotation});
    }
    void brake(float pedal) { car.input = trailer.input = {.brake = pedal, .handbrake = pedal, .clutch = 1}; }
    DVec3 at(const Vehicle& vehicle) const { return road.world.pose(vehicle.chassis()).position; }
};

/// At any heading, rate and weight: less than 0.1 mm in 5 s, and let go they are moving after two steps.
TEST(VehicleTrailer, HoldsOnASlopeAndIsLetGo) {
    for (const float weight : {300.0f, 3000.0f, 12000.0f}) {
        for (const double hz : {30.0, 60.0, 120.0}) {
            for (const float heading : {0.0f, 0.7f, 2.4f}) {
                SCOPED_TRACE(std::to_string(weight) + " kg at " + std::to_string(hz) + " Hz, " +
                             std::to_string(heading));
                Pair pair(0.1f, heading, weight);
                World& world = pair.road.world;
                run(world, 5, 1 / hz);
                const DVec3 car = pair.at(pair.car), trailer = pair.at(pair.trailer);
                run(world, 5, 1 / hz);
                EXPECT_LT(length(relative(pair.at(pair.car), car)), 1e-4f);
                EXPECT_LT(length(relative(pair.at(pair.trailer), trailer)), 1e-4f);

                pair.brake(0);
                run(world, 2 / hz, 1 / hz);
                const Vec3 ahead = rotate(world.pose(pair.car.chassis()).rotation, {0, 0, 1});
                const float down = dot(world.settings().gravity, ahead),
                            speed = dot(world.linearVelocity(pair.car.chassis()), ahead);
                EXPECT_GT(speed * (down > 0 ? 1.0f : -1.0f), 0.3f * std::abs(down) / static_cast<float>(hz));
            }
        }
    }
}

}  // namespace
}  // namespace ragtop
