#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "constraints/joint_path.h"
#include "world_support.h"

// Beads on wires, and joints with all six degrees of freedom.
namespace ragtop::test {
namespace {

Curve circle(float radius, int points) {
    Curve curve;
    curve.closed = true;
    curve.count = points;
    for (int i = 0; i < points; ++i) {
        const double angle = 2 * std::numbers::pi * i / points;
        curve.points[static_cast<std::size_t>(i)] = {static_cast<float>(radius * std::cos(angle)), 0,
                                                     static_cast<float>(radius * std::sin(angle))};
    }
    return curve;
}

/// Between 16 points, h = π/8 apart, a cubic leaves a circle of radius 2 by 2 h⁴/384 = 1.2e-4.
TEST(Path, GoesThroughItsPointsWithoutJumpsOfCurvature) {
    PathRows path;
    compile(path, circle(2, 16), false);
    EXPECT_NEAR(asDouble(path.length), 4 * std::numbers::pi, 1e-3);
    for (std::uint32_t s = 0; s < path.segments; ++s) {
        const CurvePoint end = curvePoint(path, s, 1), begin = curvePoint(path, (s + 1) % path.segments, 0);
        EXPECT_LT(length(end.place - begin.place), 1e-6f);
        EXPECT_LT(length(end.tangent - begin.tangent), 1e-5f);
        EXPECT_LT(length(end.curvature - begin.curvature), 1e-4f);
        EXPECT_NEAR(asDouble(length(curvePoint(path, s, 0.5f).place)), 2, 2e-4);
        EXPECT_NEAR(asDouble(length(curvePoint(path, s, 0.5f).curvature)), 0.5, 5e-3);
    }
}

/// Without friction the speed along a level curve stays, and laps add up.
TEST(Path, KeepsTheSpeedOfABeadAndCountsItsLaps) {
    for (const SolverChoice solver : {SolverChoice::iterative, SolverChoice::direct}) {
        WorldSettings settings = withoutSleep();
        settings.solver = solver;
        World world(settings);
        BodyDef bead = bodyDef(Sphere{0.05f}, {2, 0, 0});
        bead.linearVelocity = {0, 0, 3};
        const BodyId body = world.create(bead);
        PathDef def;
        def.bodies.b = body;
        def.curve = circle(2, 16);
        const JointId joint = world.create(def);
        double gap = 0;
        run(world, 20, kDt, [&] { gap = std::max(gap, asDouble(world.state(joint).gap)); });
        EXPECT_NEAR(asDouble(length(world.linearVelocity(body))), 3, 0.01) << nameOf(solver);
        EXPECT_NEAR(asDouble(world.state(joint).coordinate), 60, 0.2) << nameOf(solver);
        EXPECT_LT(gap, 1e-3) << nameOf(solver);
    }
}

/// The way of a substep turns by θ = v h/r = 0.1, and a row knows by what it bends: what is left is of third order. The
/// spring of a row would give way by v²/r (2πf)⁻² = 3.6 mm.
TEST(Path, HoldsAFastBeadOnATightCurve) {
    constexpr double kSpeed = 6, kRadius = 0.25;
    World world(withoutGravity());
    BodyDef bead = bodyDef(Sphere{0.05f}, {kRadius, 0, 0});
    bead.linearVelocity = {0, 0, static_cast<float>(kSpeed)};
    const BodyId body = world.create(bead);
    PathDef def;
    def.bodies.b = body;
    def.curve = circle(static_cast<float>(kRadius), 16);
    const JointId joint = world.create(def);
    double gap = 0;
    run(world, 2, kDt, [&] { gap = std::max(gap, asDouble(world.state(joint).gap)); });
    EXPECT_LT(gap, kRadius * std::pow(kSpeed / kRadius / 240, 3) / 2);
    EXPECT_NEAR(asDouble(length(world.linearVelocity(body))), kSpeed, 1e-3 * kSpeed);
}

/// A bead on a loop that stands: v² = v₀² − 2 g y.
TEST(Path, TradesSpeedForHeight) {
    World world(withoutSleep());
    BodyDef bead = bodyDef(Sphere{0.05f}, {0, 0, 0});
    const float fast = 10;
    bead.linearVelocity = {fast, 0, 0};
    const BodyId body = world.create(bead);
    PathDef def;
    def.bodies.b = body;
    def.curve = circle(1, 16);
    // The circle's x-z plane stands in x-y with its first point below.
    def.bodies.frameA = {{0, 1, 0}, rotationAbout({0, 0, 1}, -kPi / 2) * rotationAbout({1, 0, 0}, -kPi / 2)};
    const JointId joint = world.create(def);
    const double before = world.energy();
    double worst = 0, high = 0;
    run(world, 10, kDt, [&] {
        worst = std::max(worst, std::abs(world.energy() - before));
        high = std::max(high, world.pose(body).position.y);
    });
    EXPECT_GT(high, 1.95);
    // Rows of 0.28/h leave the ½ κ (v h)² of a substep, 0.9 mm, over three times.
    EXPECT_LT(asDouble(world.state(joint).gap), 4e-3);
    EXPECT_LT(worst, 0.02 * before);
}

TEST(Path, StopsAtTheEndsOfAnOpenCurve) {
    World world(withoutSleep());
    BodyDef bead = bodyDef(Sphere{0.05f}, {0.5, 0, 0});
    const BodyId body = world.create(bead);
    PathDef def;
    def.bodies.b = body;
    def.curve.count = 3;
    def.curve.points[0] = {0, 0.2f, 0};
    def.curve.points[1] = {0.5f, 0, 0};
    def.curve.points[2] = {1, -0.5f, 0};
    const JointId joint = world.create(def);
    run(world, 3);
    EXPECT_NEAR(world.pose(body).position.x, 1, 1e-3);
    EXPECT_NEAR(world.pose(body).position.y, -0.5, 1e-3);
    EXPECT_NEAR(asDouble(world.state(joint).limitMargin), 0, 1e-3);
}

TEST(Path, PointsABodyAlongIt) {
    World world(withoutGravity());
    BodyDef car = bodyDef(Box{{0.2f, 0.1f, 0.1f}}, {2, 0, 0});
    car.pose.rotation = rotationBetween({1, 0, 0}, {0, 0, 1});
    car.linearVelocity = {0, 0, 4};
    car.angularVelocity = {0, -2, 0};
    const BodyId body = world.create(car);
    PathDef def;
    def.bodies.b = body;
    def.curve = circle(2, 12);
    def.align = true;
    world.create(def);
    double worst = 0;
    run(world, 5, kDt, [&] {
        const Pose pose = world.pose(body);
        const Vec3 out = normalized(toVec3(pose.position));
        const Vec3 along = cross(out, {0, 1, 0});
        worst = std::max(worst, asDouble(length(rotate(pose.rotation, {1, 0, 0}) - along)));
    });
    EXPECT_LT(worst, 0.02);
    EXPECT_NEAR(asDouble(length(world.linearVelocity(body))), 4, 0.04);
}

TEST(Path, SaysWhichPointsAreTooNear) {
    World world;
    PathDef def;
    def.bodies.b = world.create(bodyDef(Sphere{0.1f}, {}));
    def.curve.count = 2;
    def.curve.points[1] = {NAN, 0, 0};
    EXPECT_THROW(world.create(def), std::invalid_argument);
    def.curve.points[1] = {};
    EXPECT_THROW(world.create(def), std::invalid_argument);
    def.curve.points[1] = {1, 0, 0};
    def.curve.closed = true;
    EXPECT_THROW(world.create(def), std::invalid_argument);
    def.curve.closed = false;
    EXPECT_NO_THROW(world.create(def));
}

AxisDef locked() {
    AxisDef axis;
    axis.limit = Range{0, 0};
    return axis;
}

/// Locked as a hinge, slider or ball is, it moves as that joint does.
TEST(SixDof, MovesAsTheJointThatItsLocksMakeIt) {
    for (int kind = 0; kind < 3; ++kind) {
        Vec3 places[2];
        float speed = 0;
        for (int sixDof = 0; sixDof < 2; ++sixDof) {
            World world(withoutSleep());
            BodyDef body = bodyDef(Box{{0.4f, 0.1f, 0.2f}}, {0.4, 0, 0});
            body.angularVelocity = kind == 0 ? Vec3{0, 0, 2} : kind == 2 ? Vec3{1, 0.5f, 2} : Vec3{};
            body.linearVelocity = kind == 1 ? Vec3{} : cross(body.angularVelocity, Vec3{0.4f, 0, 0});
            JointBodies ends;
            ends.b = world.create(body);
            ends.frameB.position = {-0.4f, 0, 0};
            const Quat turned = kind == 0   ? rotationBetween({1, 0, 0}, {0, 0, 1})
                                : kind == 1 ? rotationBetween({1, 0, 0}, normalized(Vec3{1, -1, 0}))
                                            : Quat{};
            ends.frameA.rotation = ends.frameB.rotation = turned;
            SixDofDef def{ends, locked(), locked(), locked(), locked(), locked(), locked()};
            if (kind == 0) def.twist = {};
            if (kind == 1) def.x = {};
            if (kind == 2) def.twist = def.swingY = def.swingZ = {};
            HingeDef hinge;
            hinge.bodies = ends;
            SliderDef slider;
            slider.bodies = ends;
            BallDef ball;
            ball.bodies = ends;
            const JointDef plain = kind == 0 ? JointDef(hinge) : kind == 1 ? JointDef(slider) : JointDef(ball);
            world.create(sixDof ? JointDef(def) : plain);
            run(world, 0.8);
            places[sixDof] = toVec3(world.pose(ends.b).position);
            speed = length(world.linearVelocity(ends.b));
        }
        // What hangs from a bare hinge or ball is a tree of joints and leaps; sweeps are ahead by half a substep.
        EXPECT_LT(length(places[0] - places[1]), static_cast<float>(kDt / 8) * speed) << kind;
    }
}

TEST(SixDof, LimitsAndDrivesEachOfItsAxes) {
    World world(withoutSleep());
    SixDofDef def;
    def.bodies.b = world.create(bodyDef(Box{{0.1f, 0.2f, 0.3f}}, {}));
    def.x.spring = Spring{.frequency = 3};
    def.x.target = 0.4f;
    def.y.limit = Range{-0.25f, 0.1f};
    def.z = locked();
    def.twist.spring = Spring{.frequency = 3};
    def.twist.target = 0.5f;
    def.swingY.spring = Spring{.frequency = 3};
    def.swingY.target = -0.7f;
    def.swingZ.motor = Motor{2, 50};
    def.swingZ.limit = Range{-0.1f, 0.9f};
    const JointId joint = world.create(def);
    double worst = 0;
    run(world, 6, kDt, [&] { worst = std::max(worst, -asDouble(world.state(joint).limitMargin)); });
    const JointState state = world.state(joint);
    EXPECT_NEAR(asDouble(state.travel.x), 0.4, 1e-3);
    EXPECT_NEAR(asDouble(state.travel.y), -0.25, 1e-3);
    EXPECT_NEAR(asDouble(state.travel.z), 0, 1e-3);
    EXPECT_NEAR(asDouble(state.coordinate), 0.5, 2e-3);
    EXPECT_NEAR(asDouble(state.second), -0.7, 2e-3);
    EXPECT_NEAR(asDouble(state.third), 0.9, 2e-3);
    EXPECT_LT(worst, 2e-3);
}

/// What springs hold a body by has energy as long as it swings; steps of h let it go to and fro by ω h of itself.
TEST(SixDof, ItsSpringsKeepTheirEnergy) {
    World world(withoutGravity());
    BodyDef body = bodyDef(Box{{0.2f, 0.2f, 0.2f}}, {});
    body.angularVelocity = {1, 4, -3};
    SixDofDef def;
    def.bodies.b = world.create(body);
    const float inertia = world.mass(def.bodies.b).inertia.cx.x;
    for (AxisDef* axis : {&def.x, &def.y, &def.z}) *axis = locked();
    for (AxisDef* axis : {&def.twist, &def.swingY, &def.swingZ}) axis->spring = Spring{.stiffness = 30 * inertia};
    const JointId joint = world.create(def);
    double least = 1e9, most = 0;
    run(world, 10, kDt, [&] {
        const JointState s = world.state(joint);
        const double twist = asDouble(s.coordinate), y = asDouble(s.second), z = asDouble(s.third);
        const double energy = world.energy() + 15 * asDouble(inertia) * (twist * twist + y * y + z * z);
        least = std::min(least, energy), most = std::max(most, energy);
    });
    EXPECT_LT(most - least, 1.1 * std::sqrt(30) / 240 * most);
}

}  // namespace
}  // namespace ragtop::test
