#include <gtest/gtest.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory_resource>
#include <vector>

#include "constraints/constraint_graph.h"
#include "ragtop/tasks.h"
#include "constraints/lane_view.h"
#include "world_support.h"

namespace ragtop {
namespace {

using namespace test;

/// Rows of balls, boxes and pairs of jointed boxes that slide through each other's rows: islands of a few bodies come
/// and go all the time.
void addRows(World& world) {
    addFloor(world);
    for (int i = 0; i < 240; ++i) {
        const int row = i / 20, column = i % 20;
        const DVec3 place{1.5 * column + 0.25 * (row % 3), 0.25, 1.25 * row};
        const Shape shape = i % 2 == 0 ? Shape{Sphere{0.25f}} : Shape{Box{{0.25f, 0.25f, 0.25f}}};
        BodyDef def = bodyDef(shape, place);
        def.linearVelocity = {row % 2 == 0 ? 3.0f : -2.0f, 0, 0.5f * static_cast<float>(column % 3 - 1)};
        const BodyId body = world.create(def);
        if (i % 10 != 9) continue;
        BodyDef limb = bodyDef(Box{{0.25f, 0.25f, 0.25f}}, place + DVec3{0, 0.6, 0});
        limb.linearVelocity = def.linearVelocity;
        const BodyId upper = world.create(limb);
        world.create(
            BallDef{.bodies = {.a = body, .b = upper, .frameA = {{0, 0.3f, 0}, {}}, .frameB = {{0, -0.3f, 0}, {}}}});
    }
}

/// Lies in no region until it meets something.
void addLatecomer(World& world) { world.create(bodyDef(Box{{0.25f, 0.25f, 0.25f}}, {6, 1.5, 6})); }

struct Watcher {
    StepModule module;
    Watcher() {
        module.beforeSubstep = [](void*, World&, double) {};
    }
};

TEST(Regions, ChangeNoBitHoweverManyWorkersThereAre) {
    World independent(withoutSleep()), two(withoutSleep(), {.tasks = threadTasks(2)}),
        three(withoutSleep(), {.tasks = threadTasks(3)});
    // With modules that look at substeps regions go through the stages of the world.
    World watchedAlone(withoutSleep()), watched(withoutSleep(), {.tasks = threadTasks(3)});
    Watcher watchers[2];
    watchedAlone.add(&watchers[0].module);
    watched.add(&watchers[1].module);
    const std::array worlds{&independent, &two, &three, &watchedAlone, &watched};
    bool divided = false;
    for (World* world : worlds) addRows(*world);
    for (int i = 0; i < 240; ++i) {
        for (World* world : worlds) {
            if (i % 80 == 40) addLatecomer(*world);
            world->step(1.0 / 60);
        }
        ASSERT_EQ(two.hash(), independent.hash()) << "step " << i;
        ASSERT_EQ(three.hash(), independent.hash()) << "step " << i;
        ASSERT_EQ(watched.hash(), watchedAlone.hash()) << "step " << i;
        // Regions have lists of their own, whose lengths are saved.
        divided |= three.saveSize() > independent.saveSize() && two.saveSize() > independent.saveSize();
    }
    EXPECT_TRUE(divided);
}

TEST(Regions, AreSavedAndGoOnWithAnotherNumberOfWorkers) {
    World three(withoutSleep(), {.tasks = threadTasks(3)});
    addRows(three);
    for (int i = 0; i < 40; ++i) three.step(1.0 / 60);
    std::vector<std::byte> state(three.saveSize());
    three.save(state);
    World independent(withoutSleep()), two(withoutSleep(), {.tasks = threadTasks(2)});
    for (World* world : {&independent, &two}) {
        addRows(*world);
        world->restore(state);
    }
    for (int i = 0; i < 60; ++i) {
        for (World* world : {&independent, &two, &three}) world->step(1.0 / 60);
        ASSERT_EQ(independent.hash(), three.hash()) << "step " << i;
        ASSERT_EQ(two.hash(), three.hash()) << "step " << i;
    }
    std::vector<std::byte> damaged = state;
    damaged[state.size() / 2] ^= std::byte{1};
    EXPECT_THROW(independent.restore(damaged), std::invalid_argument);
}

TEST(Regions, KeepTheColourOfAConstraintAndAllThatItsLaneHolds) {
    ConstraintGraph graph(8, std::pmr::get_default_resource());
    constexpr std::uint32_t kContacts = 20;
    GraphPlace places[kContacts];
    for (std::uint32_t i = 0; i < kContacts; ++i) {
        places[i] = graph.insertContact(i, 1 + i / 2, true, 0, false, ConstraintGraph::By::iteration);
        LaneView lane(graph.lane(places[i]), graph.lanes());
        for (int field = 0; field < contact::kFields; ++field)
            lane.at(field) = static_cast<float>(100 * i) + static_cast<float>(field);
    }
    graph.resizeRegions(2);
    for (std::uint32_t i = 0; i < kContacts; ++i) {
        const std::uint32_t region = 1 + i / 2 % 2;
        const GraphPlace before = places[i];
        graph.setRegion(1 + i / 2, region);
        std::uint32_t tookOver = kNone;
        places[i] = graph.changeRegion(before, region, tookOver);
        if (tookOver != kNone) places[tookOver] = before;
        EXPECT_EQ(ConstraintGraph::colorOf(static_cast<int>(places[i].color)), static_cast<int>(before.color));
        EXPECT_GE(static_cast<int>(places[i].color), ConstraintGraph::firstList(static_cast<int>(region)));
    }
    for (std::uint32_t i = 0; i < kContacts; ++i) {
        EXPECT_EQ(graph.color(static_cast<int>(places[i].color)).manifolds[places[i].slot], i);
        LaneView lane(graph.lane(places[i]), graph.lanes());
        for (int field = 0; field < contact::kFields; ++field)
            ASSERT_EQ(lane.at(field), static_cast<float>(100 * i) + static_cast<float>(field));
    }
    // A third contact of a body takes the next colour, beside the first two of its region.
    const GraphPlace third = graph.insertContact(kContacts, 1, true, 0, false, ConstraintGraph::By::iteration);
    EXPECT_EQ(third.color,
              static_cast<std::uint32_t>(ConstraintGraph::firstList(1) + ConstraintGraph::kFirstStaticColor + 2));
}

}  // namespace
}  // namespace ragtop
