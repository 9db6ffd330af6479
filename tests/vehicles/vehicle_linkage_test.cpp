#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <vector>

#include "axle_linkage.h"
#include "hardpoints.h"
#include "ragtop/suspension_geometry.h"
#include "road.h"

namespace ragtop {
namespace {

VehicleDef linkedCar() { return withLinkages({frontStruts(), rearArms()}); }

double pitchOf(const World& world, const Vehicle& car) {
    const Vec3 ahead = rotate(world.pose(car.chassis()).rotation, {0, 0, 1});
    return -std::asin(static_cast<double>(ahead.y));
}

/// At rest springs bear what they do on struts, whatever their motion ratio.
TEST(VehicleLinkage, CarRestsWhereItsDefinitionHasIt) {
    for (const VehicleDef& def : {linkedCar(), withLinkages({raceWishbones(), beamOnRods()})}) {
        Road road(0, awake());
        Vehicle car(road.world, def);
        run(road.world, 10);
        EXPECT_NEAR(road.world.pose(car.chassis()).position.y, 0, 5e-4);
        EXPECT_NEAR(pitchOf(road.world, car), 0, 5e-4);
        const DVec3 before = road.world.pose(car.chassis()).position;
        for (std::size_t i = 0; i < 4; ++i) {
            EXPECT_NEAR(car.telemetry().wheels[i].load, car.staticLoads()[i], 0.01f * car.staticLoads()[i]) << i;
            EXPECT_NEAR(car.telemetry().wheels[i].compression, 0, 5e-4) << i;
        }
        run(road.world, 10);
        EXPECT_LT(length(relative(road.world.pose(car.chassis()).position, before)), 1e-4f);
    }
}

TEST(VehicleLinkage, BrakedCarHoldsOnASlope) { expectBrakesHoldOnASlope(linkedCar()); }

/// Of the chassis and what turns; springs hold energy besides, so that it may come back, but never to more.
TEST(VehicleLinkage, FallenCarNeverGainsEnergy) {
    for (const double dt : {1.0 / 30, 1.0 / 60, 1.0 / 120}) {
        for (const float lean : {0.0f, 0.2f, -0.35f}) {
            Road road(0, awake());
            Vehicle car(road.world, linkedCar(), {.position = {0, 0.8, 0}, .speed = 8});
            road.world.setPose(car.chassis(), {DVec3{0, 0.8, 0}, rotationAbout({0, 0, 1}, lean)});
            car.input.clutch = 1;
            const auto energy = [&] {
                const Pose pose = road.world.pose(car.chassis());
                const double height = transformPoint(pose, *car.def().chassis.centerOfMass).y;
                return static_cast<double>(car.telemetry().kineticEnergy) + 1200 * 9.81 * height +
                       car.telemetry().energy.rotating;
            };
            road.world.step(dt);
            const double first = energy();
            double most = first;
            for (int i = 0; i < static_cast<int>(std::lround(5 / dt)); ++i) {
                road.world.step(dt);
                most = std::max(most, energy());
            }
            EXPECT_LT(most, first * 1.001) << dt << " " << lean;
        }
    }
}

/// A braked wheel hands its spring the part of its forces that goes along the way of a contact that does not turn.
TEST(VehicleLinkage, BrakedArmsHoldTheBodyByTheSlopeOfTheirContacts) {
    Road road(0, awake());
    const VehicleDef def = linkedCar();
    Vehicle car(road.world, def, {.speed = 30});
    run(road.world, 1);
    car.input.clutch = 1;
    car.input.brake = 0.3f;
    run(road.world, 1.5);
    for (const std::size_t i : {std::size_t{0}, std::size_t{2}}) {
        const WheelTelemetry& wheel = car.telemetry().wheels[i];
        // In the axes of the road: the body leans by less than 0.02 rad.
        const double rise = i == 0 ? wheel.compression : wheel.compression;
        const WheelPosture at = wheelPostures(def, static_cast<unsigned>(i / 2), {rise, rise, 0})[0];
        const double pitch = pitchOf(road.world, car);
        const double along = wheel.longitudinalForce + pitch * static_cast<double>(wheel.load);
        const double carried = static_cast<double>(wheel.load) + along * at.brakeSlope;
        const double held = static_cast<double>(wheel.springForce + wheel.damperForce);
        EXPECT_NEAR(held / carried, 1, 0.02) << i;
        // Without the slope it would be another force.
        EXPECT_GT(std::abs(along * at.brakeSlope), i == 2 ? 0.1 * carried : 0);
    }
}

/// Pads that held it to the chassis, and pushed its arm, would make energy: a car on its brakes heaved for ever by it.
TEST(VehicleLinkage, AHeldWheelTurnsWithItsArm) {
    for (const VehicleLevel level : {VehicleLevel::full, VehicleLevel::linkages}) {
        VehicleDef def = linkedCar();
        def.level = level;
        for (WheelDef& wheel : def.wheels) wheel.tire.rollingResistance = 0;  // which holds it to the ground
        for (const double dt : {1.0 / 30, 1.0 / 240}) {
            Road road(0, awake());
            Vehicle car(road.world, def, {.position = {0, 0.1, 0}});
            car.input = {.brake = 1, .handbrake = 1};
            const TrailingArmDef& arm = *def.linkages[1].trailingArm;
            const auto turned = [&] {
                const Vec3 hub =
                    inverseTransformPoint(road.world.pose(car.chassis()), car.telemetry().wheels[2].pose.position);
                return std::atan2(hub.y - arm.inner.y, arm.inner.z - hub.z);
            };
            run(road.world, 0.1, dt);
            const float angle = turned(), rotation = car.telemetry().wheels[2].rotation;
            float most = 0;
            for (int i = 0; i < static_cast<int>(1 / dt); ++i) {
                road.world.step(dt);
                const float by = turned() - angle;
                most = std::max(most, std::abs(by));
                ASSERT_NEAR(car.telemetry().wheels[2].rotation - rotation, by, 0.01f * std::abs(by) + 1e-3f) << dt;
            }
            EXPECT_GT(most, 0.05f);
        }
    }
}

/// Wheels lean with the body on trailing arms, and stand against it on a beam.
TEST(VehicleLinkage, CamberInATurnIsThatOfTheKind) {
    const auto leanOf = [](const LinkageDef& rear, float& roll) {
        Road road(0, awake());
        Vehicle car(road.world, withLinkages({frontStruts(), rear}), {.speed = 15});
        car.input.steer = -0.12f;
        car.input.throttle = 0.2f;
        run(road.world, 4);
        roll = car.telemetry().roll;
        return car.telemetry().wheels[2].camber;
    };
    float roll = 0;
    const float arm = leanOf(rearArms(), roll);
    EXPECT_GT(std::abs(roll), 0.01f);
    EXPECT_NEAR(std::abs(arm), std::abs(roll), 0.02f * std::abs(roll));
    const float beam = leanOf(beamOnRods(), roll);
    EXPECT_LT(std::abs(beam), 0.3f * std::abs(roll));  // its tires give way
}

/// Seen from behind, in the axes of the body, forces of ground and springs on a beam balance about a point of its rod.
TEST(VehicleLinkage, RodAcrossABeamCarriesAtItsHeight) {
    Road road(0, awake());
    Vehicle car(road.world, withLinkages({frontStruts(), beamOnRods()}), {.speed = 15});
    car.input.steer = -0.12f;
    car.input.throttle = 0.2f;
    run(road.world, 5);
    const auto wheels = car.telemetry().wheels;
    const Pose body = road.world.pose(car.chassis());
    float moment = 0, across = 0;
    for (const std::size_t i : {std::size_t{2}, std::size_t{3}}) {
        const Vec3 n = wheels[i].contactNormal, left = normalized(cross(n, rotate(body.rotation, {0, 0, 1})));
        const Vec3 force = inverseRotate(body.rotation, wheels[i].load * n + wheels[i].lateralForce * left);
        const Vec3 at = inverseTransformPoint(body, wheels[i].contactPoint);
        const Vec3 hub = inverseTransformPoint(body, wheels[i].pose.position);
        moment += at.x * force.y - at.y * force.x - hub.x * (wheels[i].springForce + wheels[i].damperForce);
        across += force.x;
    }
    EXPECT_GT(std::abs(across), 1000);
    // Its end in the beam has come up by 0.5 m of the roll, and the middle by half of that. It stands 8 cm behind the
    // wheels, a moment that the rods along, which lean as the beam rolls, take by 1 % of this one.
    const float roll = std::abs(wheels[2].compression - wheels[3].compression) / 1.48f;
    EXPECT_NEAR(-moment / across, 0.32f, 0.25f * roll + 0.03f * 0.32f);
    EXPECT_LT(roll, 0.05f);
}

/// In a turn, on the gas.
struct Turning {
    Road road{0, awake()};
    Vehicle car;
    explicit Turning(VehicleLevel level) : car(road.world, at(level), {.speed = 15}) {
        car.input.steer = -0.15f;
        car.input.throttle = 0.3f;
    }
    static VehicleDef at(VehicleLevel level) {
        VehicleDef def = withLinkages({frontStruts(), beamOnRods()});
        def.level = level;
        return def;
    }
};

TEST(VehicleLinkage, LevelsKeepVelocityWhereTheyChange) {
    constexpr VehicleLevel all[] = {VehicleLevel::bicycle, VehicleLevel::rays, VehicleLevel::full};
    for (const VehicleLevel from : all) {
        for (const VehicleLevel to : all) {
            Turning turn(from);
            const auto velocity = [&] { return turn.road.world.linearVelocity(turn.car.chassis()); };
            run(turn.road.world, 3);
            const Vec3 first = velocity();
            run(turn.road.world, kStep);
            const Vec3 second = velocity();
            turn.car.setLevel(to);
            EXPECT_EQ(velocity(), second);
            run(turn.road.world, kStep);
            EXPECT_LT(length(velocity() - second - (second - first)), 0.005f * length(second))
                << static_cast<int>(from) << " to " << static_cast<int>(to);
        }
    }
}

TEST(VehicleLinkage, CarComesBackWithASavedWorld) {
    Turning turn(VehicleLevel::full);
    run(turn.road.world, 1);
    std::vector<std::byte> state(turn.road.world.saveSize());
    turn.road.world.save(state);
    const auto goOn = [&] {
        run(turn.road.world, 1);
        return turn.road.world.hash();
    };
    const std::uint64_t hash = goOn();
    const float camber = turn.car.telemetry().wheels[2].camber;
    turn.road.world.restore(state);
    EXPECT_NE(turn.car.telemetry().wheels[2].camber, camber);
    EXPECT_EQ(goOn(), hash);
    EXPECT_EQ(turn.car.telemetry().wheels[2].camber, camber);
}

/// Curves are smooth, and taken where the wheel is in each substep.
TEST(VehicleLinkage, TurnsAlikeAtAnyRate) {
    std::vector<float> yaws, rolls;
    for (const double dt : {1.0 / 30, 1.0 / 60, 1e-3}) {
        Turning turn(VehicleLevel::full);
        run(turn.road.world, 3, dt);
        yaws.push_back(turn.car.telemetry().yawRate);
        rolls.push_back(turn.car.telemetry().roll);
    }
    EXPECT_NEAR(yaws[0] / yaws[2], 1, 0.02);
    EXPECT_NEAR(yaws[1] / yaws[2], 1, 0.005);
    EXPECT_NEAR(rolls[1] / rolls[2], 1, 0.01);
}

/// Hardpoints may change as it drives, and what cannot be is refused and changes nothing.
TEST(VehicleLinkage, TakesOtherHardpointsAsItDrives) {
    Turning turn(VehicleLevel::full);
    run(turn.road.world, 1);
    VehicleDef def = turn.car.def();
    def.linkages[1] = rearArms();
    turn.car.setDef(def);
    run(turn.road.world, 1);
    EXPECT_GT(turn.car.telemetry().speed, 14);
    def.linkages[0].tieRod->outer = def.linkages[0].mcPherson->lowerBall;
    EXPECT_THROW(turn.car.setDef(def), std::invalid_argument);
    EXPECT_NE(turn.car.def().linkages[0].tieRod->outer, def.linkages[0].tieRod->outer);
}

/// The carrier of a left wheel as a body on joints of the world, from the same hardpoints as the kinematics, with its
/// chassis held.
struct Corner {
    World world;
    VehicleDef def;
    LinkageSolver solver;
    BodyId chassis, carrier;
    float mass = 35;
    Vec3 inertia{0.9f, 1.1f, 0.8f};
    std::vector<JointId> joints;

