#include "world_support.h"

namespace ragtop {
namespace {

using namespace test;

/// A wall 0.1 m thick in the y–z plane, or a mesh whose front faces −x.
BodyId addWall(World& world, bool mesh) {
    if (!mesh) return world.create(bodyDef(Box{{0.05f, 5, 5}}, {}, surface(0.5f), BodyType::fixed));
    const Vec3 vertices[] = {{0, -5, -5}, {0, 5, -5}, {0, 5, 5}, {0, -5, 5}};
    const Triangle triangles[] = {{0, 2, 1}, {0, 3, 2}};
    return world.create(bodyDef(TriangleMesh(vertices, triangles), {}, surface(0.5f), BodyType::fixed));
}

constexpr int kPhases = 16;

// At 100 m/s a body moves 1.67 m per step; sixteen starts within one step's way meet the wall at every phase.
TEST(WorldContinuous, NothingPassesAWallAtAnyPhase) {
    for (const bool mesh : {false, true}) {
        for (const Shape& shape : {Shape(Sphere{0.1f}), Shape(Box{{0.1f, 0.1f, 0.1f}}), Shape(Capsule{0.05f, 0.1f})}) {
            for (int phase = 0; phase < kPhases; ++phase) {
                World world(withoutGravity());
                addWall(world, mesh);
                BodyDef def = bodyDef(shape, {-5 - 100 * kDt * phase / kPhases, 0.1, 0.2});
                def.linearVelocity = {100, 0, 0};
                def.angularVelocity = {1, 2, 3};
                const BodyId body = world.create(def);
                double farthest = -10;
                run(world, 0.5, kDt, [&] { farthest = std::max(farthest, world.pose(body).position.x); });
                ASSERT_LT(farthest, 0) << mesh << shape.index() << " phase " << phase;
                ASSERT_LT(world.linearVelocity(body).x, 0.5f);
            }
        }
    }
}

TEST(WorldContinuous, AFastBodyBouncesOffTheWallItMet) {
    World world(withoutGravity());
    world.create(bodyDef(Box{{0.05f, 5, 5}}, {}, surface(0, 1), BodyType::fixed));
    BodyDef def = bodyDef(Sphere{0.1f}, {-5.4, 0, 0}, surface(0, 1));
    def.linearVelocity = {100, 0, 0};
    const BodyId body = world.create(def);
    run(world, 0.5);
    EXPECT_NEAR(world.linearVelocity(body).x, -100, 0.1);
}

/// How far a rod of 1 m, held at its middle and turning with 100 rad/s, so that its tips make 0.8 m per step, gets
/// beyond a post in its way.
float turnBeyondPost(const WorldSettings& settings, int phase) {
    World world(settings);
    world.create(bodyDef(Box{{0.02f, 0.02f, 1}}, {0.45, 0, 0}, surface(0.3f), BodyType::fixed));
    BodyDef def = bodyDef(Box{{0.5f, 0.02f, 0.02f}}, {}, surface(0.3f));
    float angle = -1.5f - 100.0f / 60 * static_cast<float>(phase) / kPhases;
    def.pose.rotation = rotationAbout({0, 0, 1}, angle);
    def.angularVelocity = {0, 0, 100};
    def.locks = {.translationX = true, .translationY = true, .translationZ = true};
    const BodyId rod = world.create(def);
    float farthest = angle;
    Quat before = world.pose(rod).rotation;
    run(world, 0.1, kDt, [&] {
        const Quat now = world.pose(rod).rotation;
        angle += rotationVector(now * conjugate(before)).z;
        before = now;
        farthest = std::max(farthest, angle);
    });
    return farthest;
}

TEST(WorldContinuous, ASpinningRodDoesNotTurnThroughAPost) {
    for (int phase = 0; phase < kPhases; ++phase) EXPECT_LT(turnBeyondPost(withoutGravity(), phase), 0.1f) << phase;
}

TEST(WorldContinuous, ItCanBeSwitchedOff) {
    WorldSettings settings = withoutGravity();
    settings.continuous = false;
    int passed = 0;
    for (int phase = 0; phase < kPhases; ++phase) passed += turnBeyondPost(settings, phase) > 0.1f;
    EXPECT_GT(passed, 0);
}

TEST(WorldContinuous, ABulletMeetsWhatMoves) {
    for (int phase = 0; phase < kPhases; ++phase) {
        World world(withoutGravity());
        const BodyId plate = world.create(bodyDef(Box{{0.02f, 1, 1}}, {0, 0, 0}));
        BodyDef def = bodyDef(Sphere{0.02f}, {-5 - 200 * kDt * phase / kPhases, 0, 0});
        def.linearVelocity = {200, 0, 0};
        def.bullet = true;
        const BodyId bullet = world.create(def);
        run(world, 0.25);
        // It hit the plate, which has its momentum, and did not pass.
        EXPECT_LT(world.pose(bullet).position.x, world.pose(plate).position.x) << phase;
        EXPECT_GT(world.linearVelocity(plate).x, 0) << phase;
    }
}

TEST(WorldContinuous, AFastRollingBallIsNotHeldByItsFloor) {
    World world(withoutSleep());
    addFloor(world, surface(0.5f));
    const BodyId ball = world.create(bodyDef(Sphere{0.1f}, {-50, 0.1, 0}, surface(0.5f)));
    run(world, 0.5);
    world.setVelocity(ball, {40, 0, 0}, {0, 0, -400});
    run(world, 1);
    EXPECT_NEAR(world.pose(ball).position.x, -10, 0.4);
    EXPECT_NEAR(height(world, ball), 0.1, 0.002);
}

}  // namespace
}  // namespace ragtop
