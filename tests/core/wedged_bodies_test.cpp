// What is pressed from two sides that no impulse moves, or by what is far heavier, asks a solve for loads without
// bound.

#include <algorithm>
#include <cmath>
#include <random>

#include "world_support.h"

namespace ragtop {
namespace {

using namespace test;

struct Drawn {
    std::mt19937 random;
    explicit Drawn(unsigned seed) : random(seed) {}
    float between(float low, float high) {
        return low + (high - low) * static_cast<float>(random() >> 8) / static_cast<float>(1 << 24);
    }
};

double fastest(const World& world, const std::vector<BodyId>& bodies) {
    double most = 0;
    for (const BodyId body : bodies) {
        const double speed = static_cast<double>(length(world.linearVelocity(body)));
        if (!(speed <= most)) most = speed;  // keeps what is no number
    }
    return most;
}

/// Two walls that no impulse moves close on a heap until less room is left than a box is wide. Contacts are springs of
/// a quarter of a turn per substep, and bodies at most half a width deep in each: ω d is what these can give.
TEST(WedgedBodies, LeaveWallsThatCloseNoFasterThanContactsThatDeepPushThem) {
    constexpr float kHalf = 0.3f;
    constexpr double kFrequency = 2 * 3.14159 * 0.25 * 240;  // rad/s
    for (const SolverChoice solver : {SolverChoice::automatic, SolverChoice::direct})
        for (unsigned seed = 1; seed <= 3; ++seed) {
            SCOPED_TRACE(testing::Message() << "solver " << static_cast<int>(solver) << " seed " << seed);
            Drawn drawn(seed);
            WorldSettings settings;
            settings.solver = solver;
            World world(settings);
            addFloor(world);
            BodyId walls[2];
            for (int side = 0; side < 2; ++side) {
                BodyDef wall = bodyDef(Box{{0.2f, 2, 2}}, {side == 0 ? -3.0 : 3.0, 2, 0});
                wall.type = BodyType::kinematic;
                walls[side] = world.create(wall);
            }
            std::vector<BodyId> bodies;
            for (int i = 0; i < 12; ++i) {
                const Shape shape = i % 2 == 0 ? Shape{Sphere{kHalf}} : Shape{Box{{kHalf, kHalf, kHalf}}};
                bodies.push_back(
                    world.create(bodyDef(shape, {drawn.between(-1.5f, 1.5f), 0.4 + 0.4 * i, drawn.between(-1, 1)})));
            }
            const float speed = drawn.between(0.3f, 1.2f), open = 0.2f + drawn.between(0.2f, 0.45f);
            double most = 0;
            for (int i = 0; i < 420; ++i) {
                const bool closes = world.pose(walls[1]).position.x > static_cast<double>(open);
                for (int side = 0; side < 2; ++side)
                    world.setVelocity(walls[side], {closes ? (side == 0 ? speed : -speed) : 0, 0, 0}, {});
                world.step(1.0 / 60);
                const double now = fastest(world, bodies);
                if (!(now <= most)) most = now;
            }
            EXPECT_LE(most, kFrequency * kHalf);
        }
}

/// A slab falls on balls in a pit, up to 300,000 times as heavy as one of them. Whatever solves that, and whether it
/// ends, falling brings all the energy there is, and a ball has no more than from three blows without loss, each of
/// which doubles the speed of what strikes.
TEST(WedgedBodies, BelowWhatIsFarHeavierAreNotShot) {
    for (unsigned seed = 2; seed <= 4; ++seed) {
        SCOPED_TRACE(seed);
        Drawn drawn(seed);
        World world;
        addFloor(world);
        for (int side = 0; side < 4; ++side) {
            const float x = side == 0 ? 1.2f : side == 1 ? -1.2f : 0, z = side == 2 ? 1.2f : side == 3 ? -1.2f : 0;
            BodyDef wall = bodyDef(Box{{side < 2 ? 0.2f : 2.4f, 2, side < 2 ? 2.4f : 0.2f}}, {x, 2, z});
            wall.type = BodyType::fixed;
            world.create(wall);
        }
        const float density = std::pow(10.0f, drawn.between(1, 2));
        std::vector<BodyId> bodies;
        for (int i = 0; i < 98; ++i) {
            BodyDef ball =
                bodyDef(Sphere{0.12f}, {-0.75 + 0.25 * (i % 7), 0.15 + 0.26 * (i / 49), -0.75 + 0.25 * (i / 7 % 7)});
            ball.shapes[0].density = density;
            bodies.push_back(world.create(ball));
        }
        BodyDef slab = bodyDef(Box{{0.95f, 0.3f, 0.95f}}, {0, drawn.between(1.2f, 2.5f), 0});
        slab.shapes[0].density = drawn.between(5000, 10000);
        bodies.push_back(world.create(slab));
        const double brought = world.energy(), falls = slab.pose.position.y;
        double most = 0;
        for (int i = 0; i < 150; ++i) {
            world.step(1.0 / 60);
            ASSERT_LE(world.energy(), 1.001 * brought) << "in step " << i;
            const double now = fastest(world, bodies);
            if (!(now <= most)) most = now;
        }
        EXPECT_LE(most, 8 * std::sqrt(2 * static_cast<double>(kGravity) * falls));
    }
}

}  // namespace
}  // namespace ragtop
