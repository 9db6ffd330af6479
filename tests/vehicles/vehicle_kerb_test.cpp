#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "road.h"
#include "suspension.h"

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
    double deep = 0;  ///< m by which a tread, less what its tire is squashed, is in the road or the kerb
};

/// Of a wheel at the end of a step: in the planes of its rims and its middle, from the hub to the nearest of road and
/// kerb.
double depthOf(const WheelDef& def, const StrutSpec& strut, const WheelTelemetry& wheel, float height) {
    const Vec3 axle = rotate(wheel.pose.rotation, {1, 0, 0});
    const Vec3 level = normalized(cross(axle, {0, 1, 0}));
    double nearest = wheel.pose.position.y;
    for (const float side : {-0.4f, 0.0f, 0.4f}) {
        const DVec3 hub = wheel.pose.position + DVec3(side * def.width * axle);
        const double up = std::max(hub.y - static_cast<double>(height), 0.0);
        const double ahead = std::max((kAt - hub.z) / static_cast<double>(std::abs(level.z)), 0.0);
        nearest = std::min(nearest, std::hypot(up, ahead));
    }
    return static_cast<double>(def.radius - squashUnder(strut, wheel.load)) - nearest;
}

std::vector<StrutSpec> strutsOf(const VehicleDef& def) {
    std::vector<Vec3> places;
    for (const WheelDef& wheel : def.wheels) places.push_back(wheel.position - *def.chassis.centerOfMass);
    const std::vector<float> loads = staticLoads(places, def.chassis.mass * kGravity);
    std::vector<StrutSpec> struts;
    for (std::size_t i = 0; i < loads.size(); ++i) struts.push_back(makeStrut(def.wheels[i], loads[i], kGravity));
    return struts;
}

