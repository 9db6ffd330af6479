// Trees of joints that nothing else has part in: a group of them goes through the whole step in one task, with its
// bodies in one processor's cache and no barrier to wait at (docs/adr/0006). The bits are those of the stages.

#include <atomic>

#include "world/multirate.h"

namespace ragtop {

namespace {

using Group = direct::TreePlan::Group;

/// What a group of trees goes through the step with.
struct TreeStep {
    const DirectView& d;
    const Iteration& iteration;
    const BodyStage& stage;
    const GuardView& guard;
};

void prepareGroup(const TreeStep& t, Group& group) {
    const direct::TreePlan& trees = t.d.directSet.trees;
    const int stepFactor = trees.stepFactorOf(group);
    for (const std::uint32_t body : trees.membersOf(group)) {
        setStepFactor(t.d.bodies, body, stepFactor, t.guard.gravity, t.d.context.h);
        recordKinetic(t.guard.guard, t.d.bodies, body);
        t.stage.prepare(body);
    }
    for (int lane = 0; lane < group.lanes.used; ++lane) {
        const direct::TreePlan::Tree& tree = trees.treeOf(group, lane);
        for (int l = 0; l < group.lanes.linkCount; ++l)
            if (trees.linkOf(tree, l).joint != direct::TreeJoint::free)
                t.iteration.prepareJointOf(trees.jointOf(tree, l));
    }
    beginGroup(t.d, group);
}

void solveSubsteps(const DirectView& d, Group& group) {
    const BodyArrays arrays = d.bodies.arrays();
    const std::span<const std::uint32_t> bodies = d.directSet.trees.membersOf(group);
    const int count = static_cast<int>(bodies.size()), stepFactor = d.directSet.trees.stepFactorOf(group);
    SolverContext own = d.context;
    own.h *= static_cast<float>(stepFactor);
    for (int substep = 0; substep < d.substeps; substep += stepFactor) {
        d.kernels.integrateVelocities(arrays, bodies.data(), 0, count, own);
        solveGroup(d, group, DirectPass::positions, substep);
        d.kernels.integratePositions(arrays, bodies.data(), 0, count, own);
        solveGroup(d, group, DirectPass::velocities, substep);
    }
}

/// A tree that is to be guarded is finished with all others, and trees are built anew.
void leaveToStages(DirectSet& directSet, std::span<const std::uint32_t> bodies) {
    Multirate& multirate = directSet.multirate;
    for (const std::uint32_t body : bodies)
        multirate.marks[body] = static_cast<std::uint8_t>(multirate.marks[body] & ~Multirate::kIndependent);
    std::atomic_ref(multirate.independentCount).fetch_sub(bodies.size(), std::memory_order_relaxed);
    std::atomic_ref(directSet.treesChanged).store(true, std::memory_order_relaxed);
}

void finishGroup(const TreeStep& t, const Group& group) {
    DirectSet& set = t.d.directSet;
    for (int lane = 0; lane < group.lanes.used; ++lane) {
        const DirectIsland& island = set.islands[set.trees.treeOf(group, lane).owner];
        if (island.multirate) recordGaps(t.d, island);
        const std::span<const std::uint32_t> bodies{set.bodies.data() + island.firstBody, island.bodyCount};
        if (hasGainedEnergy(t.guard, bodies)) {
            leaveToStages(set, bodies);
            continue;
        }
        for (const std::uint32_t body : bodies) t.stage.finish(t.d.bodies[body].awakeIndex);
    }
}

}  // namespace

void stepIndependentTrees(const DirectView& d, const Iteration& iteration, const BodyStage& stage,
                          const GuardView& guard) {
    const TreeStep step{d, iteration, stage, guard};
    const std::size_t count = d.directSet.trees.groupCount(true);
    d.runner.parallelFor(static_cast<int>(count), 1, [&](int begin, int end, int) {
        for (auto i = static_cast<std::size_t>(begin); i < static_cast<std::size_t>(end); ++i) {
            Group& group = d.directSet.trees.groupAt(true, i);
            prepareGroup(step, group);
            solveSubsteps(d, group);
            finishGroup(step, group);
        }
    });
}

}  // namespace ragtop
