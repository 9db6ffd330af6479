#include <gtest/gtest.h>

#include <cstring>
#include <vector>

#include "chain_support.h"

namespace ragtop {
namespace {

using namespace test;

/// Nothing that such a tree does depends on others, so that it may do all of it at once.
TEST(IndependentTrees, EndUpWhereTheySwingWithTheWorldToTheBit) {
    std::vector<std::uint64_t> hashes;
    for (const bool watched : {false, true}) {
        World world(withoutSleep());
        Watcher watcher;
        if (watched) world.add(&watcher.module);  // no tree is alone then
        std::vector<Chain> chains;
        for (int i = 0; i < 9; ++i) chains.emplace_back(world, 6 + i % 2, 2.0f, 2.0 * i);  // they leap
        chains.emplace_back(world, 5, 1000.0f, -2, true);  // hinges: one substep at once
        world.destroy(chains[3].joints[0]);                // it falls
        run(world, 1);
        world.applyImpulse(chains[1].bodies[2], {0, 0, 5}, world.centerOfMass(chains[1].bodies[2]));
        run(world, 1);
        hashes.push_back(world.hash());
    }
    EXPECT_EQ(hashes[0], hashes[1]);
}

/// What a chain hangs from may begin to move in any step: the chain then follows it through the substeps.
TEST(IndependentTrees, FollowWhatTheyHangFromWhenItMoves) {
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
TEST(IndependentTrees, DoNotNoticeThatAnotherTouchesSomething) {
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

/// A rod that turns about its middle, on a joint, goes nowhere and still comes to where it was not.
TEST(BoundsOfWhatSwings, FollowItsTurns) {
    for (const float spin : {0.2f, 2.0f, 12.0f}) {
        WorldSettings settings = withoutSleep();
        settings.gravity = {};
        World world(settings);
        const BodyId rod = world.create(bodyDef(Capsule{0.05f, 1.0f}, {0, 0, 0}));
        world.create(BallDef{.bodies = {.b = rod}});
        const BodyId ball = world.create(bodyDef(Sphere{0.1f}, {1, 0, 0}));
        world.setVelocity(rod, {}, {0, 0, -spin});
        // The rod, upright, reaches the level after a quarter turn, less the angle that its radius and the ball's take.
        const double meets = (0.5 * 3.14159265 - 0.15) / static_cast<double>(spin);
        double time = 0;
        while (time < 2 * meets + 0.1 && world.contactBegins().empty()) world.step(kDt), time += kDt;
        ASSERT_FALSE(world.contactBegins().empty()) << spin;
        EXPECT_NEAR(time, meets, 0.03 / static_cast<double>(spin) + 2 * kDt) << spin;
        EXPECT_LT(world.linearVelocity(ball).y, 0) << spin;
    }
}

/// Bounds of several steps: a chain that swings by freely meets what stands in its way all the same, and what is put
/// there.
TEST(BoundsOfWhatSwings, HoldItUntilItMeetsSomething) {
    for (const bool later : {false, true}) {
        World world(withoutSleep());
        const Chain chain(world, 6, 20.0f);
        const BodyId load = chain.bodies.back();
        world.setFilter(world.shapes(load)[0], {});
        BodyDef wall = bodyDef(Box{{0.5f, 1, 1}}, {-1.2, -3.2, 0});
        wall.type = BodyType::fixed;
        if (!later) world.create(wall);
        bool met = false;
        double farthest = 4;
        run(world, 2, kDt, [&] {
            if (later && world.centerOfMass(load).x < 0.3 && farthest >= 0.3) world.create(wall);
            met |= !world.contactBegins().empty();
            farthest = std::min(farthest, world.centerOfMass(load).x);
        });
        EXPECT_TRUE(met) << later;
        EXPECT_GT(farthest, -0.7 + 0.25 - 0.05) << later;  // the wall's face, the ball's radius, what gives way
    }
}

}  // namespace
}  // namespace ragtop
