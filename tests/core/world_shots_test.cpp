#include <random>

#include "world_support.h"

namespace ragtop {
namespace {

using namespace test;

/// Numbers that are the same everywhere.
class Dice {
public:
    explicit Dice(std::uint32_t seed) : engine_(seed) {}
    float in(float lower, float upper) {
        return lower + (upper - lower) * static_cast<float>(engine_() >> 8) / 16777216.0f;
    }
    std::uint32_t below(std::uint32_t count) { return engine_() % count; }
    Vec3 direction() { return normalized({in(-1, 1), in(-1, 1), in(-1, 1)}, {0, 1, 0}); }

private:
    std::mt19937 engine_;
};

/// A wall whose front is the plane x = 0, or a mesh that faces −x there.
void addWall(World& world, float thickness, bool mesh, float restitution) {
    const Material material = surface(0.5f, restitution);
    if (!mesh) {
        world.create(bodyDef(Box{{0.5f * thickness, 200, 200}}, {0.5 * thickness, 0, 0}, material, BodyType::fixed));
        return;
    }
    const Vec3 vertices[] = {{0, -200, -200}, {0, 200, -200}, {0, 200, 200}, {0, -200, 200}};
    const Triangle triangles[] = {{0, 2, 1}, {0, 3, 2}};
    world.create(bodyDef(TriangleMesh(vertices, triangles), {}, material, BodyType::fixed));
}

Shape anyShape(std::uint32_t kind, Dice& dice) {
    switch (kind) {
        case 0:
            return Sphere{dice.in(0.02f, 0.15f)};
        case 1:
            return Capsule{dice.in(0.02f, 0.1f), dice.in(0.05f, 0.3f)};
        case 2:
            return Box{{dice.in(0.03f, 0.2f), dice.in(0.03f, 0.2f), dice.in(0.03f, 0.2f)}};
        default:
            return Box{{0.4f, 0.02f, 0.02f}};  // a rod
    }
}

/// Where a random body that is shot at a wall 2 m away ends, in front of it (x < 0) or behind it.
double shoot(std::uint32_t shot) {
    Dice dice(shot);
    World world(withoutGravity());
    const float restitution = dice.below(2) == 0 ? 0.0f : dice.in(0, 1);
    addWall(world, dice.in(0.05f, 0.2f), dice.below(2) == 0, restitution);
    const std::uint32_t kind = shot % 4;
    BodyDef def = bodyDef(anyShape(kind, dice), {-2, dice.in(-1, 1), dice.in(-1, 1)}, surface(0.5f, restitution));
    def.linearVelocity = dice.in(10, 200) * normalized(Vec3{1, dice.in(-1, 1), dice.in(-1, 1)});
    const float spin = kind == 3 ? 100.0f : 20.0f;
    def.angularVelocity = dice.in(0, spin) * dice.direction();
    def.pose.rotation = rotationAbout(dice.direction(), dice.in(0, 3));
    const BodyId body = world.create(def);
    // Long enough for the slowest to arrive; a few more steps show what goes on from there.
    for (int i = 0; i < 30; ++i) world.step(kDt);
    return world.pose(body).position.x;
}

// What a wall stops stays in front of its surface, or slides along it, whatever it is, and however it turns.
TEST(WorldShots, NothingOfTenThousandPassesAWall) {
    int passed = 0;
    for (std::uint32_t shot = 0; shot < 10'000; ++shot)
        if (const double x = shoot(shot); x > 0) {
            if (++passed <= 5) ADD_FAILURE() << "shot " << shot << " got to " << x;
        }
    EXPECT_EQ(passed, 0);
}

// Two bullets that fly at each other exchange their velocities when they bounce, head on and past each other's middle.
/// Bodies as fast as this pass their bounds, which are made before the length of the step is known, in any step: the
/// first one, one after they were pushed, and one that is longer than those before.
TEST(WorldShots, BodiesMeetInTheStepInWhichTheyAreSetGoing) {
    for (const char* when : {"first", "pushed", "longer"}) {
        const bool pushed = when == std::string("pushed"), longer = when == std::string("longer");
        World world(withoutGravity());
        BodyDef left = bodyDef(Sphere{0.1f}, {-2, 0, 0}), right = bodyDef(Sphere{0.1f}, {2, 0, 0});
        left.bullet = right.bullet = true;
        const Vec3 speed{150, 0, 0};
        if (!pushed && !longer) left.linearVelocity = speed, right.linearVelocity = -speed;
        const BodyId a = world.create(left), b = world.create(right);
        if (longer || pushed) world.step(longer ? 1e-6 : kDt);
        if (longer || pushed) world.setVelocity(a, speed, {}), world.setVelocity(b, -speed, {});
        if (longer) world.step(1e-6);
        world.step(kDt);
        EXPECT_LT(world.pose(a).position.x, world.pose(b).position.x) << when;
    }
}

TEST(WorldShots, TwoBulletsMeet) {
    for (int phase = 0; phase < 64; ++phase) {
        World world(withoutGravity());
        BodyDef def = bodyDef(Sphere{0.02f}, {-3.0 - 0.05 * phase, 0, 0}, surface(0, 1));
        def.linearVelocity = {200, 0, 0};
        def.bullet = true;
        const BodyId a = world.create(def);
        def.pose.position = {3.0, 0, 0};
        def.linearVelocity = {-150, 0, 0};
        const BodyId b = world.create(def);
        run(world, 0.1);
        EXPECT_LT(world.pose(a).position.x, world.pose(b).position.x) << phase;
        EXPECT_NEAR(world.linearVelocity(a).x, -150, 0.1) << phase;
        EXPECT_NEAR(world.linearVelocity(b).x, 200, 0.1) << phase;
    }
}

// A ball that bounces between two walls loses no time at them: after t it has flown v t of way, whatever the phase of
// the steps. Each impact is met within the rounding of its substep, 1e-7 · h of time.
TEST(WorldShots, ABallLosesNoTimeAtImpacts) {
    for (const float speed : {3.0f, 17.0f, 90.0f}) {
        World world(withoutGravity());
        world.create(bodyDef(Box{{0.5f, 5, 5}}, {-1.6, 0, 0}, surface(0, 1), BodyType::fixed));
        world.create(bodyDef(Box{{0.5f, 5, 5}}, {1.6, 0, 0}, surface(0, 1), BodyType::fixed));
        BodyDef def = bodyDef(Sphere{0.1f}, {}, surface(0, 1));
        def.linearVelocity = {speed, 0, 0};
        const BodyId ball = world.create(def);
        const double seconds = 10, room = 2.0;
        run(world, seconds);
        // Unfolded, the walls are mirrors 2 m apart.
        const double way = speed * seconds + 1;
        const double folded = std::fmod(way, 2 * room);
        const double expected = (folded < room ? folded : 2 * room - folded) - 1;
        EXPECT_NEAR(world.pose(ball).position.x, expected, 1e-4 * speed) << speed;
        EXPECT_NEAR(std::abs(world.linearVelocity(ball).x), speed, 1e-5f * speed) << speed;
    }
}

}  // namespace
}  // namespace ragtop
