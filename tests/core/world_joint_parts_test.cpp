#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <string>

#include "world_support.h"

// Limits, friction, breaking and the newer joints in a world, by both solvers.
namespace ragtop::test {
namespace {

WorldSettings settingsFor(SolverChoice solver, bool gravity) {
    WorldSettings settings;
    settings.solver = solver;
    settings.sleeping = false;
    if (!gravity) settings.gravity = {};
    return settings;
}

ReachPolygon concave() {
    const double corners[][2] = {{0, 70}, {45, 20}, {90, 80}, {150, 60}, {180, 25}, {225, 70}, {290, 40}};
    ReachPolygon polygon;
    for (const auto& corner : corners) {
        const double about = corner[0] * std::numbers::pi / 180, from = corner[1] * std::numbers::pi / 180;
        polygon.corners[static_cast<std::size_t>(polygon.count++)] = {
            toVec3(DVec3{std::cos(from), std::sin(from) * std::cos(about), std::sin(from) * std::sin(about)}),
            {-0.5f, 0.7f}};
    }
    return polygon;
}

/// Thrown in any limit, a rod stays within it and gains nothing.
TEST(WorldJointParts, SwingLimitsHoldAThrownRod) {
    BallDef defs[5];
    defs[0].swingEllipse = SwingEllipse{0.4f, 1.0f};
    defs[1].swingPyramid = SwingPyramid{{-0.3f, 0.8f}, {-0.6f, 0.5f}};
    defs[2].reach = concave();
    defs[3].swingLimit = 0.7f;
    defs[3].twistLimit = Range{-0.5f, 0.7f};
    defs[4].swingEllipse = SwingEllipse{1.5f, 0.5f};
    defs[4].stop.restitution = 0.5f;
    for (const SolverChoice solver : {SolverChoice::iterative, SolverChoice::direct})
        for (int shape = 0; shape < 5; ++shape)
            for (unsigned throwing = 0; throwing < 10; ++throwing) {
                World world(settingsFor(solver, false));
                BodyDef body = bodyDef(Box{{0.5f, 0.05f, 0.04f}}, {0.5, 0, 0});
                std::mt19937 random(throwing);
                std::normal_distribution<float> normal;
                body.angularVelocity = 5.0f * Vec3{normal(random), normal(random), normal(random)};
                body.linearVelocity = cross(body.angularVelocity, Vec3{0.5f, 0, 0});
                const BodyId rod = world.create(body);
                BallDef def = defs[shape];
                def.bodies.b = rod;
                def.bodies.frameB = {{-0.5f, 0, 0}, {}};
                const JointId joint = world.create(def);
                const double energy = world.energy();
                double worst = 0, most = 0;
                run(world, 2, kDt, [&] {
                    worst = std::max(worst, -static_cast<double>(world.state(joint).limitMargin));
                    most = std::max(most, world.energy() / energy);
                });
                EXPECT_LT(worst, 0.035) << "solver " << nameOf(solver) << ", shape " << shape << ", " << throwing;
                // Rows of direct islands are linear within a substep: the ball joint alone gives a fast rod 0.16 %.
                EXPECT_LE(most, solver == SolverChoice::iterative ? 1.001 : 1.002)
                    << "solver " << nameOf(solver) << ", shape " << shape << ", " << throwing;
            }
}

/// Whatever it turns about and however far it is out, nothing is gained on the way back: a cone that closes on a
/// spinning body would do work on it else.
TEST(WorldJointParts, ComingBackFromBeyondALimitAddsNoEnergy) {
    BallDef defs[4];
    defs[0].swingLimit = 0.3f;
    defs[1].swingEllipse = SwingEllipse{0.4f, 1.0f};
    defs[1].twistLimit = Range{-0.2f, 0.3f};
    defs[2].swingPyramid = SwingPyramid{{-0.3f, 0.8f}, {-0.6f, 0.5f}};
    defs[3].reach = concave();
    for (int shape = 0; shape < 4; ++shape)
        for (unsigned throwing = 0; throwing < 20; ++throwing) {
            World world(settingsFor(SolverChoice::iterative, false));
            std::mt19937 random(throwing);
            std::normal_distribution<float> normal;
            BodyDef body = bodyDef(Box{{0.5f, 0.05f, 0.04f}}, {});
            body.pose.rotation = normalized(Quat{normal(random), normal(random), normal(random), normal(random)});
            const Vec3 arm = rotate(body.pose.rotation, {0.5f, 0, 0});
            body.pose.position = DVec3(arm);
            body.angularVelocity = 5.0f * Vec3{normal(random), normal(random), normal(random)};
            body.linearVelocity = cross(body.angularVelocity, arm);
            BallDef def = defs[shape];
            def.bodies.b = world.create(body);
            def.bodies.frameB = {{-0.5f, 0, 0}, {}};
            world.create(def);
            world.step(kDt);  // what runs into the limit is lost at once
            // Speeds belong to a time that is uncertain by half a substep, in which the body turns by ω h/2.
            const double lag = asDouble(length(body.angularVelocity)) * kDt / world.settings().substeps / 2;
            const double most = (1 + 2 * lag) * world.energy() + 1e-4;
            run(world, 3, kDt, [&] { ASSERT_LE(world.energy(), most) << shape << ' ' << throwing; });
        }
}

TEST(WorldJointParts, FrictionStopsAWheelAfterTheExactAngle) {
    for (const SolverChoice solver : {SolverChoice::iterative, SolverChoice::direct})
        for (const double rate : {30.0, 60.0, 240.0}) {
            World world(settingsFor(solver, false));
            BodyDef body = bodyDef(Sphere{0.2f}, {});
            body.mass = MassProperties{2, {}, {{0.1f, 0, 0}, {0, 0.1f, 0}, {0, 0, 0.1f}}};
            body.angularVelocity = {0, 0, 10};
            const BodyId wheel = world.create(body);
            HingeDef def;
            def.bodies = {.b = wheel, .frameA = {{}, kAboutZ}, .frameB = {{}, kAboutZ}};
            def.friction = 0.5f;
            const JointId joint = world.create(def);
            run(world, 2.5, 1 / rate);
            EXPECT_NEAR(world.state(joint).coordinate, 10, 2e-3)
                << "solver " << nameOf(solver) << ", " << rate << " Hz";
        }
}

TEST(WorldJointParts, SpringsAreTheSameInBothSolvers) {
    for (const SolverChoice solver : {SolverChoice::iterative, SolverChoice::direct})
        for (const double zeta : {0.0, 0.3}) {
            World world(settingsFor(solver, false));
            BodyDef body = bodyDef(Sphere{0.2f}, {});
            body.mass = MassProperties{2, {}, {{0.1f, 0, 0}, {0, 0.1f, 0}, {0, 0, 0.1f}}};
            const BodyId wheel = world.create(body);
            const double omega = 2 * std::numbers::pi * 2;
            HingeDef def;
            def.bodies = {.b = wheel, .frameA = {{}, kAboutZ}, .frameB = {{}, kAboutZ}};
            def.spring = Spring{static_cast<float>(0.1 * omega * omega), static_cast<float>(2 * zeta * 0.1 * omega)};
            def.target = 0.4f;
            const JointId joint = world.create(def);
            double worst = 0;
            for (int i = 1; i <= 120; ++i) {
                world.step(kDt);
                const double t = i * kDt, w = omega * std::sqrt(1 - zeta * zeta), a = zeta * omega;
                const double exact = 0.4 * (1 - std::exp(-a * t) * (std::cos(w * t) + a / w * std::sin(w * t)));
                worst = std::max(worst, std::abs(static_cast<double>(world.state(joint).coordinate) - exact));
            }
            EXPECT_LT(worst, 4e-4) << "solver " << nameOf(solver) << ", zeta " << zeta;
        }
}

TEST(WorldJointParts, StopsReboundInBothSolvers) {
    for (const SolverChoice solver : {SolverChoice::iterative, SolverChoice::direct})
        for (const float restitution : {0.0f, 0.5f}) {
            World world(settingsFor(solver, false));
            BodyDef body = bodyDef(Box{{0.5f, 0.05f, 0.05f}}, {0.5, 0, 0});
            body.angularVelocity = {0, 0, 5};
            body.linearVelocity = {0, 2.5f, 0};
            const BodyId rod = world.create(body);
            HingeDef def;
            def.bodies = {.b = rod, .frameA = {{}, kAboutZ}, .frameB = {{-0.5f, 0, 0}, kAboutZ}};
            def.limit = Range{-3, 1};
            def.stop.restitution = restitution;
            const JointId joint = world.create(def);
            float most = 0;
            run(world, 0.6, kDt, [&] { most = std::max(most, world.state(joint).coordinate); });
            EXPECT_NEAR(world.state(joint).speed, -5 * restitution, 0.05 * 5 * restitution + 1e-3) << nameOf(solver);
            EXPECT_LT(most, 1 + 1e-3f);
        }
}

/// ẍ + 2ζω ẋ + ω² x = 0 from x = 0 until k x + c ẋ = 0, at a turn of atan2(2ζ√(1 − ζ²), 2ζ² − 1).
TEST(WorldJointParts, SoftStopLeavesWithTheSpeedOfTheDampedOscillator) {
    for (const double zeta : {0.0, 0.2, 0.4, 0.6}) {
        World world(settingsFor(SolverChoice::iterative, false));
        BodyDef body = bodyDef(Sphere{0.2f}, {});
        body.mass = MassProperties{2, {}, {{0.1f, 0, 0}, {0, 0.1f, 0}, {0, 0, 0.1f}}};
        body.angularVelocity = {0, 0, 4};
        const BodyId wheel = world.create(body);
        const double omega = 2 * std::numbers::pi * 3, lean = std::sqrt(1 - zeta * zeta);
        HingeDef def;
        def.bodies = {.b = wheel, .frameA = {{}, kAboutZ}, .frameB = {{}, kAboutZ}};
        def.limit = Range{-10, 0.2f};
        def.stop.stiffness = static_cast<float>(0.1 * omega * omega);
        def.stop.damping = static_cast<float>(2 * zeta * 0.1 * omega);
        const JointId joint = world.create(def);
        run(world, 0.4);
        const double turn = zeta > 0 ? std::atan2(2 * zeta * lean, 2 * zeta * zeta - 1) : std::numbers::pi;
        const double exact = 4 * std::exp(-zeta * turn / lean) * (std::cos(turn) - zeta / lean * std::sin(turn));
        // When it lets go is known to a substep, in which the push changes by (ω/240)²/2 = 0.3 % of the speed.
        EXPECT_NEAR(asDouble(world.state(joint).speed), exact, 0.005 * -exact) << zeta;
    }
}

TEST(WorldJointParts, NewJointsHoldInBothSolvers) {
    for (const SolverChoice solver : {SolverChoice::iterative, SolverChoice::direct})
        for (int kind = 0; kind < 4; ++kind) {
            World world(settingsFor(solver, true));
            const BodyId body = world.create(bodyDef(Box{{0.3f, 0.1f, 0.1f}}, {0.5, 0, 0}));
            const JointBodies bodies{.b = body, .frameB = {{-0.5f, 0, 0}, {}}};
            const JointDef defs[] = {CylindricalDef{bodies, {}, {}}, UniversalDef{bodies, {}, {}},
                                     PlaneDef{bodies, {}, {}, {}}, ScrewDef{bodies, 0.5f, {}}};
            const JointId joint = world.create(defs[kind]);
            double worst = 0;
            run(world, 3, kDt, [&] { worst = std::max(worst, static_cast<double>(world.state(joint).gap)); });
            EXPECT_LT(worst, kind == 2 ? 5e-3 : 2e-3) << "solver " << nameOf(solver) << ", kind " << kind;
        }
}

/// A body that is made where it touches has its loads found before the step moves: that is no load of a joint
/// elsewhere.
TEST(WorldJointParts, ABodyMadeOnTheGroundBreaksNoJointElsewhere) {
    World world(settingsFor(SolverChoice::iterative, true));
    BodyDef floor = bodyDef(Box{{50, 0.5f, 50}}, {0, -0.5, 0});
    floor.type = BodyType::fixed;
    world.create(floor);
    const BodyId body = world.create(bodyDef(Box{{0.2f, 0.2f, 0.2f}}, {0, 3, 0}));
    BallDef def;
    def.bodies.b = body;
    def.bodies.frameA = {{0, 3, 0}, {}};
    def.bodies.breakForce = 1.2f * world.mass(body).mass * kGravity;
    world.create(def);
    run(world, 0.5, kDt, [] {});
    world.create(bodyDef(Box{{0.5f, 0.5f, 0.5f}}, {5, 0.5, 0}));
    run(world, 0.5, kDt, [&] { EXPECT_TRUE(world.jointBreaks().empty()) << world.time(); });
}

TEST(WorldJointParts, BreaksAtItsForceAndTellsOnce) {
    for (const SolverChoice solver : {SolverChoice::iterative, SolverChoice::direct})
        for (const float share : {0.97f, 1.03f}) {
            World world(settingsFor(solver, true));
            const BodyId body = world.create(bodyDef(Box{{0.2f, 0.2f, 0.2f}}, {}));
            FixedDef def;
            def.bodies.b = body;
            def.bodies.userData = 7;
            def.bodies.breakForce = share * world.mass(body).mass * kGravity;
            const JointId joint = world.create(def);
            int events = 0;
            run(world, 1, kDt, [&] {
                for (const JointBreak& event : world.jointBreaks()) {
                    ++events;
                    EXPECT_TRUE(event.joint == joint);
                    EXPECT_TRUE(event.bodyB == body);
                    EXPECT_EQ(event.userData, 7u);
                    EXPECT_GT(length(event.force), def.bodies.breakForce);
                }
            });
            EXPECT_EQ(events, share < 1 ? 1 : 0) << nameOf(solver);
            EXPECT_EQ(world.isValid(joint), share > 1);
            EXPECT_EQ(height(world, body) < -1, share < 1);
        }
}

TEST(WorldJointParts, BreaksAtItsTorque) {
    for (const float share : {0.97f, 1.03f}) {
        World world(settingsFor(SolverChoice::automatic, true));
        const BodyId body = world.create(bodyDef(Box{{0.5f, 0.1f, 0.1f}}, {0.5, 0, 0}));
        FixedDef def;
        def.bodies.b = body;
        def.bodies.frameB.position = {-0.5f, 0, 0};
        def.bodies.breakTorque = share * world.mass(body).mass * kGravity * 0.5f;
        const JointId joint = world.create(def);
        run(world, 1);
        EXPECT_EQ(world.isValid(joint), share > 1);
    }
}

/// Swing limits less than a quarter turn wide lie ahead of the joint, along the x axis of A's frame.
TEST(WorldJointParts, SwingLimitsAreDrawnOnTheSideTheyAreOn) {
    struct Lines : DebugDraw {
        DVec3 least{1e9, 0, 0};
        void line(const DVec3& from, const DVec3& to, Color) override { least.x = std::min({least.x, from.x, to.x}); }
    };
    BallDef defs[4];
    defs[0].swingLimit = 0.5f;
    defs[1].swingEllipse = SwingEllipse{0.3f, 0.9f};
    defs[2].swingPyramid = SwingPyramid{{-0.3f, 0.8f}, {-0.6f, 0.4f}};
    defs[3].reach = concave();
    for (BallDef& def : defs) {
        World world(settingsFor(SolverChoice::iterative, false));
        def.bodies.b = world.create(bodyDef(Box{{0.5f, 0.05f, 0.04f}}, {5.5, 0, 0}));
        def.bodies.frameA.position = {5, 0, 0};
        def.bodies.frameB.position = {-0.5f, 0, 0};
        world.create(def);
        Lines lines;
        lines.options = {.shapes = false, .joints = true};
        world.draw(lines);
        EXPECT_GT(lines.least.x, 5 - 1e-6);
        EXPECT_LT(lines.least.x, 5 + 1e-6);
    }
}

TEST(WorldJointParts, BadDefinitionsSayWhatIsWrong) {
    World world;
    const BodyId body = world.create(bodyDef(Sphere{0.2f}, {}));
    const auto refuses = [&](auto def, const std::string& part) {
        def.bodies.b = body;
        expectMessage([&] { world.create(JointDef(def)); }, part);
    };
    BallDef ball;
    ball.swingLimit = 1;
    ball.swingEllipse = SwingEllipse{1, 1};
    refuses(ball, "must be at most one");
    ball = {};
    ball.swingEllipse = SwingEllipse{0, 1};
    refuses(ball, "swingEllipse.y is 0");
    ball = {};
    ball.reach = ReachPolygon{};
    refuses(ball, "reach.count is 0");
    ball.reach = concave();
    ball.twistLimit = Range{-1, 1};
    refuses(ball, "twistLimit");
    HingeDef hinge;
    hinge.stop.restitution = 1.5f;
    refuses(hinge, "stop.restitution is 1.5");
    hinge = {};
    hinge.bearing = Bearing{0, -1, 0, 0};
    refuses(hinge, "bearing.viscous is -1");
    hinge = {};
    hinge.motor = Motor{1, 1, -2.0f};
    refuses(hinge, "motor.maxReverse is -2");
    hinge = {};
    hinge.bodies.breakForce = 0;
    refuses(hinge, "breakForce");
    CylindricalDef cylindrical;
    cylindrical.travel.limit = Range{1, -1};
    refuses(cylindrical, "travel.limit.lower is 1");
    ScrewDef screw;
    screw.pitch = std::nanf("");
    refuses(screw, "pitch");
}

}  // namespace
}  // namespace ragtop::test
