// What bears on what, and how much, as bodies that are just made begin with it.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "world_support.h"

namespace ragtop {
namespace {

using namespace test;

/// N, that a body hands to another.
double loadOn(const World& world, BodyId body, BodyId bearer) {
    double sum = 0;
    world.forEachContact(body, [&](const Contact& contact) {
        if (contact.bodyA == bearer || contact.bodyB == bearer) sum += asDouble(contact.normalForce);
    });
    return sum;
}

/// A plank of length 2 on two posts a metre to either side of its middle, and a box at x on it.
TEST(LoadPaths, APlankBeginsWithTheLoadsOfTheLever) {
    for (const double x : {-0.9, -0.5, 0.0, 0.25, 0.75}) {
        World world(withoutSleep());
        const BodyId floor = addFloor(world);
        std::vector<BodyId> posts;
        for (const double side : {-1.0, 1.0})
            posts.push_back(world.create(bodyDef(Box{{0.1f, 0.25f, 0.1f}}, {side, 0.25, 0})));
        const BodyId plank = world.create(bodyDef(Box{{1.1f, 0.05f, 0.1f}}, {0, 0.55, 0}));
        const BodyId box = world.create(bodyDef(Box{{0.1f, 0.1f, 0.1f}}, {x, 0.7, 0}));
        world.step(static_cast<float>(kDt));
        const auto weight = [&](BodyId body) { return asDouble(world.mass(body).mass * kGravity); };
        for (int i = 0; i < 2; ++i) {
            const double lever = 0.5 * (1 + (i == 0 ? -x : x));
            const double onPost = 0.5 * weight(plank) + lever * weight(box);
            EXPECT_NEAR(loadOn(world, plank, posts[i]) / onPost, 1, 0.01) << "box at " << x;
            EXPECT_NEAR(loadOn(world, posts[i], floor) / (onPost + weight(posts[i])), 1, 0.01) << "box at " << x;
        }
    }
}

/// n cubes of width l on a slope tan θ: the line of their weight meets it ½ n l tan θ from the middle of their foot,
/// which ends ½ l from there.
TEST(LoadPaths, AColumnStandsOnASlopeAsLongAsItsWeightGoesThroughItsFoot) {
    constexpr float kWidth = 0.1f;
    for (const int count : {2, 3, 5, 8}) {
        for (const float share : {0.3f, 0.6f, 0.9f, 0.97f, 1.03f, 1.2f}) {
            World world(withoutSleep());
            const Material rough = surface(2);
            const float angle = std::atan(share / static_cast<float>(count));
            const Quat turn = rotationAbout({0, 0, 1}, angle);
            const Vec3 up = rotate(turn, {0, 1, 0});
            const auto create = [&](const Vec3& half, float height, BodyType type) {
                BodyDef def = bodyDef(Box{half}, DVec3(height * up), rough, type);
                def.pose.rotation = turn;
                return world.create(def);
            };
            create({10, 1, 10}, -1, BodyType::fixed);
            std::vector<BodyId> cubes;
            const float half = 0.5f * kWidth;
            for (int i = 0; i < count; ++i)
                cubes.push_back(create({half, half, half}, (static_cast<float>(i) + 0.5f) * kWidth, BodyType::dynamic));
            const DVec3 top = world.pose(cubes.back()).position;
            double moved = 0;
            run(world, 2, kDt,
                [&] { moved = std::max(moved, distanceBetween(top, world.pose(cubes.back()).position)); });
            // Where the line goes near the edge nearly all of the load sags on two points, which lets a column lean by
            // less than a hundredth of its width until these carry it.
            if (share < 1)
                EXPECT_LT(moved, 0.01 * asDouble(kWidth)) << count << " cubes at " << share;
            else
                EXPECT_GT(moved, asDouble(kWidth)) << count << " cubes at " << share;
        }
    }
}

}  // namespace
}  // namespace ragtop
