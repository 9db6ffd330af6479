// Trees of joints that nothing else has part in: a group of them goes through the whole step in one task, with its
// bodies in one processor's cache and no barrier to wait at (docs/adr/0006). The bits are those of the stages.

#include <atomic>

#include "world/multirate.h"

namespace ragtop {

namespace {

using Group = direct::TreePlan::Group;

void prepareGroup(WorldImpl& world, Group& group) {
    const int stepFactor = world.directSet.trees.stepFactorOf(group);
    for (const std::uint32_t body : world.directSet.trees.membersOf(group)) {
        setStepFactor(world, body, stepFactor);
        recordKinetic(world, body);
        world.prepareBody(body);
    }
    for (int lane = 0; lane < group.lanes.used; ++lane) {
        const direct::TreePlan::Tree& tree = world.directSet.trees.treeOf(group, lane);
        for (int l = 0; l < group.lanes.linkCount; ++l)
            if (world.directSet.trees.linkOf(tree, l).joint != direct::TreeJoint::free)
                world.iteration().prepareJointOf(world.directSet.trees.jointOf(tree, l));
    }
    beginGroup(world.directView(), group);
}

void solveSubsteps(WorldImpl& world, Group& group) {
    const BodyArrays arrays = world.bodies.arrays();
    const std::span<const std::uint32_t> bodies = world.directSet.trees.membersOf(group);
    const int count = static_cast<int>(bodies.size()), stepFactor = world.directSet.trees.stepFactorOf(group);
    const DirectView direct = world.directView();
    SolverContext own = world.context;
    own.h *= static_cast<float>(stepFactor);
    for (int substep = 0; substep < world.settings.substeps; substep += stepFactor) {
        world.kernels->integrateVelocities(arrays, bodies.data(), 0, count, own);
        solveGroup(direct, group, DirectPass::positions, substep);
        world.kernels->integratePositions(arrays, bodies.data(), 0, count, own);
        solveGroup(direct, group, DirectPass::velocities, substep);
    }
}

/// A tree that is to be guarded is finished with all others, and trees are built anew.
void leaveToStages(WorldImpl& world, std::span<const std::uint32_t> bodies) {
    for (const std::uint32_t body : bodies)
        world.directSet.multirate.marks[body] =
            static_cast<std::uint8_t>(world.directSet.multirate.marks[body] & ~Multirate::kIndependent);
    std::atomic_ref(world.directSet.multirate.independentCount).fetch_sub(bodies.size(), std::memory_order_relaxed);
    std::atomic_ref(world.directSet.treesChanged).store(true, std::memory_order_relaxed);
}

void finishGroup(WorldImpl& world, const Group& group) {
    for (int lane = 0; lane < group.lanes.used; ++lane) {
        const DirectIsland& island = world.directSet.islands[world.directSet.trees.treeOf(group, lane).owner];
        if (island.multirate) recordGaps(world.directView(), island);
        const std::span<const std::uint32_t> bodies{world.directSet.bodies.data() + island.firstBody, island.bodyCount};
        if (hasGainedEnergy(world, bodies)) {
            leaveToStages(world, bodies);
            continue;
        }
        for (const std::uint32_t body : bodies) world.finishBody(world.bodies[body].awakeIndex);
    }
}

}  // namespace

void stepIndependentTrees(WorldImpl& world) {
    const std::size_t count = world.directSet.trees.groupCount(true);
    world.runner.parallelFor(static_cast<int>(count), 1, [&](int begin, int end, int) {
        for (auto i = static_cast<std::size_t>(begin); i < static_cast<std::size_t>(end); ++i) {
            Group& group = world.directSet.trees.groupAt(true, i);
            prepareGroup(world, group);
            solveSubsteps(world, group);
            finishGroup(world, group);
        }
    });
}

}  // namespace ragtop