/// A car that rolls freely up a kerb.
Climb climb(const VehicleDef& def, float height, float speed, float heading, double hz) {
    Road road(0, awake());
    layKerb(road.world, height);
    Vehicle car(road.world, def, {.position = {}, .heading = heading, .speed = speed});
    car.input.clutch = 1;
    const double seconds = static_cast<double>((kAt + 4) / (speed * std::cos(heading))) + 1;
    const std::vector<StrutSpec> struts = strutsOf(def);
    Climb most;
    double energy = 0;
    for (double t = 0; t < seconds; t += 1 / hz) {
        road.world.step(1 / hz);
        if (t == 0) energy = road.world.energy();
        EXPECT_LT(road.world.energy(), 1.001 * energy) << t;
        most.apex = std::max(most.apex, road.world.pose(car.chassis()).position.y);
        for (std::size_t i = 0; i < def.wheels.size(); ++i) {
            const WheelTelemetry& wheel = car.telemetry().wheels[i];
            most.load = std::max(most.load, static_cast<double>(wheel.peakLoad));
            if (t > 0) most.deep = std::max(most.deep, depthOf(def.wheels[i], struts[i], wheel, height));
        }
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

/// A step is no wall below nine tenths of a wheel's radius: its edge pushes the wheel up where a face as steep would
/// stop it.
TEST(VehicleKerb, IsClimbedAlikeWhereItIsNearlyAsHighAsTheHub) {
    constexpr float kHeight = 0.25f;  // of wheels of 0.3 m
    for (const float heading : {0.0f, 0.35f}) {
        const float speed = 20 / 3.6f;
        const Climb reference = climb(hatchback(), kHeight, speed, heading, 1000);
        EXPECT_GT(reference.apex, kHeight);
        EXPECT_LT(reference.deep, 0.005);
        for (const double hz : {60.0, 120.0}) {
            SCOPED_TRACE(std::to_string(heading) + " rad at " + std::to_string(hz) + " Hz");
            const Climb found = climb(hatchback(), kHeight, speed, heading, hz);
            EXPECT_NEAR(found.apex, reference.apex, 0.05 * reference.apex);
            EXPECT_NEAR(found.load, reference.load, 0.05 * reference.load);
            EXPECT_LT(found.deep, 0.005);
        }
    }
}

/// A wall taller than the wheels stops a car at any speed, whether its nose is up or down.
TEST(VehicleKerb, IsAWallFromTheHeightOfTheHubOn) {
    for (const float speed : {1.0f, 5.0f, 15.0f}) {
        for (const float pitch : {-0.15f, 0.0f, 0.15f}) {
            Road road(0, awake());
            layKerb(road.world, 1.5f);
            VehicleDef def = hatchback();
            for (ChassisShape& part : def.chassis.shapes) part.frame.position.y += 2;  // the wheels alone meet it
            Vehicle car(road.world, def, {.position = {0, 0.3, 5}, .speed = speed});
            road.world.setPose(car.chassis(), {{0, 0.3, 5}, rotationAbout({1, 0, 0}, pitch)});
            car.input.clutch = 1;
            for (int i = 0; i < 240; ++i) {
                road.world.step(kStep);
                const Pose hub = car.telemetry().wheels[0].pose;
                ASSERT_LT(hub.position.z, kAt - 0.27) << speed << " m/s, " << pitch << " rad, step " << i;
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

/// A car of another size, weight, tires and struts.
VehicleDef anyCar(std::mt19937& dice) {
    const auto between = [&](float from, float to) { return std::uniform_real_distribution<float>(from, to)(dice); };
    VehicleDef def = hatchback();
    const float size = between(0.75f, 1.9f), weight = size * size * size * between(0.6f, 1.6f);
    const float round = between(0.85f, 1.35f), wide = between(0.7f, 1.6f), frequency = between(1, 2);
    const float damping = between(0.2f, 0.7f), travel = size * between(0.7f, 1.5f);
    const Vec3 lift{0, 0.3f * size * (round - 1), 0};
    ChassisDef& chassis = def.chassis;
    chassis.mass *= weight;
    chassis.inertia = (weight * size * size) * *chassis.inertia;
    chassis.centerOfMass = size * *chassis.centerOfMass + lift;
    for (ChassisShape& part : chassis.shapes) {
        part.shape = Box{size * std::get<Box>(part.shape).halfExtents};
        part.frame.position = size * part.frame.position + lift;
    }
    for (WheelDef& wheel : def.wheels) {
        wheel.position = size * wheel.position + lift;
        wheel.radius *= size * round;
        wheel.width *= size * wide;
        wheel.mass *= weight;
        wheel.suspension.frequency = frequency;
        wheel.suspension.dampingRatio = damping;
        wheel.suspension.travelUp *= travel;
        wheel.suspension.travelDown *= travel;
    }
    return def;
}

/// Kerbs of 5 to 25 cm that are less than 0.6 radii high, at 5 to 150 km/h and up to 45° to either side: a tread is
/// nowhere in the kerb by more than its tire is squashed, and height and load do not depend on the step. Of a thousand
/// such climbs 3 % are 5 % off or 5 mm deep, most of them of cars that come to a stop on the edge.
TEST(VehicleKerb, IsClimbedAlikeAndNotEnteredByAnyCarAtAnyAngle) {
    constexpr int kClimbs = 20, kMostOff = 1;
    std::mt19937 dice(1);
    const auto between = [&](float from, float to) { return std::uniform_real_distribution<float>(from, to)(dice); };
    int off = 0;
    for (int k = 0; k < kClimbs; ++k) {
        const VehicleDef def = anyCar(dice);
        const float height = between(0.05f, std::min(0.25f, 0.6f * def.wheels[0].radius));
        const float speed = std::exp(between(std::log(5 / 3.6f), std::log(150 / 3.6f)));
        const float heading = between(0, 1) < 0.3f ? 0 : between(-0.785f, 0.785f);
        const Climb reference = climb(def, height, speed, heading, 1000),
                    found = climb(def, height, speed, heading, 60);
        const double higher = found.apex / reference.apex - 1, more = found.load / reference.load - 1;
        const bool bad = std::max(std::abs(higher), std::abs(more)) > 0.05 || found.deep > 0.005;
        off += bad ? 1 : 0;
        if (bad) RecordProperty("off" + std::to_string(k), std::to_string(higher) + " " + std::to_string(more));
        EXPECT_LT(found.deep, 0.03) << k;
        EXPECT_LT(std::abs(higher), 0.2) << k;
    }
    EXPECT_LE(off, kMostOff);
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

/// Turned up by the edge that its wheels meet, about which it keeps its angular momentum m v h, a rigid car of height h
/// over the edge, b beside its middle and inertia I₀ about the edge comes over from v² = 2 g I₀ (√(h² + b²) − h)/(m h²)
/// on.
TEST(VehicleKerb, TurnsACarOverFromTheSpeedOfARigidBodyOn) {
    constexpr float kKerb = 0.2f, kOff = 0.15f;
    for (const float lift : {0.0f, 0.08f, 0.16f}) {
        VehicleDef def = plainTires(0.02f);
        def.chassis.centerOfMass->y += lift;
        const float h = def.chassis.centerOfMass->y - kKerb;
        const float b = def.wheels[0].position.x + 0.5f * def.wheels[0].width;
        const float square = h * h + b * b, inertia = def.chassis.inertia->z + def.chassis.mass * square;
        const float least = std::sqrt(2 * kGravity * inertia * (std::sqrt(square) - h) / (def.chassis.mass * h * h));
        for (const bool over : {false, true}) {
            Road road(0, awake());
            layKerb(road.world, kKerb);
            Vehicle car(road.world, def, {.position = {0, 0, kAt - 2.2}, .heading = 0.5f * kPi});
            road.world.setVelocity(car.chassis(), {0, 0, least * (over ? 1 + kOff : 1 - kOff)}, {});
            float upright = 1;
            for (int i = 0; i < 360 && upright > 0; ++i) {
                road.world.step(kStep);
                upright = std::min(upright, rotate(road.world.pose(car.chassis()).rotation, {0, 1, 0}).y);
            }
            EXPECT_EQ(upright <= 0, over) << lift << " m higher, " << least << " m/s";
        }
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
