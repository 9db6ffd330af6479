#include <gtest/gtest.h>

#include <cstddef>
#include <vector>

#include "chain_support.h"

namespace ragtop {
namespace {

using namespace test;

void hangDown(World& world, const Chain& chain) {
    for (std::size_t i = 0; i < chain.bodies.size(); ++i)
        world.setPose(chain.bodies[i],
                      {{0, -0.5 * static_cast<double>(i) - 0.25, world.centerOfMass(chain.bodies[i]).z},
                       i + 1 == chain.bodies.size() ? rotationBetween({1, 0, 0}, {0, -1, 0})
                                                    : rotationBetween({0, 1, 0}, {0, -1, 0})});
}

int factorizations(const World& world) { return world.stats().islands[0].factorizations; }

TEST(MultirateChains, AreSolvedOncePerStepAndBearTheirWeight) {
    World world(withoutSleep());
    const Chain chain(world, 8, 100);
    hangDown(world, chain);
    run(world, kDt);
    EXPECT_GE(factorizations(world), 4);
    run(world, 2);
    EXPECT_LE(factorizations(world), 2);  // one substep, twice where it is very taut
    for (std::size_t i = 0; i < chain.joints.size(); ++i) {
        const float weight = (100 + static_cast<float>(8 - i)) * kGravity;
        EXPECT_NEAR(length(world.state(chain.joints[i]).force), weight, 1e-3f * weight) << i;
    }
}

TEST(MultirateChains, AreSolvedInEverySubstepThatAModuleActsIn) {
    World world(withoutSleep());
    Watcher watcher;
    world.add(&watcher.module);
    const Chain chain(world, 8, 100);
    hangDown(world, chain);
    run(world, 2);
    EXPECT_GE(factorizations(world), 4);
}

TEST(MultirateChains, KeepToSubstepsThatDivideTheStep) {
    WorldSettings settings = withoutSleep();
    settings.substeps = 3;
    World world(settings);
    const Chain chain(world, 8, 100);
    hangDown(world, chain);
    run(world, 2, kDt, [&] { ASSERT_LT(chain.largestGap(world), 1e-4f); });
    EXPECT_GE(factorizations(world), 3);
}

/// A substep of h' errs in the turn of a pendulum by (ω h')²/24: at 3 rad/s and 1/60 s by 10⁻⁴ of a way of ten metres.
/// Forces of a substep and a half that are taken twice, or not at all, would be 3 h/2 v = 40 mm.
TEST(MultirateChains, SwingAsTheyDoInShortSubsteps) {
    std::vector<DVec3> ends;
    int least = 8;
    for (const bool watched : {false, true}) {
        World world(withoutSleep());
        Watcher watcher;
        if (watched) world.add(&watcher.module);
        const Chain chain(world, 6, 1000);
        run(world, 2.5, kDt, [&] {
            ASSERT_LT(chain.largestGap(world), 1e-3f);
            if (!watched) least = std::min(least, factorizations(world));
        });
        ends.push_back(world.centerOfMass(chain.bodies.back()));
    }
    EXPECT_LE(least, 4) << "never took two substeps at once";
    EXPECT_LT(length(relative(ends[0], ends[1])), 5e-3f);
}

std::uint64_t hashAfter(int lanes, bool savedBetween) {
    World world(withoutSleep(), {.lanes = lanes});
    std::vector<Chain> chains;
    for (int i = 0; i < 13; ++i) {
        chains.emplace_back(world, 8, 300.0f + 10.0f * static_cast<float>(i), 2.0 * i);
        if (i % 3 == 0) hangDown(world, chains.back());
    }
    run(world, 1);
    if (savedBetween) {
        std::vector<std::byte> bytes(world.saveSize());
        world.save(bytes);
        run(world, 0.2);
        world.restore(bytes);
    }
    run(world, 1);
    return world.hash();
}

TEST(MultirateChains, TakeTheSameFactorsInAnyLanesAndAfterBeingRestored) {
    const std::uint64_t independent = hashAfter(4, false);
    for (const int lanes : {8, 16}) EXPECT_EQ(hashAfter(lanes, false), independent) << lanes;
    EXPECT_EQ(hashAfter(8, true), independent);
}

}  // namespace
}  // namespace ragtop
