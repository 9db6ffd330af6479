#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <stdexcept>
#include <string>
#include <vector>

#include "hardpoints.h"
#include "ragtop/tasks.h"
#include "road.h"

namespace ragtop {
namespace {

/// Of all kinds of linkages.
std::vector<VehicleDef> linkageKinds() {
    return {withLinkages({frontStruts(), rearArms()}), withLinkages({raceWishbones(), beamOnRods()})};
}
VehicleDef atLevel(VehicleLevel level, VehicleDef def) {
    def.level = level;
    return def;
}

/// Sums over the bodies of a car that is alone in its world.
struct WholeCar {
    double mass = 0, energy = 0;
    DVec3 moment, momentum;  ///< kg m, kg m/s

    WholeCar(const World& world, const Vehicle& car) {
        for (const BodyId body : world.bodies()) {
            if (world.type(body) == BodyType::fixed) continue;
            const MassProperties own = world.mass(body);
            const auto m = static_cast<double>(own.mass);
            const Vec3 v = world.linearVelocity(body);
            const Vec3 w = inverseRotate(world.pose(body).rotation, world.angularVelocity(body));
            mass += m;
            moment = moment + m * world.centerOfMass(body);
            momentum = momentum + m * DVec3(v);
            energy += 0.5 * static_cast<double>(own.mass * dot(v, v) + dot(w, own.inertia * w)) +
                      m * 9.81 * world.centerOfMass(body).y;
        }
        energy += car.telemetry().energy.rotating + car.telemetry().energy.elastic;
    }
};

Vec3 velocityOf(const World& world, const Vehicle& car) {
    return world.velocityAt(car.chassis(), transformPoint(world.pose(car.chassis()), *car.def().chassis.centerOfMass));
}

/// m, the widest of its rods and hinges.
double widestGap(const World& world) {
    double widest = 0;
    for (const JointId joint : world.joints()) {
        const JointState state = world.state(joint);
        const auto* rod = std::get_if<DistanceDef>(&world.def(joint));
        widest =
            std::max(widest, static_cast<double>(rod ? std::abs(state.coordinate - rod->limit->lower) : state.gap));
    }
    return widest;
}

/// What carries its wheels is where the car is, and goes as it is asked to, however that was put there before.
TEST(LinkageBodies, GoAsTheCarThatIsPutElsewhereIsAskedTo) {
    for (const VehicleDef& def : linkageKinds()) {
        World world;
        Vehicle car(world, atLevel(VehicleLevel::linkages, def));
        world.setPose(car.chassis(), {{3, 20, -4}, rotationAbout({1, 0.5f, 0}, 2)});
        car.setVelocity({1, 2, 3}, {2, -1, 3});
        for (int i = 0; i < 2; ++i) {
            const WholeCar whole(world, car);
            const DVec3 asked{1, 2 - i * 9.81 * kStep, 3}, off = (1 / whole.mass) * whole.momentum - asked;
            EXPECT_LT(length(Vec3(toVec3(off))), 1e-3f) << "after " << i << " steps";
            EXPECT_LT(widestGap(world), 1e-3);
            world.step(kStep);
        }
    }
}

TEST(LinkageBodies, WeighTogetherWhatTheCarDoes) {
    for (const VehicleDef& def : linkageKinds()) {
        World world;
        const Vehicle car(world, atLevel(VehicleLevel::linkages, def));
        EXPECT_GT(world.bodies().size(), 3u);
        const WholeCar whole(world, car);
        EXPECT_NEAR(whole.mass, 1200, 1e-3);
        EXPECT_LT(length(toVec3((1 / whole.mass) * whole.moment) - *def.chassis.centerOfMass), 1e-5f);
        std::vector<MassProperties> parts;
        for (const BodyId body : world.bodies())
            parts.push_back(transformed(world.mass(body), {toVec3(world.pose(body).position), {}}));
        const Mat3 inertia = combined(parts).inertia;
        EXPECT_NEAR(inertia.cx.x, def.chassis.inertia->x, 1e-3f * def.chassis.inertia->x);
        EXPECT_NEAR(inertia.cy.y, def.chassis.inertia->y, 1e-3f * def.chassis.inertia->y);
        EXPECT_NEAR(inertia.cz.z, def.chassis.inertia->z, 1e-3f * def.chassis.inertia->z);
    }
}

/// Loads, heights and springs of level 2, and joints that stay closed.
TEST(LinkageBodies, StandAsTheDefinitionHasThem) {
    for (const VehicleDef& def : linkageKinds()) {
        Road road(0, awake());
        const Vehicle car(road.world, atLevel(VehicleLevel::linkages, def));
        run(road.world, 10);
        const DVec3 before = road.world.pose(car.chassis()).position;
        EXPECT_LT(length(toVec3(before)), 5e-4f);
        for (std::size_t i = 0; i < 4; ++i) {
            EXPECT_NEAR(car.telemetry().wheels[i].load, car.staticLoads()[i], 0.005f * car.staticLoads()[i]) << i;
            EXPECT_NEAR(car.telemetry().wheels[i].compression, 0, 5e-4) << i;
        }
        run(road.world, 10);
        EXPECT_LT(length(relative(road.world.pose(car.chassis()).position, before)), 1e-4f);
        EXPECT_LT(widestGap(road.world), 1e-5);
    }
}

TEST(LinkageBodies, HoldACarOnASlopeByItsBrakes) {
    expectBrakesHoldOnASlope(atLevel(VehicleLevel::linkages, linkageKinds()[0]));
}

struct LinkedDrive {
    Road road{0, awake()};
    Vehicle car;
    LinkedDrive(const VehicleDef& def, VehicleLevel level, const VehicleInput& input, float speed)
        : car(road.world, atLevel(level, def), {.speed = speed}) {
        car.input = input;
    }
};

/// Curves that level 2 has from hardpoints, and joints at the same hardpoints.
TEST(LinkageBodies, TurnAndBrakeAsTheirCurvesDo) {
    const VehicleInput inputs[] = {{.throttle = 0.3f, .steer = 0.15f},
                                   {.throttle = 0.2f, .steer = -0.2f},
                                   {.brake = 0.3f, .clutch = 1},
                                   {.throttle = 1}};
    for (const VehicleDef& def : linkageKinds()) {
        for (const VehicleInput& input : inputs) {
            LinkedDrive curves(def, VehicleLevel::full, input, 15), bodies(def, VehicleLevel::linkages, input, 15);
            for (LinkedDrive* drive : {&curves, &bodies}) run(drive->road.world, 1.5);
            const VehicleTelemetry &a = curves.car.telemetry(), &b = bodies.car.telemetry();
            EXPECT_NEAR(b.speed, a.speed, 0.005f * 15);
            EXPECT_NEAR(b.yawRate, a.yawRate, 0.02f * std::abs(a.yawRate) + 1e-3f);
            EXPECT_NEAR(b.roll, a.roll, 0.02f * std::abs(a.roll) + 2e-4f);
            EXPECT_NEAR(b.pitch, a.pitch, 2e-3f);  // a tenth of the mass turns with the wheels, not through their arms
            for (std::size_t i = 0; i < 4; ++i) {
                EXPECT_NEAR(b.wheels[i].load, a.wheels[i].load, 0.03f * a.wheels[i].load + 20) << i;
                EXPECT_NEAR(b.wheels[i].camber, a.wheels[i].camber, 2e-3f) << i;
            }
            EXPECT_LT(widestGap(bodies.road.world), 1e-4);
        }
    }
}

/// A wheel between tire and spring, under a body that is so much heavier that it stands: f = √((k + k_t)/m_u)/2π, to
/// which the body adds (m_u/m) (k/(k + k_t))²/2, a part in 1,000.
TEST(LinkageBodies, WheelsHopAtTheirOwnFrequency) {
    VehicleDef def = withLinkages({parallelWishbones(), rearArms()});
    for (WheelDef& wheel : def.wheels) wheel.suspension.compressionDamping = wheel.suspension.reboundDamping = 1;
    Road road(0, awake());
    Vehicle car(road.world, atLevel(VehicleLevel::linkages, def), {.position = {0, 0.004, 0}});
    const double dt = 1.0 / 1000;
    std::vector<double> peaks;
    float before = 0, last = 0;
    for (int i = 0; i < 1000; ++i) {
        road.world.step(dt);
        const float load = car.telemetry().wheels[0].load;
        if (i > 50 && last > before && last > load) peaks.push_back(i * dt);
        before = last;
        last = load;
    }
    ASSERT_GT(peaks.size(), 4u);
    const double frequency = static_cast<double>(peaks.size() - 1) / (peaks.back() - peaks.front());
    const double load = car.staticLoads()[0], share = load / 9.81;
    const double tire = load / (0.05 * static_cast<double>(def.wheels[0].radius));
    const double spring = share * std::pow(2 * kPi * def.wheels[0].suspension.frequency, 2);
    const double mass = static_cast<double>(def.wheels[0].mass + def.linkages[0].mass);
    const double alone = std::sqrt((spring + tire) / mass) / (2 * kPi);
    EXPECT_NEAR(frequency / alone, 1, 0.01);
}

/// Dropped askew: it keeps no more than it has, and ends at rest on its wheels or sides.
TEST(LinkageBodies, FallenCarNeverGainsEnergy) {
    int turned = 0;
    for (const double dt : {1.0 / 30, 1.0 / 60, 1.0 / 120}) {
        for (const float lean : {0.0f, 0.3f, -0.8f, 1.6f, 3.1f}) {
            Road road(0, awake());
            const VehicleDef def = linkageKinds()[static_cast<std::size_t>(turned++ % 2)];
            Vehicle car(road.world, atLevel(VehicleLevel::linkages, def), {.position = {0, 1.5, 0}, .speed = 6});
            road.world.setPose(car.chassis(), {DVec3{0, 1.5, 0}, rotationAbout({0, 0, 1}, lean)});
            car.input.clutch = 1;
            const double first = WholeCar(road.world, car).energy;
            double most = first;
            for (int i = 0; i < static_cast<int>(std::lround(5 / dt)); ++i) {
                road.world.step(dt);
                most = std::max(most, WholeCar(road.world, car).energy);
            }
            EXPECT_LT(most, first * 1.001) << dt << " " << lean;
        }
    }
}

/// To level 3 and back: momentum stays to rounding, and what the car goes on by in a step is what it would.
TEST(LinkageBodies, LevelsKeepMomentumAndVelocityWhereTheyChange) {
    const VehicleInput inputs[] = {{}, {.throttle = 0.3f, .steer = -0.15f}, {.brake = 0.6f}};
    for (const VehicleDef& def : linkageKinds()) {
        for (const VehicleInput& input : inputs) {
            for (const VehicleLevel other : {VehicleLevel::bicycle, VehicleLevel::rays, VehicleLevel::full}) {
                // Brakes have yet to bend the tires of what comes from level 0.
                if (other == VehicleLevel::bicycle && input.brake > 0) continue;
                for (const bool up : {true, false}) {
                    const VehicleLevel from = up ? other : VehicleLevel::linkages;
                    const VehicleLevel to = up ? VehicleLevel::linkages : other;
                    LinkedDrive drive(def, from, input, 15);
                    const World& world = drive.road.world;
                    run(drive.road.world, 1);
                    const Vec3 first = velocityOf(world, drive.car);
                    run(drive.road.world, kStep);
                    const Vec3 second = velocityOf(world, drive.car);
                    const DVec3 momentum = WholeCar(world, drive.car).momentum;
                    drive.car.setLevel(to);
                    const float lost = length(toVec3(WholeCar(world, drive.car).momentum - momentum));
                    EXPECT_LT(lost, other == VehicleLevel::bicycle ? INFINITY : 1e-5f * 1200 * 15);
                    EXPECT_LT(length(velocityOf(world, drive.car) - second), 0.002f * length(second));
                    run(drive.road.world, kStep);
                    EXPECT_LT(length(velocityOf(world, drive.car) - second - (second - first)),
                              (other == VehicleLevel::bicycle ? 0.005f : 0.001f) * length(second))
                        << static_cast<int>(from) << " to " << static_cast<int>(to);
                    EXPECT_LT(widestGap(world), 1e-4);
                }
            }
        }
    }
}

TEST(LinkageBodies, LeaveWithTheLevelAndWithTheCar) {
    World world;
    const std::size_t before = world.bodies().size();
    {
        Vehicle car(world, atLevel(VehicleLevel::linkages, linkageKinds()[0]));
        EXPECT_EQ(world.bodies().size(), before + 5);
        EXPECT_EQ(world.joints().size(), 10u);
        car.setLevel(VehicleLevel::full);
        EXPECT_EQ(world.bodies().size(), before + 1);
        EXPECT_EQ(world.joints().size(), 0u);
        EXPECT_EQ(world.mass(car.chassis()).mass, 1200);
        car.setLevel(VehicleLevel::linkages);
    }
    EXPECT_EQ(world.bodies().size(), before);
}

/// At any level, whatever the level was in between.
TEST(LinkageBodies, ComeBackWithASavedWorld) {
    for (const VehicleDef& def : linkageKinds()) {
        LinkedDrive drive(def, VehicleLevel::full, {.throttle = 0.3f, .steer = 0.1f}, 12);
        World& world = drive.road.world;
        for (const VehicleLevel saved : {VehicleLevel::full, VehicleLevel::linkages}) {
            drive.car.setLevel(saved);
            run(world, 0.5);
            std::vector<std::byte> state(world.saveSize());
            world.save(state);
            const auto goOn = [&] {
                for (const VehicleLevel next :
                     {VehicleLevel::linkages, VehicleLevel::bicycle, VehicleLevel::linkages, VehicleLevel::full}) {
                    run(world, 0.25);
                    drive.car.setLevel(next);
                }
                run(world, 0.25);
                return world.hash();
            };
            const std::uint64_t hash = goOn();
            world.restore(state);
            EXPECT_EQ(drive.car.def().level, saved);
            EXPECT_EQ(goOn(), hash);
            // Another world, in which the car has never been at that level.
            LinkedDrive other(def, VehicleLevel::full, {}, 12);
            other.road.world.restore(state);
            EXPECT_EQ(other.car.def().level, saved);
            run(world, 0.1);
        }
        // Of other hardpoints.
        std::vector<std::byte> state(world.saveSize());
        world.save(state);
        VehicleDef changed = drive.car.def();
        changed.linkages[0].tieRod->inner.y += 0.01f;
        drive.car.setDef(changed);
        EXPECT_THROW(world.restore(state), std::invalid_argument);
    }
}

TEST(LinkageBodies, HaveTheSameBitsOnAnyNumberOfThreadsAndLanes) {
    std::vector<std::uint64_t> hashes;
    for (const int threads : {1, 2}) {
        for (const int lanes : {4, 8}) {
            World world({}, {.tasks = threadTasks(threads), .lanes = lanes});
            world.create(StaticBody{.shape = Box{{200, 1, 200}}, .position = {0, -1, 0}});
            std::vector<Vehicle> cars;
            for (int i = 0; i < 6; ++i)
                cars.emplace_back(world,
                                  atLevel(VehicleLevel::linkages, linkageKinds()[static_cast<std::size_t>(i % 2)]),
                                  VehiclePlacement{.position = {4.0 * i, 0, 0}, .speed = 10});
            for (std::size_t i = 0; i < cars.size(); ++i)
                cars[i].input = {.throttle = 0.5f, .steer = 0.1f * static_cast<float>(i)};
            run(world, 2);
            hashes.push_back(world.hash());
        }
    }
    for (const std::uint64_t hash : hashes) EXPECT_EQ(hash, hashes[0]);
}

/// What moves the chassis between steps takes all of the car along.
TEST(LinkageBodies, GoWithAChassisThatIsPutElsewhere) {
    LinkedDrive drive(linkageKinds()[0], VehicleLevel::linkages, {}, 0);
    World& world = drive.road.world;
    run(world, 1);
    world.setPose(drive.car.chassis(), {DVec3{50, 0, 20}, rotationAbout({0, 1, 0}, 1)});
    run(world, 2);
    const DVec3 at = world.pose(drive.car.chassis()).position;
    EXPECT_LT(length(relative(at, {50, 0, 20})), 0.01f);
    EXPECT_LT(widestGap(world), 1e-5);
    drive.car.place({.position = {-30, 0, 5}, .heading = 2, .speed = 8});
    run(world, 1);
    EXPECT_GT(drive.car.telemetry().speed, 7);
    EXPECT_LT(widestGap(world), 1e-5);
}

/// A car that is set going in the air has all of its mass's momentum, at any level, and keeps its velocity; a bad
/// number changes nothing.
TEST(LinkageBodies, GetTheVelocityOfTheirCar) {
    for (const VehicleLevel level : {VehicleLevel::full, VehicleLevel::linkages}) {
        LinkedDrive drive(linkageKinds()[0], level, {.clutch = 1}, 0);
        World& world = drive.road.world;
        run(world, 1);
        world.setPose(drive.car.chassis(), {DVec3{0, 20, 0}, {}});
        world.step(kStep);
        const Vec3 velocity{3, 0, 12}, turning{0.1f, 0.3f, -0.2f};
        drive.car.setVelocity(velocity, turning);
        const auto meanVelocity = [&] {
            const WholeCar car(world, drive.car);
            return toVec3((1 / car.mass) * car.momentum);
        };
        // Of a tenth of the mass, that hangs up to 0.1 m lower than where the car stands, at 0.37 rad/s.
        constexpr float kHanging = 0.1f * 0.1f * 0.37f;
        EXPECT_LT(length(meanVelocity() - velocity), kHanging);
        for (const BodyId body : world.bodies()) {
            if (world.type(body) == BodyType::fixed) continue;
            EXPECT_EQ(world.angularVelocity(body), turning);
        }
        world.step(kStep);
        const Vec3 fall{0, -kGravity * static_cast<float>(kStep), 0};
        constexpr float kDrag = 1e-3f;  // m/s in a step
        EXPECT_LT(length(meanVelocity() - velocity - fall), kHanging + kDrag);
        const Vec3 before = world.linearVelocity(drive.car.chassis());
        EXPECT_THROW(drive.car.setVelocity({NAN, 0, 0}, {}), std::invalid_argument);
        EXPECT_EQ(world.linearVelocity(drive.car.chassis()), before);
    }
}

TEST(LinkageBodies, TakeOtherHardpointsAsTheyDrive) {
    LinkedDrive drive(linkageKinds()[0], VehicleLevel::linkages, {.throttle = 0.3f, .steer = 0.1f}, 12);
    run(drive.road.world, 1);
    VehicleDef def = drive.car.def();
    def.linkages[1] = beamOnRods();
    drive.car.setDef(def);
    EXPECT_EQ(drive.road.world.joints().size(), 12u);
    run(drive.road.world, 1);
    EXPECT_GT(drive.car.telemetry().speed, 11);
    EXPECT_LT(widestGap(drive.road.world), 1e-4);
}

/// Nobody should, and no step throws where somebody does.
TEST(LinkageBodies, StopTheirCarWhereOneIsDestroyed) {
    LinkedDrive drive(linkageKinds()[0], VehicleLevel::linkages, {.throttle = 1}, 5);
    World& world = drive.road.world;
    run(world, 0.2);
    world.destroy(world.bodies().back());
    EXPECT_NO_THROW(run(world, 0.5));
    EXPECT_NO_THROW(drive.car.telemetry());
    drive.car.setLevel(VehicleLevel::full);
    run(world, 1);
    EXPECT_GT(drive.car.telemetry().speed, 2);
}

TEST(LinkageBodies, FallAsleepAndWakeByThePedal) {
    Road road;
    Vehicle car(road.world, atLevel(VehicleLevel::linkages, linkageKinds()[1]));
    run(road.world, 4);
    EXPECT_FALSE(road.world.isAwake(car.chassis()));
    for (const BodyId body : road.world.bodies()) EXPECT_FALSE(road.world.isAwake(body));
    car.input.throttle = 1;
    run(road.world, 2);
    EXPECT_GT(car.telemetry().speed, 2);
}

/// Hardpoints about those of real cars, as far as they can be assembled.
TEST(LinkageBodies, DriveOnAnyHardpoints) {
    std::mt19937 dice(7);
    const auto moved = [&](Vec3& point) {
        for (int k = 0; k < 3; ++k) point[k] += std::uniform_real_distribution<float>(-0.06f, 0.06f)(dice);
    };
    int driven = 0, drawn = 0;
    for (; driven < 20 && drawn < 1000; ++drawn) {
        LinkageDef fronts[] = {frontStruts(), raceWishbones(), parallelWishbones()},
                   rears[] = {rearArms(), beamOnRods()};
        LinkageDef &front = fronts[drawn % 3], &rear = rears[drawn % 2];
        if (auto& arms = front.doubleWishbone)
            for (Vec3* point : {&arms->lowerFront, &arms->lowerRear, &arms->lowerBall, &arms->upperFront,
                                &arms->upperRear, &arms->upperBall})
                moved(*point);
        if (auto& strut = front.mcPherson)
            for (Vec3* point :
                 {&strut->lowerFront, &strut->lowerRear, &strut->lowerBall, &strut->strutTop, &strut->strutFoot})
                moved(*point);
        moved(front.tieRod->inner);
        moved(front.tieRod->outer);
        if (auto& arm = rear.trailingArm)
            for (Vec3* point : {&arm->inner, &arm->outer}) moved(*point);
        if (auto& beam = rear.solidAxle)
            for (RodDef& rod : beam->rods)
                for (Vec3* point : {&rod.chassis, &rod.carrier}) moved(*point);
        const VehicleDef def = atLevel(VehicleLevel::linkages, withLinkages({front, rear}));
        if (!whyInvalid(def).empty()) continue;
        ++driven;
        LinkedDrive drive(def, VehicleLevel::linkages, {.throttle = 0.4f}, 12);
        for (int i = 0; i < 240; ++i) {
            drive.car.input.steer = 0.4f * std::sin(0.05f * static_cast<float>(i));
            drive.car.input.brake = i > 180 ? 1.0f : 0.0f;
            drive.road.world.step(kStep);
            ASSERT_LT(widestGap(drive.road.world), 5e-3) << "drawn " << drawn << " in step " << i;
        }
        const VehicleTelemetry& seen = drive.car.telemetry();
        EXPECT_LT(std::abs(seen.speed), 14) << drawn;
        EXPECT_LT(std::abs(seen.roll), 0.3f) << drawn;
    }
    EXPECT_EQ(driven, 20);
}

TEST(LinkageBodies, SayWhyTheyCannotBe) {
    const auto whyOf = [](const VehicleDef& def) { return whyInvalid(atLevel(VehicleLevel::linkages, def)); };
    EXPECT_EQ(whyOf(hatchback()), "/level is linkages, must be another where /linkages has none of /wheels/0/axle 0");
    EXPECT_EQ(whyOf(withLinkages({frontStruts()})),
              "/level is linkages, must be another where /linkages has none of /wheels/2/axle 1");
    VehicleDef heavy = linkageKinds()[0];
    heavy.linkages[0].mass = 600;
    EXPECT_EQ(whyInvalid(heavy), "");
    EXPECT_NE(whyOf(heavy).find("/linkages/*/mass"), std::string::npos) << whyOf(heavy);
    World world;
    Vehicle car(world, hatchback());
    EXPECT_THROW(car.setLevel(VehicleLevel::linkages), std::invalid_argument);
    EXPECT_EQ(car.def().level, VehicleLevel::full);
    EXPECT_EQ(world.bodies().size(), 1u);
}

}  // namespace
}  // namespace ragtop
