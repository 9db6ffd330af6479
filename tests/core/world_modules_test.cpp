#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <deque>
#include <vector>

#include "chain_support.h"
#include "ragtop/tasks.h"

namespace ragtop {
namespace {

using namespace test;

/// Pulls its bodies together in each substep, like a rope that has no length: what it does to one depends on where the
/// other is now.
struct Tether {
    std::vector<BodyId> bodies;
    StepModule module;
    std::uint64_t calls = 0;

    Tether(World& inWorld, std::vector<BodyId> tied) : bodies(std::move(tied)) {
        module.user = this;
        module.name = "tether";
        module.look = [](void* user, const World&, double) { return std::span<const BodyId>(self(user).bodies); };
        module.beforeSubstep = [](void* user, World& world, double h) {
            self(user).pull(world, static_cast<float>(h));
        };
        module.hash = [](const void* user) { return static_cast<const Tether*>(user)->calls; };
        inWorld.add(&module);
    }
    Tether(const Tether&) = delete;
    Tether& operator=(const Tether&) = delete;

private:
    static Tether& self(void* user) { return *static_cast<Tether*>(user); }
    void pull(World& world, float h) {
        ++calls;
        for (std::size_t i = 0; i + 1 < bodies.size(); ++i) {
            const DVec3 a = world.centerOfMass(bodies[i]), b = world.centerOfMass(bodies[i + 1]);
            const Vec3 impulse = 200 * h * relative(b, a);
            world.applyImpulse(bodies[i], impulse, a);
            world.applyImpulse(bodies[i + 1], -impulse, b);
        }
    }
};

/// Boxes in rows, tethered in twos and threes, some of which share a box.
struct Yard {
    World world;
    std::vector<BodyId> boxes;
    std::deque<Tether> tethers;

