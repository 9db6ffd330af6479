#include "world/multirate.h"

#include <algorithm>
#include <atomic>

#include "base/economy.h"
#include "direct/joint_tuning.h"

namespace ragtop {

namespace {

template <class Visit>
void forMembers(const WorldImpl& world, const DirectIsland& island, Visit&& visit) {
    for (std::uint32_t i = 0; i < island.bodyCount; ++i) visit(world.directSet.bodies[island.firstBody + i]);
}

/// Does a module act on bodies of it between two substeps?
bool isLookedAt(const WorldImpl& world, const DirectIsland& island) {
    bool looked = false;
    if (world.moduleWork.acts())
        forMembers(world, island, [&](std::uint32_t body) { looked |= world.moduleWork.actsOn(body); });
    return looked;
}

struct Pace {
    int stepFactor;
    bool independent;
};

/// A tree takes as many substeps at once as its gaps allow and no link turns too far in, and is independent if what it
/// hangs from stands still. Trees that hang from nothing share their parabola with other free trees unless they are
/// leapfrog trees.
Pace paceOf(const WorldImpl& world, const direct::TreePlan::Tree& tree, bool mayBeIndependent) {
    const DirectIsland& island = world.directSet.islands[tree.owner];
    const BodyState& anchor = world.bodies.states[tree.anchor];
    if (isLookedAt(world, island)) return {1, false};
    if (anchor.v != Vec3{} || anchor.w != Vec3{}) return {1, false};
    const bool hangs = world.directSet.trees.linkOf(tree, 0).joint != direct::TreeJoint::free;
    if (!island.multirate) return {1, mayBeIndependent && (hangs || island.leapfrog)};
    float square = 0;
    int most = direct::TreePlan::kLongestFactor;
    forMembers(world, island, [&](std::uint32_t body) {
        square = std::max(square, lengthSquared(world.bodies.states[body].w));
        most = std::min(most, static_cast<int>(world.bodies[body].allowedFactor));
    });
    const float longest = static_cast<float>(direct::tuning::kLongTurn) / world.context.h;
    int stepFactor = 1;
    while (economy.calmTrees && 2 * stepFactor <= most && world.settings.substeps % (2 * stepFactor) == 0 &&
           square * static_cast<float>(4 * stepFactor * stepFactor) < longest * longest)
        stepFactor *= 2;
    return {stepFactor, mayBeIndependent};
}

/// What changes only with the trees and their paces.
void markTrees(WorldImpl& world) {
    Multirate& multirate = world.directSet.multirate;
    multirate.marks.resizeForOverwrite(world.bodies.size());
    for (const std::uint32_t body : world.bodies.awake) multirate.marks[body] = 0;
    for (DirectIsland& island : world.directSet.islands) island.independent = false;
    multirate.any = false;
    multirate.independentCount = 0;
    for (std::size_t t = 0; t < world.directSet.trees.treeCount(); ++t) {
        const direct::TreePlan::Tree& tree = world.directSet.trees.treeAt(t);
        DirectIsland& island = world.directSet.islands[tree.owner];
        multirate.any |= tree.independent || tree.stepFactor > 1;
        multirate.independentCount += tree.independent ? tree.count : 0;
        island.independent = tree.independent;
        const int mark = tree.stepFactor | (tree.independent ? Multirate::kIndependent : 0);
        forMembers(world, island, [&](std::uint32_t body) { multirate.marks[body] = static_cast<std::uint8_t>(mark); });
    }
    multirate.sharedJoints.clear();
    for (const DirectIsland& island : world.directSet.islands)
        for (std::uint32_t j = 0; j < island.jointCount && !island.independent; ++j)
            multirate.sharedJoints.push(world.directSet.joints[island.firstJoint + j]);
}

/// The bodies that take part in the world's substeps, by their step factors.
void listShared(WorldImpl& world) {
    Multirate& multirate = world.directSet.multirate;
    for (AlignedArray<std::uint32_t>& list : multirate.lists) list.clear();
    if (multirate.independentCount == world.freezing.solved.size()) return;
    for (const std::uint32_t body : world.freezing.solved) {
        if ((multirate.marks[body] & Multirate::kIndependent) != 0) continue;
        setStepFactor(world, body, multirate.marks[body]);
        if (multirate.any) multirate.lists[static_cast<std::size_t>(world.bodies[body].stepFactor / 2)].push(body);
    }
}

}  // namespace

/// Speeds of a body that joints hold belong to the middle of a substep. Where the next one is longer or shorter, the
/// forces between the middles of both are those of half of each. What is of no tree, or of none any more, has step
/// factor 0.
void setStepFactor(WorldImpl& world, std::uint32_t index, int stepFactor) {
    BodyRecord& body = world.bodies[index];
    if (stepFactor == 0) body.stepFactor = 1;
    if (stepFactor == 0 || stepFactor == body.stepFactor) return;
    BodyState& state = world.bodies.states[index];
    const float early = 0.5f * world.context.h * static_cast<float>(stepFactor - static_cast<int>(body.stepFactor));
    body.stepFactor = static_cast<std::uint8_t>(stepFactor) & 7u;
    state.v -= early * (body.gravityScale * world.settings.gravity + state.invMass * body.force);
    state.w -= early * (world.bodies.inertias[index] * body.torque);
}

void chooseStepFactors(WorldImpl& world) {
    direct::TreePlan& chains = world.directSet.trees;
    if (chains.treeCount() == 0 && !world.directSet.multirate.any) return;
    std::atomic<bool> changed{!chains.isGrouped()};
    // What was just made is settled among all bodies, before the step or within its first substep.
    const bool mayBeIndependent =
        economy.independentTrees && world.joints.created.empty() && world.contactFinds.fresh.empty();
    world.runner.parallelFor(static_cast<int>(chains.treeCount()), 8, [&](int begin, int end, int) {
        for (auto t = static_cast<std::size_t>(begin); t < static_cast<std::size_t>(end); ++t) {
            const Pace pace = paceOf(world, chains.treeAt(t), mayBeIndependent);
            if (chains.setPace(t, pace.stepFactor, pace.independent)) changed.store(true, std::memory_order_relaxed);
        }
    });
    if (changed.load(std::memory_order_relaxed)) {
        chains.group(direct::selectTreeKernels(world.graph.lanes()));
        markTrees(world);
    }
    listShared(world);
}

}  // namespace ragtop
