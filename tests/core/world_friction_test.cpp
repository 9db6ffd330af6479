#include "world_support.h"

namespace ragtop {
namespace {

using namespace test;

/// Gravity of a slope of angle θ whose fall line has the heading φ on a level floor: the law of the inclined plane
/// without an inclined body.
WorldSettings slope(double theta, double heading) {
    WorldSettings settings;
    settings.gravity = {static_cast<float>(9.81 * std::sin(theta) * std::cos(heading)),
                        static_cast<float>(-9.81 * std::cos(theta)),
                        static_cast<float>(9.81 * std::sin(theta) * std::sin(heading))};
    settings.sleeping = false;
    return settings;
}

double slideSpeed(const World& world, BodyId body) {
    const Vec3 v = world.linearVelocity(body);
    return std::sqrt(v.x * v.x + v.z * v.z);
}

const double kHeadings[] = {0, kPi / 8, kPi / 4};

// Inside the cone the friction row is a rigid velocity row: slip after the bias pass, with which positions move, is
// rounding, ε g sinθ h per substep of 1/240 s at most: 1e-7 · 10 · 4e-3 = 4e-9 m/s, but the two rows, tilt and spin
// couple through single sweeps. 1e-5 m/s is 0.01 sizes in 1000 s.
TEST(WorldFriction, ASlopeBelowTheFrictionAngleHolds) {
    const double theta = 0.4;
    for (const double heading : kHeadings) {
        World world(slope(theta, heading));
        const Material material = surface(static_cast<float>(1.01 * std::tan(theta)));
        addFloor(world, material);
        const BodyId box = world.create(bodyDef(Box{{0.5f, 0.5f, 0.5f}}, {0, 0.5, 0}, material));
        run(world, 2);
        const DVec3 start = world.pose(box).position;
        run(world, 10);
        EXPECT_LT(distanceBetween(world.pose(box).position, start), 1e-4) << heading;
    }
}

// a = g (sin θ − μ cos θ); at μ = 0.99 tan θ that is a hundredth of g sin θ, so 1 % of it is 1e-4 of the weight.
TEST(WorldFriction, ASlopeAboveTheFrictionAngleSlidesByCoulombsLaw) {
    const double theta = 0.4;
    for (const double share : {0.99, 0.5}) {
        for (const double heading : kHeadings) {
            World world(slope(theta, heading));
            const Material material = surface(static_cast<float>(share * std::tan(theta)));
            addFloor(world, material);
            const BodyId box = world.create(bodyDef(Box{{0.5f, 0.25f, 0.5f}}, {0, 0.25, 0}, material));
            run(world, 2);
            const double v0 = slideSpeed(world, box);
            run(world, 2);
            const double a = (slideSpeed(world, box) - v0) / 2;
            const double expected = 9.81 * (std::sin(theta) - share * std::tan(theta) * std::cos(theta));
            EXPECT_NEAR(a, expected, 0.01 * expected) << share << " " << heading;
            const Vec3 v = world.linearVelocity(box);
            EXPECT_NEAR(std::atan2(v.z, v.x), heading, 0.01) << share;
        }
    }
}

TEST(WorldFriction, ATiltedFloorHoldsAndLetsGoLikeTiltedGravity) {
    const float theta = 0.4f;
    for (const float azimuth : {0.0f, kPi / 8, kPi / 4, 2.0f}) {
        for (const float share : {1.01f, 0.99f}) {
            World world(withoutSleep());
            const Quat tilt = rotationAbout({0, 1, 0}, azimuth) * rotationAbout({0, 0, 1}, -theta);
            const Material material = surface(share * std::tan(theta));
            BodyDef floor = bodyDef(Box{{50, 1, 50}}, {}, material, BodyType::fixed);
            floor.pose = {DVec3(rotate(tilt, {0, -1, 0})), tilt};
            world.create(floor);
            BodyDef def = bodyDef(Box{{0.5f, 0.25f, 0.5f}}, {}, material);
            def.pose = {DVec3(rotate(tilt, {0, 0.25f, 0})), tilt};
            const BodyId box = world.create(def);
            run(world, 2);
            const DVec3 start = world.pose(box).position;
            const float v0 = length(world.linearVelocity(box));
            run(world, 5);
            const double moved = distanceBetween(world.pose(box).position, start);
            const double a = 0.01 * 9.81 * std::sin(theta);
            if (share > 1)
                EXPECT_LT(moved, 1e-4) << azimuth;
            else
                EXPECT_NEAR(moved, v0 * 5 + 0.5 * a * 25, 0.01 * (v0 * 5 + 0.5 * a * 25)) << azimuth;
        }
    }
}

// d = v² / (2 μ g). The position map makes steady sliding an exact parabola; the last substep stops within h v_last
// ≤ μ g h². 0.5 % allows for the load of the two edges changing when sliding begins.
TEST(WorldFriction, StoppingDistanceDoesNotDependOnHeading) {
    double least = 1e9, most = 0;
    for (int i = 0; i < 16; ++i) {
        const double heading = i * static_cast<double>(kPi) / 8;
        World world(withoutSleep());
        addFloor(world, surface(0.5f));
        const BodyId box = world.create(bodyDef(Box{{0.5f, 0.25f, 0.5f}}, {0, 0.25, 0}, surface(0.5f)));
        run(world, 1);
        const DVec3 start = world.pose(box).position;
        world.setVelocity(
            box, {static_cast<float>(5 * std::cos(heading)), 0, static_cast<float>(5 * std::sin(heading))}, {});
        run(world, 2);
        EXPECT_LT(length(world.linearVelocity(box)), 1e-4f);
        const DVec3 end = world.pose(box).position;
        const double d = std::hypot(end.x - start.x, end.z - start.z);
        const double expected = 25 / (2 * 0.5 * 9.81);
        EXPECT_NEAR(d, expected, 0.005 * expected) << i;
        EXPECT_NEAR(std::atan2((end.z - start.z) * std::cos(heading) - (end.x - start.x) * std::sin(heading),
                               (end.x - start.x) * std::cos(heading) + (end.z - start.z) * std::sin(heading)),
                    0, 0.005);
        least = std::min(least, d), most = std::max(most, d);
    }
    EXPECT_LT(most - least, 0.005 * most);
}

// A ball that slides begins to roll when v = ω r: from v0 without spin, friction at r takes 2/7 of the speed
// (m v r + ⅖ m r² ω is kept about the contact point).
TEST(WorldFriction, ASlidingBallRollsAtFiveSeventhsOfItsSpeed) {
    World world(withoutSleep());
    addFloor(world, surface(0.5f));
    const BodyId ball = world.create(bodyDef(Sphere{0.5f}, {0, 0.5, 0}, surface(0.5f)));
    run(world, 1);
    world.setVelocity(ball, {0, 0, 7}, {});
    run(world, 2);
    const double v = world.linearVelocity(ball).z;
    EXPECT_NEAR(v, 5, 1e-3 * 5);
    EXPECT_NEAR(world.angularVelocity(ball).x * 0.5, v, 2e-4 * 5);
    run(world, 3);
    EXPECT_NEAR(world.linearVelocity(ball).z, v, 0.002 * 5);
}

// The resisting moment is rr N. Rolling: m a = −F, ⅖ m r² α = F r − rr N, a = α r  ⇒  a = −(5/7) g rr / r, so the ball
// stops after v² / (2 a) = 7 v² r / (10 g rr).
TEST(WorldFriction, RollingResistanceStopsABall) {
    World world(withoutSleep());
    addFloor(world, surface(0.8f));
    const BodyId ball = world.create(bodyDef(Sphere{0.5f}, {0, 0.5, 0}, surface(0.8f, 0, 0.05f)));
    run(world, 1);
    const DVec3 start = world.pose(ball).position;
    world.setVelocity(ball, {3, 0, 0}, {0, 0, -6});
    run(world, 8);
    EXPECT_LT(length(world.linearVelocity(ball)), 1e-3f);
    const double expected = 7 * 9 * 0.5 / (10 * 9.81 * 0.05);
    EXPECT_NEAR(world.pose(ball).position.x - start.x, expected, 0.01 * expected);
}

// Balls under a board roll at half its speed, and each takes m a (1/4 + I/(4 m r²)) = 0.35 m a from it. The board touches
// them below its middle; pushed there it stays level. A point of contact that did not stay over the ball would have a
// part of its turning along the normal, and the board would sink. Loads begin as the weight in equal shares, whatever
// pushes: sweeps with the push move a twentieth of it.
TEST(WorldFriction, ABoardRollsOnBallsAndKeepsItsHeight) {
    World world(withoutSleep());
    addFloor(world, surface(0.8f));
    BodyDef ball = bodyDef(Sphere{0.1f}, {}, surface(0.8f)), board = bodyDef(Box{{2, 0.1f, 2}}, {0, 0.3, 0}, surface(0.8f));
    ball.shapes[0].density = 1 / massOf(Sphere{0.1f}, 1).mass;
    board.shapes[0].density = 10 / massOf(Box{{2, 0.1f, 2}}, 1).mass;
    std::vector<BodyId> balls;
    for (const double x : {-1.5, 0.0, 1.5})
        for (const double z : {-1.5, 0.0, 1.5}) {
            ball.pose.position = {x, 0.1, z};
            balls.push_back(world.create(ball));
        }
    const BodyId top = world.create(board);
    const double push = 60, acceleration = push / (10 + 9 * 0.35);
    for (int i = 1; i <= 30; ++i) {
        world.applyForce(top, {static_cast<float>(push), 0, 0}, world.pose(top).position + DVec3{0, -0.1, 0});
        world.step(kDt);
        if (i == 1)
            for (const BodyId id : balls)
                world.forEachContact(id, [&](const Contact& contact) {
                    const double carried = contact.bodyA == top || contact.bodyB == top ? 10.0 / 9 : 19.0 / 9;
                    EXPECT_NEAR(contact.normalForce, carried * 9.81, 0.1 * carried * 9.81);
                });
        EXPECT_NEAR(height(world, top), 0.3, 5e-4 * 0.1) << "step " << i;  // of the radius
    }
    EXPECT_NEAR(world.linearVelocity(top).x, acceleration * 0.5, 1e-3 * acceleration * 0.5);
    EXPECT_NEAR(world.linearVelocity(balls[4]).x, acceleration * 0.25, 1e-3 * acceleration * 0.25);
}

TEST(WorldFriction, ABallRollsDownASlopeWithFiveSeventhsOfTheSlide) {
    const double theta = 0.3;
    World world(slope(theta, 0.5));
    addFloor(world, surface(0.8f));
    const BodyId ball = world.create(bodyDef(Sphere{0.5f}, {0, 0.5, 0}, surface(0.8f)));
    run(world, 1);
    const double v0 = slideSpeed(world, ball);
    run(world, 2);
    const double expected = 5.0 / 7 * 9.81 * std::sin(theta);
    EXPECT_NEAR((slideSpeed(world, ball) - v0) / 2, expected, 0.005 * expected);
}

// On a belt of speed u a box slips for u / (μ g) and over u² / (2 μ g) of the belt, then rides with it.
TEST(WorldFriction, AConveyorTakesABoxAlong) {
    for (const double heading : kHeadings) {
        World world(withoutSleep());
        Material belt = surface(0.5f);
        belt.surfaceVelocity = {static_cast<float>(2 * std::cos(heading)), 0,
                                static_cast<float>(2 * std::sin(heading))};
        const BodyId floor = addFloor(world, surface(0.5f));
        const BodyId box = world.create(bodyDef(Box{{0.5f, 0.25f, 0.5f}}, {0, 0.25, 0}, surface(0.5f)));
        run(world, 1);
        world.setMaterial(world.shapes(floor)[0], belt);
        run(world, 2);
        const DVec3 p = world.pose(box).position;
        const double along = p.x * std::cos(heading) + p.z * std::sin(heading);
        // Distance moved is u t − u² / (2 μ g).
        EXPECT_NEAR(2 * 2 - along, 4 / (2 * 0.5 * 9.81), 0.01) << heading;
        EXPECT_NEAR(p.z * std::cos(heading) - p.x * std::sin(heading), 0, 0.005) << heading;
        EXPECT_NEAR(slideSpeed(world, box), 2, 1e-3);
    }
}

TEST(WorldFriction, ABeltOnATurnedBodyRunsAlongTheBody) {
    World world(withoutSleep());
    Material belt = surface(0.8f);
    belt.surfaceVelocity = {1, 0, 0};
    BodyDef floor = bodyDef(Box{{20, 1, 20}}, {0, -1, 0}, belt, BodyType::fixed);
    floor.pose.rotation = rotationAbout({0, 1, 0}, kPi / 2);
    world.create(floor);
    const BodyId box = world.create(bodyDef(Box{{0.5f, 0.25f, 0.5f}}, {0, 0.25, 0}, surface(0.8f)));
    run(world, 2);
    EXPECT_NEAR(world.linearVelocity(box).z, -1, 1e-3);
    EXPECT_NEAR(world.linearVelocity(box).x, 0, 1e-3);
}

// A spinning top on its flat face: twist friction stops it. For a square face of half width a under even pressure the
// mean lever is 0.765 a; four corner points carry lever √2 a, which brakes √2/0.765 faster. Both are bounds.
TEST(WorldFriction, TwistFrictionStopsASpinningBox) {
    World world(withoutSleep());
    addFloor(world, surface(0.5f));
    const BodyId box = world.create(bodyDef(Box{{0.5f, 0.1f, 0.5f}}, {0, 0.1, 0}, surface(0.5f)));
    run(world, 1);
    world.setVelocity(box, {}, {0, 10, 0});
    double t = 0;
    while (std::abs(world.angularVelocity(box).y) > 1e-3f && t < 5) {
        world.step(kDt);
        t += kDt;
    }
    // I ω / (μ m g lever) with I = m (1 + 1) / 12
    const double slow = 10.0 / 6 / (0.5 * 9.81 * 0.765 * 0.5), fast = 10.0 / 6 / (0.5 * 9.81 * std::sqrt(2.0) * 0.5);
    EXPECT_LT(t, slow);
    EXPECT_GT(t, 0.95 * fast);
    EXPECT_LT(std::hypot(world.pose(box).position.x, world.pose(box).position.z), 0.01);
}

}  // namespace
}  // namespace ragtop
