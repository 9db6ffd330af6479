#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <vector>

#include "world_support.h"

namespace ragtop {
namespace {

using namespace test;

struct Column {
    World world{withoutSleep()};
    std::vector<BodyId> boxes;

    explicit Column(int count) {
        addFloor(world);
        for (int i = 0; i < count; ++i)
            boxes.push_back(world.create(
                bodyDef(Box{{0.5f, 0.5f, 0.5f}}, {1e-3 * std::sin(7.0 * i), i + 0.5, 1e-3 * std::cos(5.0 * i)})));
    }
};

TEST(DirectIslands, TallColumnStandsAndBearsItsWeight) {
    Column column(30);
    run(column.world, 2);
    const auto islands = column.world.stats().islands;
    ASSERT_EQ(islands.size(), 1u);
    EXPECT_STREQ(islands[0].reason, "tall");
    EXPECT_TRUE(islands[0].solved);
    EXPECT_NEAR(height(column.world, column.boxes.back()), 29.5, 1e-3);
    double load = 0;
    column.world.forEachContact(column.boxes[0], [&](const Contact& contact) {
        double sum = 0;
        for (int i = 0; i < contact.pointCount; ++i) sum += static_cast<double>(contact.points[i].impulse);
        load = std::max(load, sum);
    });
    const double weight = 30.0 * static_cast<double>(column.world.mass(column.boxes[0]).mass * kGravity);
    EXPECT_NEAR(load, weight * kDt / 4, 1e-4 * weight * kDt);
}

TEST(DirectIslands, HeavyDoesNotSinkIntoLight) {
    World world(withoutSleep());
    addFloor(world);
    const BodyId light = world.create(bodyDef(Box{{0.5f, 0.5f, 0.5f}}, {0, 0.5, 0}));
    BodyDef def = bodyDef(Box{{0.5f, 0.5f, 0.5f}}, {0, 1.5, 0});
    MassProperties mass = world.mass(light);
    mass.mass *= 1e4f;
    for (Vec3* column : {&mass.inertia.cx, &mass.inertia.cy, &mass.inertia.cz}) *column *= 1e4f;
    def.mass = mass;
    const BodyId heavy = world.create(def);
    run(world, 2, kDt, [&] { EXPECT_NEAR(height(world, heavy), 1.5, 2e-3); });
    EXPECT_STREQ(world.stats().islands[0].reason, "heavy");
}

TEST(DirectIslands, ChangingTheSolverAtRestMovesNothing) {
    Column column(8);
    run(column.world, 1);
    WorldSettings settings = column.world.settings();
    for (const int solver : {1, 2, 1}) {
        settings.solver = solver;
        column.world.setSettings(settings);
        column.world.step(kDt);
        for (const BodyId box : column.boxes) EXPECT_LT(length(column.world.linearVelocity(box)), 1e-3f) << solver;
    }
}

TEST(DirectIslands, RestoredWorldGoesOnBitForBit) {
    Column column(12);
    run(column.world, 0.5);
    std::vector<std::byte> state(column.world.saveSize());
    column.world.save(state);
    run(column.world, 0.5);
    const std::uint64_t expected = column.world.hash();
    column.world.restore(state);
    run(column.world, 0.5);
    EXPECT_EQ(column.world.hash(), expected);
}

}  // namespace
}  // namespace ragtop
