#include <algorithm>

#include "world_support.h"

namespace ragtop {
namespace {

using namespace test;

const Material kSmooth = surface(0);

void addTiles(World& world, double step = 0) {
    for (int i = 0; i < 20; ++i)
        for (int j = 0; j < 14; ++j)
            world.create(bodyDef(Box{{0.5f, 0.5f, 0.5f}}, {i + 0.5, i < 10 ? -0.5 : step - 0.5, j + 0.5}, kSmooth,
                                 BodyType::fixed));
}

BodyId addSlider(World& world, const Shape& shape, double heading) {
    BodyDef def = bodyDef(shape, {1.3, 0.25, 2.7}, kSmooth);
    def.linearVelocity = toVec3(DVec3{10 * std::cos(heading), 0, 10 * std::sin(heading)});
    if (std::holds_alternative<Capsule>(shape)) def.pose.rotation = rotationAbout({0, 0, 1}, kPi / 2);
    return world.create(def);
}

// A corner that comes to the next tile finds its share of the weight there within a substep: more than what gravity
// gives a quarter of the body in that time is a blow.
TEST(WorldSeams, TilesAreAsSmoothAsOneFloor) {
    for (const Shape& shape : {Shape{Box{{0.25f, 0.25f, 0.25f}}}, Shape{Sphere{0.25f}}, Shape{Capsule{0.25f, 0.25f}}})
        for (const double heading : {0.0, 0.2, 0.5236}) {
            World world(withoutSleep());
            addTiles(world);
            const BodyId body = addSlider(world, shape, heading);
            float lift = 0, slowest = INFINITY;
            for (int i = 0; i < 90; ++i) {
                world.step(kDt);
                const Vec3 v = world.linearVelocity(body);
                lift = std::max(lift, std::abs(v.y));
                slowest = std::min(slowest, std::hypot(v.x, v.z));
            }
            EXPECT_LT(lift, kGravity / 240 / 4) << "shape " << shape.index() << ", heading " << heading;
            EXPECT_GT(slowest, 10 * 0.9999f) << "shape " << shape.index() << ", heading " << heading;
        }
}

// A soft row that has lost its load λ̂ lets go at s_i/s_m · λ̂/m = g h/a₂ with a₂ = hω (2ζ + hω): 2.2 mm/s. Loads that are
// found anew within a substep leave what one sweep over the points leaves of that.
TEST(WorldSeams, ABoxThatChangesTilesDoesNotSag) {
    const WorldSettings settings = withoutSleep();
    const float h = static_cast<float>(kDt) / static_cast<float>(settings.substeps);
    const float omega = 2 * 2 * kPi * settings.contactFrequency;  // times h, on the ground
    const float sag = kGravity * h / (omega * (2 * settings.staticContactDamping + omega));
    for (const double heading : {0.0, 0.2, 0.5236}) {
        World world(settings);
        addTiles(world);
        const BodyId box = addSlider(world, Box{{0.25f, 0.25f, 0.25f}}, heading);
        run(world, 0.3);
        float lift = 0;
        run(world, 1, kDt, [&] { lift = std::max(lift, std::abs(world.linearVelocity(box).y)); });
        EXPECT_LT(lift, sag / 5) << "heading " << heading;
        EXPECT_NEAR(height(world, box), 0.25, 0.25e-4) << "heading " << heading;
    }
}

// A tile that stands above the middle of the box is a wall; over a lower one it would trip.
TEST(WorldSeams, AHighStepStops) {
    World world(withoutSleep());
    addTiles(world, 0.375);
    const BodyId box = addSlider(world, Box{{0.25f, 0.25f, 0.25f}}, 0);
    run(world, 1.5);
    EXPECT_LT(world.pose(box).position.x, 9.75 + 0.005);
}

// What stands on a floor, or beside it, is met although the floor is touched all the while.
TEST(WorldSeams, AWallOnTheFloorStops) {
    for (const double foot : {0.0, -1.0}) {
        World world(withoutSleep());
        addFloor(world, kSmooth);
        world.create(bodyDef(Box{{0.5f, 1, 3}}, {8.5, 1 + foot, 2.7}, kSmooth, BodyType::fixed));
        const BodyId box = addSlider(world, Box{{0.25f, 0.25f, 0.25f}}, 0);
        run(world, 1.5);
        EXPECT_LT(world.pose(box).position.x, 7.75 + 0.005);
    }
}

}  // namespace
}  // namespace ragtop