    explicit Corner(const LinkageDef& linkage)
        : world(WorldSettings{.sleeping = false}),
          def(withLinkages({linkage})),
          solver(linkageSolver(def, linkage)),
          chassis(world.create(StaticBody{.shape = Box{{0.1f, 0.1f, 0.1f}}, .filter = {.category = 0, .mask = 0}})) {
        BodyDef body;
        body.pose.position = solver.atRest().middle;
        body.mass = MassProperties{mass, {}, {{inertia.x, 0, 0}, {0, inertia.y, 0}, {0, 0, inertia.z}}};
        body.shapes = {{.geometry = Sphere{0.1f}, .filter = {.category = 0, .mask = 0}}};
        carrier = world.create(body);
        addJoints(linkage);
    }

    Vec3 inCarrier(const DVec3& point) const { return toVec3(point - solver.atRest().middle); }
    JointBodies between(const DVec3& onChassis, const DVec3& onCarrier) const {
        JointBodies bodies{.a = chassis, .b = carrier};
        bodies.frameA.position = toVec3(onChassis);
        bodies.frameB.position = inCarrier(onCarrier);
        return bodies;
    }
    void addJoints(const LinkageDef& linkage) {
        if (const auto& arm = linkage.trailingArm) {
            HingeDef hinge{.bodies = between(DVec3(arm->inner), DVec3(arm->inner))};
            hinge.bodies.frameA.rotation = rotationBetween({1, 0, 0}, normalized(arm->outer - arm->inner));
            hinge.bodies.frameB.rotation = hinge.bodies.frameA.rotation;
            joints.push_back(world.create(hinge));
        }
        for (const LinkageHold& hold : solver.holds()) {
            if (hold.kind != HoldKind::rod) continue;
            const auto size = static_cast<float>(hold.length);
            joints.push_back(
                world.create(DistanceDef{.bodies = between(hold.chassis, hold.carrier), .limit = Range{size, size}}));
        }
        if (const auto& strut = linkage.mcPherson) {
            // The top stays on the strut's axis, which is x of the carrier's frame.
            SixDofDef slide;
            slide.bodies = {.a = carrier, .b = chassis};
            slide.bodies.frameA = {inCarrier(DVec3(strut->strutFoot)),
                                   rotationBetween({1, 0, 0}, normalized(strut->strutTop - strut->strutFoot))};
            slide.bodies.frameB = {strut->strutTop, slide.bodies.frameA.rotation};
            slide.y.limit = slide.z.limit = Range{0, 0};
            joints.push_back(world.create(slide));
        }
    }
    /// Pulls the hub to a height, m above rest, as a spring upwards does; k N/m.
    JointId addSpring(float stiffness, float damping, float target) {
        SixDofDef up;
        up.bodies = between(solver.atRest().middle, solver.atRest().middle);
        up.y.spring = Spring{.stiffness = stiffness, .damping = damping};
        up.y.target = target;
        return world.create(up);
    }
    double rise() const { return world.pose(carrier).position.y - solver.atRest().middle.y; }
};

/// Two ways to one motion: joints of rigid bodies, and Newton's method.
TEST(LinkageJoints, TakeCarriersAlongTheCurves) {
    for (const LinkageDef& linkage : {frontStruts(), parallelWishbones(), raceWishbones(), rearArms()}) {
        for (const float target : {-0.10f, 0.12f}) {
            Corner corner(linkage);
            // At 0.25 m/s, as joints are rigid at the beginnings of substeps; under 5 kN they give 0.25 mm.
            corner.addSpring(40000, 20000, target);
            for (int i = 0; i < 240; ++i) {
                corner.world.step(1.0 / 60);
                const double rise = corner.rise();
                const WheelPosture at = wheelPostures(corner.def, linkage.axle, {rise, rise, 0})[0];
                const Pose pose = corner.world.pose(corner.carrier);
                const DVec3 axle(rotate(pose.rotation, {1, 0, 0}));
                EXPECT_NEAR(at.camber, -std::asin(axle.y), 3e-3) << linkage.axle << " at " << rise;
                EXPECT_NEAR(at.toe, std::atan2(axle.z, axle.x), 1e-3) << linkage.axle << " at " << rise;
                EXPECT_NEAR(at.hub.x, pose.position.x, 4e-4);
                EXPECT_NEAR(at.hub.z, pose.position.z, 4e-4);
            }
            EXPECT_GT(corner.rise() * static_cast<double>(target), 0.5 * static_cast<double>(target * target));
        }
    }
}

/// ½ (m s_v² + sᵀ I s) u̇² is all of the motion, s how the carrier goes with u: f = √(k/(m s_v² + sᵀ I s))/2π.
TEST(LinkageJoints, SwingAsTheirRatesSay) {
    for (const LinkageDef& linkage : {frontStruts(), raceWishbones(), rearArms()}) {
        Corner corner(linkage);
        corner.world.setGravityScale(corner.carrier, 0);
        const float stiffness = 30000;
        corner.addSpring(stiffness, 0, 0);
        const CarrierRate rate = corner.solver.rates(LinkageDrive::rise, corner.solver.atRest(), {})[0];
        const DVec3 turning{rate.spin.x * rate.spin.x, rate.spin.y * rate.spin.y, rate.spin.z * rate.spin.z};
        const double inertia =
            static_cast<double>(corner.mass) * dot(rate.velocity, rate.velocity) + dot(turning, DVec3(corner.inertia));
        const double period = 2 * std::numbers::pi * std::sqrt(inertia / static_cast<double>(stiffness));
        // Little enough for the curve to be straight: 5 mm.
        const double speed = 0.005 * 2 * std::numbers::pi / period;
        corner.world.setVelocity(corner.carrier, toVec3(speed * rate.velocity), toVec3(speed * rate.spin));
        const auto energy = [&] {
            const DVec3 v(corner.world.linearVelocity(corner.carrier)), w(corner.world.angularVelocity(corner.carrier));
            const DVec3 square{w.x * w.x, w.y * w.y, w.z * w.z};
            return 0.5 * (static_cast<double>(corner.mass) * dot(v, v) + dot(square, DVec3(corner.inertia)) +
                          static_cast<double>(stiffness) * corner.rise() * corner.rise());
        };
        const double first = energy();
        constexpr double step = 1.0 / 240;
        double before = corner.rise(), most = 0;
        std::vector<double> crossings;
        for (int i = 1; crossings.size() < 9 && i < 2000; ++i) {
            corner.world.step(step);
            const double now = corner.rise();
            if (before < 0 && now >= 0) crossings.push_back(step * (i - now / (now - before)));
            before = now;
            most = std::max(most, energy());
        }
        ASSERT_EQ(crossings.size(), 9u);
        EXPECT_NEAR((crossings.back() - crossings.front()) / 8, period, 0.005 * period) << linkage.axle;
        EXPECT_LT(most, 1.01 * first) << linkage.axle;
    }
}

}  // namespace
}  // namespace ragtop
