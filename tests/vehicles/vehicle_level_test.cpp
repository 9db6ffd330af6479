#include <gtest/gtest.h>

#include <memory>
#include <stdexcept>
#include <vector>

#include "ragtop/driver.h"
#include "road.h"

namespace ragtop {
namespace {

constexpr VehicleLevel kLevels[] = {VehicleLevel::bicycle, VehicleLevel::rays, VehicleLevel::full};

/// A hatchback, one with tires by curves, and to scale a kart of 150 kg and a lorry of 9.6 t.
VehicleDef scaled(float size) {
    VehicleDef def = hatchback();
    const float weight = size * size * size;
    for (ChassisShape& shape : def.chassis.shapes) {
        auto& box = std::get<Box>(shape.shape);
        box.halfExtents = size * box.halfExtents;
        shape.frame.position = size * shape.frame.position;
    }
    def.chassis.mass *= weight;
    def.chassis.centerOfMass = size * *def.chassis.centerOfMass;
    def.chassis.inertia = size * size * weight * *def.chassis.inertia;
    for (WheelDef& wheel : def.wheels) {
        wheel.position = size * wheel.position;
        wheel.radius *= size;
        wheel.width *= size;
        wheel.mass *= weight;
        wheel.brakeTorque *= size * weight;
        wheel.tire.relaxationLength *= size;
    }
    for (TorquePoint& point : def.engine.torqueCurve) point.torque *= size * weight;
    return def;
}

std::vector<VehicleDef> cars() {
    std::vector<VehicleDef> all{hatchback(), hatchback(), scaled(0.5f), scaled(2)};
    for (WheelDef& wheel : all[1].wheels) wheel.tire.slipCurves = SlipCurvesDef{};
    return all;
}

struct LevelDrive {
    Road road;
    Vehicle car;
    LevelDrive(const VehicleDef& def, VehicleLevel level, float speed, float slope = 0)
        : road(slope, awake()), car(road.world, at(def, level), {.speed = speed}) {
        road.world.setPose(car.chassis(), {DVec3{}, road.tilt});
        road.world.setVelocity(car.chassis(), rotate(road.tilt, {0, 0, speed}), {});
    }
    static VehicleDef at(VehicleDef def, VehicleLevel level) {
        def.level = level;
        return def;
    }
    Vec3 velocity() const { return road.world.linearVelocity(car.chassis()); }
    void steps(int count) {
        for (int i = 0; i < count; ++i) road.world.step(kStep);
    }
};

/// A car goes on as it went: what its velocity changes by in the first step is what it changed by in the last one.
TEST(VehicleLevels, KeepVelocityWhereTheyChange) {
    for (const VehicleDef& def : cars())
        for (const VehicleLevel from : kLevels)
            for (const VehicleLevel to : kLevels)
                for (const float speed : {5.0f, 15.0f, 30.0f})
                    for (const float gravities : {0.0f, 0.3f}) {
                        LevelDrive drive(def, from, speed);
                        drive.car.input.throttle = 0.2f;
                        // Of a neutral car: v² δ/L = a.
                        const float angle = gravities * kGravity * wheelbase(def) / (speed * speed);
                        drive.car.input.steer = steerFor(def.steering, std::min(angle, 0.4f), speed);
                        drive.steps(180);
                        const Vec3 first = drive.velocity();
                        drive.steps(1);
                        const Vec3 second = drive.velocity(), change = second - first;
                        drive.car.setLevel(to);
                        EXPECT_EQ(drive.velocity(), second);
                        drive.steps(1);
                        const float jump = length(drive.velocity() - second - change) / length(second);
                        EXPECT_LT(jump, 0.005f) << def.chassis.mass << " kg " << static_cast<int>(from) << " to "
                                                << static_cast<int>(to) << " at " << speed << ", " << gravities;
                    }
}

TEST(VehicleLevels, GoTheSameWay) {
    for (const VehicleDef& def : cars()) {
        std::vector<DVec3> ends;
        for (const VehicleLevel level : kLevels) {
            LevelDrive drive(def, level, 12);
            drive.car.input.throttle = 0.2f;
            drive.car.input.steer = steerFor(def.steering, 0.02f * wheelbase(def), 12);
            drive.steps(180);
            ends.push_back(drive.road.world.pose(drive.car.chassis()).position);
        }
        // A brush is 10 % softer at 0.3 g than its slope; forces that stay for a step lag behind by half of one.
        const float way = length(relative(ends[2], {}));
        EXPECT_LT(length(relative(ends[0], ends[2])), 0.04f * way) << def.chassis.mass;
        EXPECT_LT(length(relative(ends[1], ends[2])), 0.01f * way) << def.chassis.mass;
    }
}

TEST(VehicleLevels, HoldOnASlopeWithTheirBrakes) {
    for (const VehicleDef& def : cars())
        for (const VehicleLevel level : {VehicleLevel::bicycle, VehicleLevel::rays}) {
            LevelDrive drive(def, level, 0, 0.3f);
            drive.car.input.brake = 1;
            drive.steps(300);
            const DVec3 before = drive.road.world.pose(drive.car.chassis()).position;
            drive.steps(1200);
            EXPECT_LT(length(relative(drive.road.world.pose(drive.car.chassis()).position, before)), 1e-4f)
                << def.chassis.mass << " kg, level " << static_cast<int>(level);
        }
}

/// Where the grip is enough nothing but their brakes stops them: v²/(2 a), a = Σ T/(r m), while the engine is apart.
TEST(VehicleLevels, BrakeAlike) {
    for (const VehicleDef& def : cars()) {
        std::vector<double> ways;
        for (const VehicleLevel level : kLevels) {
            LevelDrive drive(def, level, 15);
            drive.car.input.clutch = 1;
            drive.car.input.brake = 0.4f;
            drive.steps(300);
            ways.push_back(drive.road.world.pose(drive.car.chassis()).position.z);
        }
        EXPECT_NEAR(ways[0], ways[2], 0.02 * ways[2]) << def.chassis.mass;
        EXPECT_NEAR(ways[1], ways[2], 0.01 * ways[2]) << def.chassis.mass;
    }
}

TEST(VehicleLevels, BicycleFollowsHillsAndFallsOffEdges) {
    LevelDrive drive(hatchback(), VehicleLevel::bicycle, 20, 0.2f);
    drive.car.input.throttle = 0.5f;
    drive.steps(120);
    const Pose pose = drive.road.world.pose(drive.car.chassis());
    const DVec3 plane{rotate(conjugate(drive.road.tilt), toVec3(pose.position))};
    EXPECT_NEAR(plane.y, 0, 1e-3);
    EXPECT_NEAR(drive.car.telemetry().pitch, -std::atan(0.2f), 0.01f);  // it leans as it slows down

    World world;
    world.create(StaticBody{.shape = Box{{5, 1, 20}}, .position = {0, -1, 0}});
    Vehicle car(world, LevelDrive::at(hatchback(), VehicleLevel::bicycle), {.speed = 30});
    for (int i = 0; i < 120; ++i) world.step(kStep);
    const double time = 2 - 20.0 / 30;
    EXPECT_NEAR(world.pose(car.chassis()).position.y, -0.5 * 9.81 * time * time, 0.7);  // from where its ray ends
}

TEST(VehicleLevels, ComeBackWithASavedWorld) {
    LevelDrive drive(hatchback(), VehicleLevel::full, 15);
    drive.car.input.throttle = 0.5f;
    for (const VehicleLevel saved : kLevels) {
        drive.car.setLevel(saved);
        drive.steps(30);
        std::vector<std::byte> state(drive.road.world.saveSize());
        drive.road.world.save(state);
        const auto goOn = [&] {
            for (const VehicleLevel next : {VehicleLevel::rays, VehicleLevel::bicycle, VehicleLevel::full}) {
                drive.steps(20);
                drive.car.setLevel(next);
            }
            drive.steps(20);
            return drive.road.world.hash();
        };
        const std::uint64_t hash = goOn();
        drive.road.world.restore(state);
        EXPECT_EQ(drive.car.def().level, saved);
        EXPECT_EQ(goOn(), hash) << static_cast<int>(saved);
    }
}

TEST(VehicleLevels, BicyclesFallAsleepAndWakeByThePedal) {
    Road road;
    Vehicle car(road.world, LevelDrive::at(hatchback(), VehicleLevel::bicycle));
    for (int i = 0; i < 120; ++i) road.world.step(kStep);
    EXPECT_FALSE(road.world.isAwake(car.chassis()));
    car.input.throttle = 1;
    for (int i = 0; i < 120; ++i) road.world.step(kStep);
    EXPECT_GT(car.telemetry().speed, 3);
}

TEST(VehicleLevels, DoNotChangeWithinAStep) {
    Road road;
    Vehicle car(road.world, hatchback());
    struct Meddler {
        Vehicle& car;
        int refused = 0;
    } meddler{car};
    StepModule module;
    module.user = &meddler;
    module.beforeStep = [](void* user, World&, double) {
        auto& self = *static_cast<Meddler*>(user);
        for (const VehicleLevel level : {VehicleLevel::bicycle, VehicleLevel::rays}) {
            try {
                self.car.setLevel(level);
            } catch (const std::logic_error&) {
                ++self.refused;
            }
        }
    };
    road.world.add(&module);
    road.world.step(kStep);
    road.world.remove(&module);
    EXPECT_EQ(meddler.refused, 2);
    EXPECT_EQ(car.def().level, VehicleLevel::full);
}

}  // namespace
}  // namespace ragtop
