#include <gtest/gtest.h>

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include "ragtop/tasks.h"
#include "scenes.h"

namespace ragtop {
namespace {

using scenes::Scenario;

std::vector<std::byte> saved(const World& world) {
    std::vector<std::byte> bytes(world.saveSize());
    EXPECT_EQ(world.save(bytes), bytes.size());
    return bytes;
}

void advance(World& world, const Scenario& scenario, int steps) {
    for (int i = 0; i < steps; ++i) scenes::advance(world, scenario);
}

/// A part outside the core: it pushes a body by an amount that depends on how often it did.
struct Pusher {
    struct State {
        std::uint32_t pushes = 0;
        float strength = 1;
    };
    State state;
    BodyId body;
    StepModule module;

    explicit Pusher(BodyId pushed) : body(pushed) {
        module.user = this;
        module.name = "pusher";
        module.beforeStep = [](void* user, World& world, double) {
            Pusher& self = *static_cast<Pusher*>(user);
            ++self.state.pushes;
            self.state.strength = 0.75f * self.state.strength + 0.5f;
            if (!world.isValid(self.body)) return;
            const float sign = self.state.pushes % 32 < 16 ? 1.0f : -1.0f;
            world.applyForce(self.body, 500 * sign * self.state.strength * Vec3{1, 0, 0.25f},
                             world.centerOfMass(self.body));
        };
        module.saveSize = [](const void*) { return sizeof(State); };
        module.save = [](const void* user, std::span<std::byte> into) {
            std::memcpy(into.data(), &static_cast<const Pusher*>(user)->state, sizeof(State));
        };
        module.restore = [](void* user, std::span<const std::byte> from) {
            std::memcpy(&static_cast<Pusher*>(user)->state, from.data(), sizeof(State));
        };
        module.hash = [](const void* user) { return std::uint64_t{static_cast<const Pusher*>(user)->state.pushes}; };
    }
};

class State : public testing::TestWithParam<std::size_t> {
protected:
    const Scenario& scenario() const { return scenes::kScenarios[GetParam()]; }
};

TEST_P(State, RestoredWorldGoesOnAsIfNothingHadHappened) {
    World world;
    scenario().build(world, {});
    advance(world, scenario(), 75);
    const std::vector<std::byte> state = saved(world);
    const std::uint64_t before = world.hash();
    std::vector<std::uint64_t> hashes;
    for (int i = 0; i < 60; ++i) {
        advance(world, scenario(), 1);
        hashes.push_back(world.hash());
    }
    world.restore(state);
    EXPECT_EQ(world.hash(), before);
    EXPECT_EQ(world.stepCount(), 75u);
    EXPECT_TRUE(saved(world) == state);
    for (int i = 0; i < 60; ++i) {
        advance(world, scenario(), 1);
        ASSERT_EQ(world.hash(), hashes[static_cast<std::size_t>(i)]) << "step " << i;
    }
}

TEST_P(State, MovesToAnotherWorldBuiltByTheSameCalls) {
    World world, other({}, {.tasks = threadTasks(2)});
    scenario().build(world, {});
    scenario().build(other, {});
    advance(world, scenario(), 60);
    advance(other, scenario(), 30);
    other.restore(saved(world));
    EXPECT_EQ(other.hash(), world.hash());
    for (int i = 0; i < 60; ++i) {
        advance(world, scenario(), 1);
        advance(other, scenario(), 1);
        ASSERT_EQ(other.hash(), world.hash()) << "step " << i;
    }
}

/// Netcode goes back a few frames at each message and simulates them again.
TEST_P(State, RollingBackEightFramesAgainAndAgainChangesNothing) {
    World world, undisturbed;
    scenario().build(world, {});
    scenario().build(undisturbed, {});
    std::vector<std::byte> state;
    for (int i = 0; i < 12; ++i) {
        state.resize(world.saveSize());
        world.save(state);
        advance(world, scenario(), 8);
        world.restore(state);
        advance(world, scenario(), 8);
        advance(undisturbed, scenario(), 8);
        ASSERT_EQ(world.hash(), undisturbed.hash()) << "frame " << 8 * i;
    }
}

INSTANTIATE_TEST_SUITE_P(Scenes, State, testing::Range(std::size_t{0}, std::size(scenes::kScenarios)),
                         [](const auto& param) { return std::string(scenes::kScenarios[param.param].name); });

TEST(State, ModulesAreSavedWithTheWorld) {
    World world;
    scenes::addTower(world);
    Pusher pusher(world.bodies()[5]);
    world.add(&pusher.module);
    for (int i = 0; i < 40; ++i) world.step(1.0 / 60);
    const std::vector<std::byte> state = saved(world);
    for (int i = 0; i < 30; ++i) world.step(1.0 / 60);
    const std::uint64_t after = world.hash();
    world.restore(state);
    EXPECT_EQ(pusher.state.pushes, 40u);
    for (int i = 0; i < 30; ++i) world.step(1.0 / 60);
    EXPECT_EQ(world.hash(), after);
}

TEST(State, BodiesJointsAndIdsComeBackAndGo) {
    World world;
    scenes::addJoints(world);
    for (int i = 0; i < 10; ++i) world.step(1.0 / 60);
    const std::vector<BodyId> bodies(world.bodies().begin(), world.bodies().end());
    const std::vector<JointId> joints(world.joints().begin(), world.joints().end());
    const std::vector<std::byte> state = saved(world);

    const BodyId doomed = bodies[4];
    world.destroy(doomed);
    const BodyId successor = world.create(DynamicBody{.position = {0, 20, 0}});
    EXPECT_EQ(successor.index, doomed.index);
    const BodyId late = world.create(DynamicBody{.position = {0, 25, 0}});
    world.destroy(joints.back());
    for (int i = 0; i < 5; ++i) world.step(1.0 / 60);
    EXPECT_FALSE(world.isValid(doomed));

    world.restore(state);
    EXPECT_TRUE(world.isValid(doomed));
    EXPECT_FALSE(world.isValid(successor));
    EXPECT_FALSE(world.isValid(late));
    EXPECT_TRUE(world.isValid(joints.back()));
    EXPECT_TRUE(std::vector<BodyId>(world.bodies().begin(), world.bodies().end()) == bodies);
    EXPECT_TRUE(std::vector<JointId>(world.joints().begin(), world.joints().end()) == joints);
    // The same calls give the same ids again.
    world.destroy(doomed);
    EXPECT_EQ(world.create(DynamicBody{.position = {0, 20, 0}}), successor);
    EXPECT_EQ(world.bodies().size(), bodies.size());
}

/// The end of a contact by destroying is told by the step after, also when the world was saved in between.
TEST(State, WhatIsStillToBeToldIsSaved) {
    World world;
    scenes::addTower(world, {}, 3);
    for (int i = 0; i < 30; ++i) world.step(1.0 / 60);
    world.destroy(world.bodies()[3]);
    const std::vector<std::byte> state = saved(world);
    world.step(1.0 / 60);
    const std::vector<ContactEvent> ends(world.contactEnds().begin(), world.contactEnds().end());
    EXPECT_EQ(ends.size(), 1u);
    world.restore(state);
    EXPECT_TRUE(world.contactEnds().empty());
    world.step(1.0 / 60);
    EXPECT_TRUE(std::vector<ContactEvent>(world.contactEnds().begin(), world.contactEnds().end()) == ends);
}

/// A sleeping pile in a world that has not stepped wakes with the impulses it fell asleep with.
TEST(State, SleepersWakeInAnotherWorldAsTheyWouldHere) {
    World world, other;
    for (World* w : {&world, &other}) scenes::addTower(*w);
    for (int i = 0; i < 200; ++i) world.step(1.0 / 60);
    ASSERT_EQ(world.stats().awakeBodies, 0);
    other.restore(saved(world));
    for (World* w : {&world, &other}) w->applyImpulse(w->bodies()[12], {200, 0, 0}, w->centerOfMass(w->bodies()[12]));
    for (int i = 0; i < 60; ++i) {
        world.step(1.0 / 60);
        other.step(1.0 / 60);
        ASSERT_EQ(other.hash(), world.hash()) << "step " << i;
    }
}

TEST(State, SettingsAndForcesAreSaved) {
    World world;
    const BodyId body = world.create(DynamicBody{.position = {0, 10, 0}});
    WorldSettings moon;
    moon.gravity = {0, -1.625f, 0};
    world.setSettings(moon);
    world.applyForce(body, {1000, 0, 0}, world.centerOfMass(body));
    const std::vector<std::byte> state = saved(world);
    const std::uint64_t pushed = world.hash();
    world.step(1.0 / 60);
    const std::uint64_t after = world.hash();
    world.setSettings({});
    world.restore(state);
    EXPECT_EQ(world.settings().gravity, moon.gravity);
    EXPECT_EQ(world.hash(), pushed);
    world.step(1.0 / 60);
    EXPECT_EQ(world.hash(), after);
}

class DamagedState : public testing::Test {
protected:
    DamagedState() {
        scenes::addBowl(world_);
        scenes::addMixedShapes(world_, {}, 20);
        scenes::addFigure(world_, {}, 0, 5);
        for (int i = 0; i < 40; ++i) world_.step(1.0 / 60);
        state_ = saved(world_);
        for (int i = 0; i < 10; ++i) world_.step(1.0 / 60);
        before_ = saved(world_);
    }
    void expectRefused(std::span<const std::byte> bytes, const std::string& what) {
        EXPECT_THROW(world_.restore(bytes), std::invalid_argument) << what;
        EXPECT_TRUE(saved(world_) == before_) << what << " changed the world";
    }
    World world_;
    std::vector<std::byte> state_, before_;
};

TEST_F(DamagedState, CutShortIsRefused) {
    for (std::size_t size : {std::size_t{0}, std::size_t{7}, std::size_t{63}, state_.size() / 2, state_.size() - 1})
        expectRefused(std::span(state_).first(size), std::to_string(size) + " bytes");
}

TEST_F(DamagedState, AnyFlippedBitIsRefused) {
    scenes::Dice dice(11);
    const auto bits = static_cast<std::uint32_t>(8 * state_.size());
    for (std::uint32_t i = 0; i < 300; ++i) {
        // All bits of the first bytes in part, since lengths are there, then some anywhere.
        const std::uint32_t bit = i < 200 ? 5 * i : dice.below(bits);
        std::vector<std::byte> damaged = state_;
        damaged[bit / 8] ^= std::byte{1} << (bit % 8);
        expectRefused(damaged, "bit " + std::to_string(bit));
    }
}

TEST_F(DamagedState, GarbageIsRefused) {
    scenes::Dice dice(5);
    std::vector<std::byte> garbage(state_.size());
    for (std::byte& b : garbage) b = static_cast<std::byte>(dice.below(256));
    expectRefused(garbage, "noise");
    std::memcpy(garbage.data(), state_.data(), 64);
    expectRefused(garbage, "noise after a good header");
    expectRefused(std::vector<std::byte>(state_.size()), "zeros");
}

TEST_F(DamagedState, AnotherWorldsStateIsRefused) {
    World lanes({}, {.lanes = world_.lanes() == 4 ? 8 : 4});
    scenes::addBowl(lanes);
    scenes::addMixedShapes(lanes, {}, 20);
    scenes::addFigure(lanes, {}, 0, 5);
    if (lanes.lanes() != world_.lanes()) expectRefused(saved(lanes), "other lanes");
    World shapes;
    scenes::addBowl(shapes, {2});
    scenes::addMixedShapes(shapes, {}, 20);
    scenes::addFigure(shapes, {}, 0, 5);
    expectRefused(saved(shapes), "other shapes");
    World modules;
    scenes::addBowl(modules);
    Pusher pusher(BodyId{});
    modules.add(&pusher.module);
    expectRefused(saved(modules), "other modules");
    modules.remove(&pusher.module);
}

TEST_F(DamagedState, GoodOneIsStillTaken) {
    state_.resize(state_.size() + 100);
    world_.restore(state_);
    EXPECT_EQ(world_.stepCount(), 40u);
}

TEST_F(DamagedState, TooLittleMemoryIsRefused) {
    std::vector<std::byte> small(world_.saveSize() - 1);
    EXPECT_THROW(world_.save(small), std::length_error);
}

}  // namespace
}  // namespace ragtop
