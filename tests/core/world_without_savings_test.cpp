#include "without_saving.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "scenes.h"

namespace ragtop {
namespace {

using test::Without;

void step(World& world, double seconds) {
    for (int i = 0; i < static_cast<int>(seconds * 60); ++i) world.step(1.0 / 60);
}

std::uint64_t hashOfChains() {
    World world;
    scenes::addChains(world);
    step(world, 3);
    return world.hash();
}

TEST(Economy, TreesThatGoByThemselvesGoAsAmongOthers) {
    const std::uint64_t alone = hashOfChains();
    const Without without(&Economy::independentTrees);
    EXPECT_EQ(hashOfChains(), alone);
}

/// A pyramid for 2 s; how far any box has moved, m.
double pyramidMoves() {
    WorldSettings settings;
    settings.sleeping = false;
    World world(settings);
    scenes::addFloor(world);
    scenes::addPyramid(world, {}, 6);
    std::vector<DVec3> begin;
    for (const BodyId body : world.bodies()) begin.push_back(world.pose(body).position);
    step(world, 2);
    double most = 0;
    for (std::size_t i = 0; i < begin.size(); ++i) {
        const DVec3 now = world.pose(world.bodies()[i]).position;
        most = std::max(most, std::hypot(now.x - begin[i].x, now.y - begin[i].y, now.z - begin[i].z));
    }
    return most;
}

TEST(Economy, NoneIsNeededForAPyramidToStand) {
    // A hundredth of the depth at which contacts count as touching.
    constexpr double kStill = 2e-4;
    EXPECT_LT(pyramidMoves(), kStill);
    for (bool Economy::*saving : {&Economy::islands, &Economy::seldomChoices, &Economy::zeroIterations,
                                  &Economy::manifoldReuse, &Economy::calmTrees, &Economy::freezing}) {
        const Without without(saving);
        EXPECT_LT(pyramidMoves(), kStill);
    }
}

/// A box that lies, and another one far away that is kept awake.
bool lyingBoxSleepsBesideARestlessOne() {
    World world;
    scenes::addFloor(world);
    const BodyId lies = scenes::addBox(world, {}, {0.5f, 0.5f, 0.5f}, 0, 0.5, 0);
    const BodyId turns = scenes::addBox(world, {}, {0.5f, 0.5f, 0.5f}, 20, 5, 0);
    world.setGravityScale(turns, 0);
    world.setVelocity(turns, {}, {0, 1, 0});
    step(world, 2);
    EXPECT_TRUE(world.isAwake(turns));
    return !world.isAwake(lies);
}

TEST(Economy, IslandsSleepByThemselves) {
    EXPECT_TRUE(lyingBoxSleepsBesideARestlessOne());
    const Without without(&Economy::islands);
    EXPECT_FALSE(lyingBoxSleepsBesideARestlessOne());
}

/// Bodies that the step has solved of a box that has long been lying.
int solvedOfALyingBox() {
    WorldSettings settings;
    settings.sleeping = false;
    World world(settings);
    scenes::addFloor(world);
    scenes::addBox(world, {}, {0.5f, 0.5f, 0.5f}, 0, 0.5, 0);
    step(world, 2);
    return world.stats().solvedBodies;
}

TEST(Economy, BodiesAtRestAreLeftOut) {
    EXPECT_EQ(solvedOfALyingBox(), 0);
    const Without without(&Economy::freezing);
    EXPECT_EQ(solvedOfALyingBox(), 1);
}

/// Newton's iterations for a tower of twelve boxes, which is solved directly, in its fourth second.
int iterationsOfATower() {
    WorldSettings settings;
    settings.sleeping = false;
    settings.solver = SolverChoice::direct;
    World world(settings);
    scenes::addTower(world);
    step(world, 3);
    int iterations = 0;
    for (int i = 0; i < 60; ++i) {
        world.step(1.0 / 60);
        for (const StepStats::Island& island : world.stats().islands) iterations += island.iterations;
    }
    return iterations;
}

TEST(Economy, LoadsThatStillHoldTakeNoIteration) {
    const int least = iterationsOfATower();
    const Without without(&Economy::zeroIterations);
    EXPECT_GT(iterationsOfATower(), least);
}

}  // namespace
}  // namespace ragtop
