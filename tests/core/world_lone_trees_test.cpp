#include <gtest/gtest.h>

#include <cstring>
#include <vector>

#include "chain_support.h"

namespace ragtop {
namespace {

using namespace test;

/// Who looks at bodies between two substeps, and does nothing to them: no tree is alone then.
struct Watcher {
    StepModule module;
    Watcher() { module.beforeSubstep = [](void*, World&, double) {}; }
};

/// Nothing that such a tree does depends on others, so that it may do all of it at once.
TEST(TreesThatGoAlone, EndUpWhereTheySwingWithTheWorldToTheBit) {
    std::vector<std::uint64_t> hashes;
    for (const bool watched : {false, true}) {
        World world(withoutSleep());
        Watcher watcher;
        if (watched) world.add(&watcher.module);
        std::vector<Chain> chains;
        for (int i = 0; i < 9; ++i) chains.emplace_back(world, 6 + i % 2, 2.0f, 2.0 * i);  // they leap
        chains.emplace_back(world, 5, 1000.0f, -2, true);                                  // hinges: one substep at once
        world.destroy(chains[3].joints[0]);                                                // it falls
        run(world, 1);
        world.applyImpulse(chains[1].bodies[2], {0, 0, 5}, world.centerOfMass(chains[1].bodies[2]));
        run(world, 1);
        hashes.push_back(world.hash());
    }
    EXPECT_EQ(hashes[0], hashes[1]);
}

/// What a chain hangs from may begin to move in any step: the chain then follows it through the substeps.
TEST(TreesThatGoAlone, FollowWhatTheyHangFromWhenItMoves) {
    World world(withoutSleep());
    BodyDef def = bodyDef(Sphere{0.1f}, {0, 0, 0});
    def.type = BodyType::kinematic;
    const BodyId crane = world.create(def);
    const BodyId load = world.create(bodyDef(Sphere{0.25f}, {0, -1, 0}));
    const JointId joint = world.create(BallDef{.bodies = {.a = crane, .b = load, .frameB = {{0, 1, 0}, {}}}});
    run(world, 0.5);
    EXPECT_NEAR(world.centerOfMass(load).x, 0, 1e-6);
    world.setVelocity(crane, {1, 0, 0}, {});
    run(world, 1, kDt, [&] { ASSERT_LT(world.state(joint).gap, 1e-3f); });
    // A pendulum whose point goes on at v swings about v t: x = v t − (v/ω) sin ω t.
    const double omega = std::sqrt(static_cast<double>(kGravity) / (1 + 0.4 * 0.25 * 0.25));
    EXPECT_NEAR(world.centerOfMass(load).x, 1 - std::sin(omega) / omega, 0.01);
    world.setVelocity(crane, {}, {});
    run(world, 1, kDt, [&] { ASSERT_LT(world.state(joint).gap, 1e-3f); });
}

/// One chain comes to touch the ground and is a tree no longer; its neighbours do not notice.
TEST(TreesThatGoAlone, DoNotNoticeThatAnotherTouchesSomething) {
    std::vector<std::vector<DVec3>> places;
    for (const bool ground : {false, true}) {
        World world(withoutSleep());
        std::vector<Chain> chains;
        for (int i = 0; i < 10; ++i) chains.emplace_back(world, 8, 100.0f, 2.0 * i);
        if (ground) {
            BodyDef def = bodyDef(Box{{10, 0.5f, 0.4f}}, {0, -4.2, 0});
            def.type = BodyType::fixed;
            world.create(def);
            world.setFilter(world.shapes(chains[0].bodies.back())[0], {});
        }
        run(world, 2);
        places.emplace_back();
        for (std::size_t i = 1; i < chains.size(); ++i)
            for (const BodyId body : chains[i].bodies) places.back().push_back(world.centerOfMass(body));
    }
    EXPECT_EQ(places[0], places[1]);
}

}  // namespace
}  // namespace ragtop
