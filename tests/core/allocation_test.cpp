#include <gtest/gtest.h>

#include <cstddef>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "counted_memory.h"
#include "heap_counter.h"
#include "ragtop/tasks.h"
#include "scenes.h"

namespace ragtop {
namespace {

using test::CountedMemory;

/// Boxes that slide on a slope and spheres that roll down another, neither ever at rest.
void addSlope(World& world, const scenes::Scale&) {
    const Quat tilted = rotationAbout({0, 0, 1}, -0.35f);
    for (int lane = 0; lane < 2; ++lane)
        world.create(StaticBody{.shape = Box{{400, 1, 4}}, .position = {0, -1, 10.0 * lane}, .rotation = tilted});
    for (int i = 0; i < 10; ++i) {
        const DVec3 along = DVec3{} + rotate(tilted, {-100.0f + 4 * static_cast<float>(i), 0.5f, 0});
        world.create(
            DynamicBody{.shape = Box{}, .position = along, .rotation = tilted, .material = {.friction = 0.125f}});
        world.create(DynamicBody{.shape = Sphere{}, .position = along + DVec3{0, 0, 10}});
    }
}

struct SteadyScene {
    const char* name;
    void (*build)(World& world, const scenes::Scale& scale);
    int warmUp;
};
const SteadyScene kSteady[] = {
    {"tower", [](World& world, const scenes::Scale& scale) { scenes::addTower(world, scale); }, 60},
    {"slope", addSlope, 120},
    {"joints", [](World& world, const scenes::Scale& scale) { scenes::addJoints(world, scale); }, 900},
    {"house", [](World& world, const scenes::Scale& scale) { scenes::addHouse(world, scale); }, 120},
    {"hills",
     [](World& world, const scenes::Scale& scale) {
         scenes::addHills(world, scale);
         scenes::addMixedShapes(world, scale, 50);
     },
     600},
};

class Allocation : public testing::TestWithParam<SteadyScene> {};

TEST_P(Allocation, SteadyStepsAskForNoMemory) {
    for (const int workers : {1, 2}) {
        for (const bool sleeping : {true, false}) {
            CountedMemory memory;
            WorldSettings settings;
            settings.sleeping = sleeping;
            World world(settings, {.tasks = threadTasks(workers), .memory = &memory});
            GetParam().build(world, {});
            for (int i = 0; i < GetParam().warmUp; ++i) world.step(1.0 / 60);
            const long heapBefore = heapCalls(), memoryBefore = memory.calls;
            for (int i = 0; i < 120; ++i) world.step(1.0 / 60);
            EXPECT_EQ(heapCalls() - heapBefore, 0) << workers << " workers, sleeping " << sleeping;
            EXPECT_EQ(memory.calls - memoryBefore, 0) << workers << " workers, sleeping " << sleeping;
        }
    }
}

INSTANTIATE_TEST_SUITE_P(Scenes, Allocation, testing::ValuesIn(kSteady),
                         [](const auto& param) { return std::string(param.param.name); });

/// Sleeping and waking move things between lists that have room for all.
TEST(Allocation, WakingAndSleepingAskForNoMemory) {
    CountedMemory memory;
    World world({}, {.memory = &memory});
    scenes::addTower(world);
    const auto cycle = [&] {
        world.wake(world.bodies()[6]);
        for (int i = 0; i < 100; ++i) world.step(1.0 / 60);
    };
    cycle();
    cycle();
    ASSERT_EQ(world.stats().awakeBodies, 0);
    const long heapBefore = heapCalls();
    cycle();
    EXPECT_EQ(heapCalls() - heapBefore, 0);
}

/// Rods whose ends move, as those of a rack: without memory, and with the bits that they have where all joints are
/// sorted anew in each step, as when another kind is defined anew.
TEST(Allocation, RodsWhoseEndsMoveAskForNoMemory) {
    std::uint64_t hashes[2] = {};
    for (const bool sortsAnew : {false, true}) {
        World world;
        std::vector<JointId> rods;
        JointId hinge;
        for (int i = 0; i < 9; ++i) {
            const BodyId a = world.create(DynamicBody{.shape = Box{}, .position = {4.0 * i, 0, 0}});
            const BodyId b = world.create(DynamicBody{.shape = Box{}, .position = {4.0 * i + 2, 0, 0}});
            if (i == 8)
                hinge = world.create(HingeDef{.bodies = {.a = a, .b = b, .frameA = {{2, 0, 0}, {}}}});
            else
                rods.push_back(world.create(DistanceDef{.bodies = {.a = a, .b = b}, .limit = Range{2, 2}}));
        }
        const auto steps = [&](int count) {
            for (int i = 0; i < count; ++i) {
                for (const JointId rod : rods) {
                    auto def = std::get<DistanceDef>(world.def(rod));
                    def.bodies.frameA.position.y = 0.01f * static_cast<float>(i % 7);
                    world.setDef(rod, def);
                }
                if (sortsAnew) world.setDef(hinge, JointDef{world.def(hinge)});
                world.step(1.0 / 60);
            }
        };
        steps(20);
        const long before = heapCalls();
        steps(20);
        EXPECT_EQ(heapCalls() - before, 0);
        hashes[sortsAnew ? 1 : 0] = world.hash();
    }
    EXPECT_EQ(hashes[0], hashes[1]);
}

TEST(Allocation, SavingRestoringAndHashingAskForNoMemory) {
    World world;
    scenes::addHouse(world);
    for (int i = 0; i < 30; ++i) world.step(1.0 / 60);
    std::vector<std::byte> state(2 * world.saveSize());
    world.save(state);
    world.restore(state);
    const long before = heapCalls();
    for (int i = 0; i < 8; ++i) {
        world.save(state);
        world.step(1.0 / 60);
        world.restore(state);
        EXPECT_NE(world.hash(), 0u);
    }
    EXPECT_EQ(heapCalls() - before, 0);
}

TEST(Allocation, QueriesAskForNoMemory) {
    World world;
    scenes::addHills(world);
    scenes::addMixedShapes(world, {}, 30);
    for (int i = 0; i < 30; ++i) world.step(1.0 / 60);
    const Shape ball = Sphere{0.25f};
    int seen = 0;
    const std::function<bool(ShapeId)> count = [&seen](ShapeId) { return ++seen > 0; };
    const long before = heapCalls();
    for (int i = 0; i < 10; ++i) {
        const Ray ray{{0.5 * i - 2, 10, 0.25}, {0, -20, 0}};
        seen += world.castRay(ray) ? 1 : 0;
        seen += world.castShape(ball, {}, ray) ? 1 : 0;
        world.overlap(Bounds{{-4, -4, -4}, {4, 4, 4}}, count);
    }
    EXPECT_EQ(heapCalls() - before, 0);
    EXPECT_GT(seen, 0);
}

/// The state of a world is in the memory it was given. Beside it there are, from the heap, the world object itself, the
/// list of colours, shapes as they were defined with their shared data, modules, callbacks, and the lists that
/// bodies(), shapes() and jointsOf() hand out.
TEST(Allocation, BodiesContactsAndJointsAreInTheMemoryGiven) {
    const auto heapBytesOf = [](int bodies) {
        CountedMemory memory;
        World world({}, {.memory = &memory});
        scenes::addFloor(world);
        for (int i = 0; i < bodies; ++i) world.create(DynamicBody{.position = {1.25 * (i % 20), 0.5, 1.25 * (i / 20)}});
        const long before = heapCalls(), given = memory.calls;
        for (int i = 0; i < 30; ++i) world.step(1.0 / 60);
        return std::pair(heapCalls() - before - (memory.calls - given), memory.held);
    };
    const auto [few, fewBytes] = heapBytesOf(10);
    const auto [many, manyBytes] = heapBytesOf(400);
    EXPECT_LE(many - few, 16);
    // A body with a shape and a contact takes some 900 bytes.
    EXPECT_GT(manyBytes - fewBytes, 390 * 900);
}

TEST(Allocation, AllMemoryGivenIsReturned) {
    CountedMemory memory;
    {
        World world({}, {.memory = &memory, .expectedBodies = 100});
        scenes::addBowl(world);
        scenes::addMixedShapes(world, {}, 20);
        scenes::addFigure(world, {}, 0, 6);
        for (int i = 0; i < 50; ++i) world.step(1.0 / 60);
        EXPECT_GT(memory.held, 0u);
    }
    EXPECT_EQ(memory.held, 0u);
}

}  // namespace
}  // namespace ragtop