    explicit Yard(int threads, int rows = 12) : world(withoutSleep(), {.tasks = threadTasks(threads)}) {
        addFloor(world);
        for (int i = 0; i < 20 * rows; ++i)
            boxes.push_back(world.create(bodyDef(Box{{0.25f, 0.25f, 0.25f}}, {1.5 * (i % 20), 0.25, 1.5 * (i / 20)})));
        for (std::size_t i = 0; i + 3 < boxes.size(); i += 5) {
            tethers.emplace_back(world, std::vector{boxes[i], boxes[i + 1]});
            if (i % 2 == 0) tethers.emplace_back(world, std::vector{boxes[i + 1], boxes[i + 2], boxes[i + 3]});
        }
    }
};

/// In the stages of the world and in its regions, for which few and many bodies stand.
TEST(Modules, ThatNameTheirBodiesActOnAnyNumberOfThreadsWithTheSameBits) {
    for (const int rows : {2, 12}) {
        Yard one(1, rows), two(2, rows), three(3, rows);
        bool divided = false;
        for (int i = 0; i < 120; ++i) {
            for (Yard* yard : {&one, &two, &three}) yard->world.step(kDt);
            ASSERT_EQ(two.world.hash(), one.world.hash()) << rows << " rows, step " << i;
            ASSERT_EQ(three.world.hash(), one.world.hash()) << rows << " rows, step " << i;
            divided |= three.world.stats().regions == 3;
        }
        EXPECT_EQ(divided, rows == 12);
        EXPECT_EQ(one.tethers.front().calls, 480u);
        EXPECT_EQ(one.world.stats().strayImpulses, 0u);
    }
}

/// Those that share a body do so in the order of registration, as if each had said nothing.
TEST(Modules, ThatShareABodyActInTheirOrder) {
    Yard named(3), unnamed(1);
    for (Tether& tether : unnamed.tethers) tether.module.look = nullptr;
    for (int i = 0; i < 30; ++i) {
        named.world.step(kDt);
        unnamed.world.step(kDt);
        for (std::size_t b = 0; b < named.boxes.size(); ++b) {
            const Pose pose = named.world.pose(named.boxes[b]), other = unnamed.world.pose(unnamed.boxes[b]);
            ASSERT_LT(length(relative(pose.position, other.position)), 1e-4f) << "box " << b << ", step " << i;
        }
    }
    Yard again(2);
    for (int i = 0; i < 30; ++i) again.world.step(kDt);
    EXPECT_EQ(again.world.hash(), named.world.hash());
}

/// What no module names goes as in a world without modules, to the bit, and costs as little.
TEST(Modules, TaxOnlyTheBodiesThatTheyName) {
    const auto build = [](World& world, std::vector<Chain>& chains) {
        addFloor(world, {}, {0, -30, 0});
        for (int i = 0; i < 8; ++i) chains.emplace_back(world, 12, 100.0f, 2.0 * i);
        for (int i = 0; i < 100; ++i)
            world.create(bodyDef(Box{{0.25f, 0.25f, 0.25f}}, {1.5 * (i % 10) - 40, -29.75, 1.5 * (i / 10)}));
        return world.create(bodyDef(Sphere{0.25f}, {40, -29.75, 0}));
    };
    World free(withoutSleep()), watched(withoutSleep());
    std::vector<Chain> freeChains, watchedChains;
    build(free, freeChains);
    const BodyId ball = build(watched, watchedChains);
    Tether looking(watched, {ball});
    for (int i = 0; i < 120; ++i) {
        free.step(kDt);
        watched.step(kDt);
    }
    EXPECT_EQ(looking.calls, 480u);
    const StepStats a = free.stats(), b = watched.stats();
    EXPECT_EQ(a.independentBodies, 8 * 13);
    EXPECT_EQ(b.independentBodies, a.independentBodies);
    EXPECT_LE(b.solvedBodies, a.solvedBodies + 1);
    EXPECT_LT(a.solvedBodies, 10);
    for (std::size_t c = 0; c < freeChains.size(); ++c)
        for (std::size_t i = 0; i < freeChains[c].bodies.size(); ++i)
            ASSERT_EQ(free.pose(freeChains[c].bodies[i]), watched.pose(watchedChains[c].bodies[i]));
}

TEST(Modules, WakeWhatTheyNameAndAreLeftAloneWhileTheyNameNothing) {
    World world;
    addFloor(world);
    const BodyId box = world.create(bodyDef(Box{{0.25f, 0.25f, 0.25f}}, {0, 0.25, 0}));
    const BodyId gone = world.create(bodyDef(Box{{0.25f, 0.25f, 0.25f}}, {5, 0.25, 0}));
    Tether tether(world, {});
    for (int i = 0; i < 120; ++i) world.step(kDt);
    EXPECT_FALSE(world.isAwake(box));
    EXPECT_EQ(tether.calls, 0u);
    tether.bodies = {gone, box};
    world.destroy(gone);
    tether.module.beforeSubstep = [](void* user, World&, double) { ++static_cast<Tether*>(user)->calls; };
    world.step(kDt);
    EXPECT_TRUE(world.isAwake(box));
    EXPECT_EQ(tether.calls, 4u);
    world.remove(&tether.module);
    for (int i = 0; i < 120; ++i) world.step(kDt);
    EXPECT_FALSE(world.isAwake(box));
    EXPECT_EQ(world.stats().solvedBodies, 0);
}

TEST(Modules, CannotPushWhatTheyHaveNotNamed) {
    World world(withoutGravity());
    const BodyId named = world.create(bodyDef(Sphere{0.5f}, {}));
    static BodyId other;
    other = world.create(bodyDef(Sphere{0.5f}, {5, 0, 0}));
    Tether tether(world, {named});
    tether.module.beforeSubstep = [](void* user, World& inWorld, double) {
        inWorld.applyImpulse(static_cast<Tether*>(user)->bodies[0], {1, 0, 0}, {});
        inWorld.applyImpulse(other, {1, 0, 0}, {});
        inWorld.applyAngularImpulse(other, {1, 0, 0});
    };
    world.step(kDt);
    EXPECT_GT(world.linearVelocity(named).x, 0);
    EXPECT_EQ(world.linearVelocity(other), Vec3{});
    EXPECT_EQ(world.angularVelocity(other), Vec3{});
    EXPECT_EQ(world.stats().strayImpulses, 8u);
    world.applyImpulse(other, {1, 0, 0}, {5, 0, 0});
    EXPECT_GT(world.linearVelocity(other).x, 0);
}

}  // namespace
}  // namespace ragtop
