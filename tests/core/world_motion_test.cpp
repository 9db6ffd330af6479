#include "world_support.h"

namespace ragtop {
namespace {

using namespace test;

// The position map is exact for constant acceleration, so only rounding is left: per substep a velocity rounds by
// ε v, n substeps drift by at most n ε v t / 2: 240 · 1.2e-7 · 9.81 / 2 = 1.4e-4 m of 4.9 m if all had one sign, and
// about √n less as they have not.
TEST(WorldMotion, FreeFallIsAParabola) {
    World world;
    const BodyId ball = world.create(DynamicBody{.shape = Sphere{0.5f}, .position = {0, 100, 0}});
    for (int i = 1; i <= 120; ++i) {
        world.step(kDt);
        const double t = i * kDt;
        ASSERT_NEAR(height(world, ball), 100 - 0.5 * 9.81 * t * t, 2e-5 * (1 + t * t * 5)) << "at " << t;
        ASSERT_NEAR(world.linearVelocity(ball).y, -9.81 * t, 1e-5 * (1 + 9.81 * t));
    }
}

TEST(WorldMotion, FreeFallIsTheSameForAnyStepAndSubsteps) {
    for (const double dt : {1.0 / 30, 1.0 / 60, 1.0 / 240}) {
        for (const int substeps : {1, 4, 8}) {
            WorldSettings settings;
            settings.substeps = substeps;
            World world(settings);
            const BodyId ball = world.create(DynamicBody{.shape = Sphere{0.5f}, .position = {0, 100, 0}});
            run(world, 1, dt);
            EXPECT_NEAR(height(world, ball), 100 - 0.5 * 9.81, 4e-4) << dt << " " << substeps;
        }
    }
}

TEST(WorldMotion, AProjectileLandsWhereItShould) {
    World world;
    const BodyId ball = world.create(DynamicBody{
        .shape = Sphere{0.1f}, .position = {0, 0, 0}, .linearVelocity = {12, 15, -5}, .angularVelocity = {3, 20, 1}});
    // Height is zero again at t = 2 v / g; between two steps the parabola is known.
    DVec3 before, after;
    double t = 0;
    do {
        before = world.pose(ball).position;
        world.step(kDt);
        t += kDt;
        after = world.pose(ball).position;
    } while (after.y > 0);
    const double vy = world.linearVelocity(ball).y;
    // y(s) = y + v s − g s²/2 backwards from the last step
    const double s = (vy + std::sqrt(vy * vy + 2 * 9.81 * after.y)) / 9.81;
    const double flight = 2 * 15 / 9.81;
    EXPECT_NEAR(t + s, flight, 1e-4 * flight);
    EXPECT_NEAR(after.x + 12 * s, 12 * flight, 1e-4 * 12 * flight);
    EXPECT_NEAR(after.z - 5 * s, -5 * flight, 1e-4 * 5 * flight);
}

// v' = −d v implicitly: v_n = v0 / (1 + h d)^n exactly, to rounding of n substeps; and e^{−d t} within n (h d)²/2.
TEST(WorldMotion, DampingDecaysExponentially) {
    World world(withoutGravity());
    BodyDef def = bodyDef(Sphere{0.5f}, {});
    def.linearVelocity = {10, 0, 0};
    def.angularVelocity = {0, 0, 8};
    def.linearDamping = 0.5f;
    def.angularDamping = 1.5f;
    const BodyId body = world.create(def);
    run(world, 2);
    const double h = kDt / 4;
    const double n = 480;
    EXPECT_NEAR(world.linearVelocity(body).x, 10 * std::pow(1 + 0.5 * h, -n), 10 * n * kEpsilon);
    EXPECT_NEAR(world.angularVelocity(body).z, 8 * std::pow(1 + 1.5 * h, -n), 8 * n * kEpsilon);
    EXPECT_NEAR(world.linearVelocity(body).x, 10 * std::exp(-1.0), 10 * std::exp(-1.0) * n * 0.25 * h * h);
    // ∫ v dt = v0 (1 − e^{−d t}) / d, with an error of first order in h d
    EXPECT_NEAR(world.pose(body).position.x, 10 / 0.5 * (1 - std::exp(-1.0)), 20 * 0.5 * h);
}

TEST(WorldMotion, GravityScaleScalesGravity) {
    World world;
    std::vector<BodyId> bodies;
    for (const float scale : {0.0f, 0.5f, -1.0f, 2.0f}) {
        BodyDef def = bodyDef(Sphere{0.5f}, {20.0 * scale, 0, 0});
        def.gravityScale = scale;
        bodies.push_back(world.create(def));
    }
    run(world, 1);
    EXPECT_EQ(height(world, bodies[0]), 0);
    EXPECT_NEAR(height(world, bodies[1]), -0.25 * 9.81, 1e-4 * 9.81);
    EXPECT_NEAR(height(world, bodies[2]), 0.5 * 9.81, 1e-4 * 9.81);
    EXPECT_NEAR(height(world, bodies[3]), -9.81, 1e-4 * 9.81);
    // Changing it starts a new parabola: the map still sees the old one, which costs at most h² (a' − a)/2 once.
    const double y = height(world, bodies[0]);
    world.setGravityScale(bodies[0], 1);
    run(world, 1);
    EXPECT_NEAR(height(world, bodies[0]), y - 0.5 * 9.81, 2e-4);
}

TEST(WorldMotion, ForceAndTorqueActForOneStep) {
    World world(withoutGravity());
    const BodyId box = world.create(DynamicBody{.shape = Box{{0.5f, 0.3f, 0.1f}}});
    const MassProperties mass = world.mass(box);
    world.applyForce(box, {100, 0, 0}, {0, 0, 0});
    world.applyTorque(box, {0, 0, 7});
    world.step(kDt);
    EXPECT_NEAR(world.linearVelocity(box).x, 100 / mass.mass * kDt, 1e-6);
    EXPECT_NEAR(world.angularVelocity(box).z, 7 / mass.inertia.cz.z * kDt, 1e-6);
    const float v = world.linearVelocity(box).x;
    world.step(kDt);
    EXPECT_EQ(world.linearVelocity(box).x, v);
}

TEST(WorldMotion, AnImpulseChangesBothMomenta) {
    World world(withoutGravity());
    BodyDef def = bodyDef(Box{{0.5f, 0.3f, 0.1f}}, {1, 2, 3});
    def.pose.rotation = rotationAbout({1, 2, 3}, 0.7f);
    const BodyId box = world.create(def);
    const Vec3 impulse{30, -20, 10};
    const Vec3 arm{0.2f, 0.1f, -0.3f};
    world.applyImpulse(box, impulse, DVec3{1, 2, 3} + arm);
    const Vec3 p = world.mass(box).mass * world.linearVelocity(box);
    const Vec3 l = angularMomentum(world, box);
    EXPECT_LT(length(p - impulse), 1e-5f * length(impulse));
    EXPECT_LT(length(l - cross(arm, impulse)), 1e-5f * length(impulse));
    world.applyAngularImpulse(box, {1, 0, 0});
    EXPECT_LT(length(angularMomentum(world, box) - l - Vec3{1, 0, 0}), 1e-5f * length(impulse));
}

// Impulses are equal and opposite to rounding, whatever the solver does.
TEST(WorldMotion, AFreeCollisionKeepsMomentum) {
    World world(withoutGravity());
    std::vector<BodyId> bodies;
    for (int i = 0; i < 6; ++i) {
        BodyDef def = bodyDef(i % 2 ? Shape(Box{{0.4f, 0.3f, 0.2f}}) : Shape(Sphere{0.4f}),
                              {i * 1.5, 0.1 * i, 0.05 * i * i}, surface(0.5f, i % 3 ? 0.0f : 0.6f));
        def.linearVelocity = {3.0f - 1.5f * static_cast<float>(i), 0, 0};
        def.angularVelocity = {0, 1, static_cast<float>(i)};
        def.allowSleep = false;
        bodies.push_back(world.create(def));
    }
    const auto momenta = [&](DVec3& p, DVec3& l) {
        p = l = {};
        for (const BodyId body : bodies) {
            const DVec3 x = world.centerOfMass(body), m(world.mass(body).mass * world.linearVelocity(body));
            p = p + m;
            l = l + DVec3(angularMomentum(world, body)) +
                DVec3{x.y * m.z - x.z * m.y, x.z * m.x - x.x * m.z, x.x * m.y - x.y * m.x};
        }
    };
    DVec3 p0, l0, p1, l1;
    momenta(p0, l0);
    const double energy = world.energy();
    bool touched = false;
    run(world, 4, kDt, [&] { touched |= !world.contactBegins().empty(); });
    momenta(p1, l1);
    EXPECT_TRUE(touched);
    const double scale = world.mass(bodies[0]).mass * 6 * 3;
    EXPECT_LT(distanceBetween(p0, p1), 1e-5 * scale);
    // One impulse acts at one point on both bodies, wherever they have moved in the step; a bounce acts at its time
    // within the substep, h v from there: 3/240 of what it exchanges, a tenth of the whole here.
    EXPECT_LT(distanceBetween(l0, l1), 2e-3 * scale);
    EXPECT_LT(world.energy(), energy);
}

// A world far away has positions of double precision and everything else relative to bodies.
TEST(WorldMotion, ASceneTenKilometresAwayMovesTheSame) {
    std::vector<DVec3> ends[2];
    for (const int far : {0, 1}) {
        const DVec3 origin = far ? DVec3{10'000, 2'000, -10'000} : DVec3{};
        World world;
        addFloor(world, surface(0.5f), origin);
        std::vector<BodyId> bodies;
        for (int i = 0; i < 4; ++i)
            bodies.push_back(
                world.create(bodyDef(Box{{0.5f, 0.5f, 0.5f}}, origin + DVec3{0.02 * i, 0.5 + 1.01 * i, 0})));
        BodyDef ball = bodyDef(Sphere{0.3f}, origin + DVec3{4, 0.3, 0}, surface(0.5f));
        ball.linearVelocity = {0, 0, 3};
        bodies.push_back(world.create(ball));
        run(world, 2);
        for (const BodyId body : bodies) ends[far].push_back(world.pose(body).position - origin);
    }
    // 10 km in double rounds to 2e-12 m, relative vectors in single to 1e-7 of what is near.
    for (std::size_t i = 0; i < ends[0].size(); ++i) EXPECT_LT(distanceBetween(ends[0][i], ends[1][i]), 1e-4) << i;
}

TEST(WorldMotion, LockedAxesDoNotMove) {
    World world;
    addFloor(world);
    BodyDef def = bodyDef(Box{{0.5f, 0.5f, 0.5f}}, {0, 3, 1});
    def.locks = {.translationZ = true, .rotationX = true, .rotationY = true};
    def.linearVelocity = {2, 0, 4};
    def.angularVelocity = {3, 3, 3};
    const BodyId planar = world.create(def);
    world.create(bodyDef(Sphere{0.5f}, {0.8, 5, 1.3}));
    run(world, 3, kDt, [&] {
        ASSERT_EQ(world.pose(planar).position.z, 1);
        // Turning about z keeps the z axis.
        ASSERT_LT(length(rotate(world.pose(planar).rotation, {0, 0, 1}) - Vec3{0, 0, 1}), 1e-5f);
    });
    EXPECT_NEAR(height(world, planar), 0.5, 0.02);
}

TEST(WorldMotion, ABodyThatCannotTurnKeepsUpright) {
    World world;
    addFloor(world);
    BodyDef def = bodyDef(Capsule{0.3f, 0.6f}, {0, 2, 0});
    def.locks = {.rotationX = true, .rotationY = true, .rotationZ = true};
    def.linearVelocity = {3, 0, 1};
    const BodyId walker = world.create(def);
    run(world, 3);
    EXPECT_EQ(world.pose(walker).rotation, Quat{});
    EXPECT_NEAR(height(world, walker), 0.9, 0.01);
}

TEST(WorldMotion, AKinematicBodyReachesItsTarget) {
    World world;
    BodyDef def = bodyDef(Box{{0.5f, 0.1f, 0.5f}}, {1, 2, 3}, {}, BodyType::kinematic);
    const BodyId platform = world.create(def);
    for (int i = 1; i <= 60; ++i) {
        const float t = static_cast<float>(i) / 60;
        const Pose target{{1 + t, 2 + t * t, 3 - t}, rotationAbout({1, 2, 3}, 3 * t)};
        world.moveTo(platform, target, kDt);
        world.step(kDt);
        const Pose now = world.pose(platform);
        ASSERT_LT(distanceBetween(now.position, target.position), 1e-6);
        const float turn = length(rotationVector(now.rotation * conjugate(target.rotation)));
        ASSERT_LT(turn, 2e-6f);
    }
}

TEST(WorldMotion, AKinematicBodyPushesAndIsNotPushed) {
    World world;
    addFloor(world, surface(0.2f));
    BodyDef def = bodyDef(Box{{0.2f, 1, 1}}, {-2, 1.05, 0}, {}, BodyType::kinematic);
    def.linearVelocity = {1, 0, 0};
    const BodyId pusher = world.create(def);
    const BodyId box = world.create(bodyDef(Box{{0.5f, 0.5f, 0.5f}}, {0, 0.5, 0}, surface(0.2f)));
    run(world, 4);
    EXPECT_NEAR(world.pose(pusher).position.x, 2, 1e-4);
    EXPECT_EQ(world.linearVelocity(pusher), (Vec3{1, 0, 0}));
    EXPECT_NEAR(world.linearVelocity(box).x, 1, 0.02);
    EXPECT_NEAR(world.pose(box).position.x, 2.7, 0.02);
}

}  // namespace
}  // namespace ragtop
