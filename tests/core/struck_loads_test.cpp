#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "ragtop/world.h"
#include "world_support.h"

namespace ragtop {
namespace {

/// A body without restitution that falls on a stack of others.
struct Drop {
    int layers;   ///< of boxes of 1 t and 1 m
    float ratio;  ///< of its mass to that of one of them
    float speed;  ///< m/s
    bool isBox;   ///< else a ball
};

/// m/s, the fastest that it goes up again.
float reboundOf(const Drop& drop) {
    World world;
    world.create(StaticBody{.shape = Box{{100, 1, 100}}, .position = {0, -1, 0}});
    for (int i = 0; i < drop.layers; ++i) world.create(DynamicBody{.shape = Box{}, .position = {0, 0.5 + i, 0}});
    for (int i = 0; i < 60; ++i) world.step(test::kDt);
    const Shape shape = drop.isBox ? Shape{Box{{0.75f, 0.75f, 0.75f}}} : Shape{Sphere{0.75f}};
    const BodyId body = world.create(DynamicBody{.shape = shape,
                                                 .density = 1000 * drop.ratio / massOf(shape, 1).mass,
                                                 .position = {0.03, drop.layers + 1.75, 0.02},
                                                 .linearVelocity = {0, -drop.speed, 0}});
    float fastest = 0;
    for (int i = 0; i < 90; ++i) {
        world.step(test::kDt);
        fastest = std::max(fastest, world.linearVelocity(body).y);
    }
    return fastest;
}

/// Without restitution nothing comes back. What is left is the half of a substep's impulse by which a load that found
/// its answer in few passes is wrong: three tenths of the speed are a tenth of the energy. Passes that began with the
/// loads of the impact threw bodies back by half to twice the speed that they came with.
TEST(StruckLoads, DoNotThrowHeavyBodiesBackFromLightOnes) {
    for (const int layers : {1, 3, 6})
        for (const float ratio : {0.5f, 1.0f, 2.0f, 4.0f, 8.0f, 16.0f, 32.0f})
            for (const float speed : {2.0f, 5.0f, 20.0f})
                for (const bool isBox : {false, true})
                    EXPECT_LT(reboundOf({layers, ratio, speed, isBox}), 0.3f * speed)
                        << layers << " boxes, " << ratio << " times as heavy, " << speed << " m/s, box " << isBox;
}

/// All loads of an impact are shrunk by one share, so that what each gives to both of its bodies stays opposite.
TEST(StruckLoads, KeepMomentumOfWhatNothingHolds) {
    World world(WorldSettings{.gravity = {0, 0, 0}});
    std::vector<BodyId> bodies;
    const auto add = [&](double x, float density, float speed) {
        bodies.push_back(world.create(DynamicBody{
            .shape = Box{}, .density = density, .position = {x, 0.1 * x, 0}, .linearVelocity = {speed, 0, 0}}));
    };
    add(-3, 16000, 20), add(0, 1000, 0), add(1.01, 1000, 0), add(4, 16000, -10);
    const auto momentum = [&] {
        Vec3 sum;
        for (const BodyId body : bodies) sum += world.mass(body).mass * world.linearVelocity(body);
        return sum;
    };
    const Vec3 before = momentum();
    for (int i = 0; i < 120; ++i) world.step(test::kDt);
    EXPECT_LT(length(momentum() - before), 1e-5f * 16000 * 30);
    // What came with 20 and 10 m/s goes on together, or apart by what the light bodies between them take with them.
    EXPECT_LT(world.linearVelocity(bodies[3]).x - world.linearVelocity(bodies[0]).x, 0.25f * 30);
}

/// m, of a light and a heavy body after a second, above a floor that moves evenly and that they meet with 3 m/s.
std::pair<double, double> heightsOver(float floorSpeed) {
    World world;
    const BodyId floor = world.create(BodyDef{.type = BodyType::kinematic,
                                              .shapes = {{.geometry = Box{{4, 0.5f, 4}}}},
                                              .pose = {{0, -0.5, 0}, {}},
                                              .linearVelocity = {0, floorSpeed, 0}});
    const auto add = [&](double y, float density) {
        return world.create(DynamicBody{
            .shape = Box{}, .density = density, .position = {0, y, 0}, .linearVelocity = {0, floorSpeed - 3, 0}});
    };
    const BodyId light = add(0.75, 1000), heavy = add(1.76, 16000);
    for (int i = 0; i < 60; ++i) world.step(test::kDt);
    const double top = world.pose(floor).position.y + 0.5;
    return {world.pose(light).position.y - top, world.pose(heavy).position.y - top};
}

/// Floors that move evenly are one, seen from elsewhere: their work is none that loads make. Rounding of speeds
/// of 30 m/s is 2e-6 m/s, in each of 480 passes.
TEST(StruckLoads, OfWhatALiftStrikesAreThoseOfAFall) {
    const auto [light, heavy] = heightsOver(3);
    for (const float speed : {-30.0f, -3.0f, 30.0f}) {
        const auto [lightThere, heavyThere] = heightsOver(speed);
        EXPECT_NEAR(lightThere, light, 1e-3) << speed;
        EXPECT_NEAR(heavyThere, heavy, 1e-3) << speed;
    }
}

}  // namespace
}  // namespace ragtop
