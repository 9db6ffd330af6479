#include "world/world_strides.h"

#include <algorithm>
#include <atomic>

#include "direct/joint_tuning.h"

namespace ragtop {

namespace {

constexpr int kLongest = 1 << (direct::TreePlan::kStrides - 1);

template <class Visit>
void forMembers(const WorldImpl& world, const DirectIsland& island, Visit&& visit) {
    for (std::uint32_t i = 0; i < island.bodyCount; ++i) visit(world.directBodies[island.firstBody + i]);
}

/// Does anybody look at bodies of it between two substeps?
bool isLookedAt(const WorldImpl& world, const DirectIsland& island) {
    bool looked = false;
    if (world.moduleWork.acts())
        forMembers(world, island, [&](std::uint32_t body) { looked |= world.moduleWork.actsOn(body); });
    return looked;
}

struct Pace {
    int stride;
    bool alone;
};

/// A tree takes as many substeps at once as its gaps allow and no link turns too far in, and is alone if what it hangs
/// from stands still. Trees that hang from nothing share their parabola with other such figures unless they leap.
Pace paceOf(const WorldImpl& world, const direct::TreePlan::Tree& tree, bool mayBeAlone) {
    const DirectIsland& island = world.directIslands[tree.owner];
    const BodyState& anchor = world.states[tree.anchor];
    if (isLookedAt(world, island)) return {1, false};
    if (anchor.v != Vec3{} || anchor.w != Vec3{}) return {1, false};
    const bool hangs = world.chains.linkOf(tree, 0).joint != direct::TreeJoint::free;
    if (!island.strides) return {1, mayBeAlone && (hangs || island.leapfrog)};
    float square = 0;
    int most = kLongest;
    forMembers(world, island, [&](std::uint32_t body) {
        square = std::max(square, lengthSquared(world.states[body].w));
        most = std::min(most, static_cast<int>(world.bodies[body].mayStride));
    });
    const float longest = static_cast<float>(direct::tuning::kLongTurn) / world.context.h;
    int stride = 1;
    while (2 * stride <= most && world.settings.substeps % (2 * stride) == 0 &&
           square * static_cast<float>(4 * stride * stride) < longest * longest)
        stride *= 2;
    return {stride, mayBeAlone};
}

/// What changes with the trees and their paces alone.
void markTrees(WorldImpl& world) {
    BodyStrides& strides = world.strides;
    strides.marks.resizeForOverwrite(world.bodies.size());
    for (const std::uint32_t body : world.awakeBodies) strides.marks[body] = 0;
    for (DirectIsland& island : world.directIslands) island.alone = false;
    strides.any = false;
    strides.aloneCount = 0;
    for (std::size_t t = 0; t < world.chains.treeCount(); ++t) {
        const direct::TreePlan::Tree& tree = world.chains.treeAt(t);
        DirectIsland& island = world.directIslands[tree.owner];
        strides.any |= tree.alone || tree.stride > 1;
        strides.aloneCount += tree.alone ? tree.count : 0;
        island.alone = tree.alone;
        const int mark = tree.stride | (tree.alone ? BodyStrides::kAlone : 0);
        forMembers(world, island, [&](std::uint32_t body) { strides.marks[body] = static_cast<std::uint8_t>(mark); });
    }
    strides.sharedJoints.clear();
    for (const DirectIsland& island : world.directIslands)
        for (std::uint32_t j = 0; j < island.jointCount && !island.alone; ++j)
            strides.sharedJoints.push(world.directJoints[island.firstJoint + j]);
}

/// The bodies that take part in the world's substeps, by their strides.
void listShared(WorldImpl& world) {
    BodyStrides& strides = world.strides;
    for (AlignedArray<std::uint32_t>& list : strides.lists) list.clear();
    if (strides.aloneCount == world.rest.solved.size()) return;
    for (const std::uint32_t body : world.rest.solved) {
        if ((strides.marks[body] & BodyStrides::kAlone) != 0) continue;
        giveStride(world, body, strides.marks[body]);
        if (strides.any) strides.lists[static_cast<std::size_t>(world.bodies[body].stride / 2)].push(body);
    }
}

}  // namespace

/// Speeds of a body that joints hold belong to the middle of a substep. Where the next one is longer or shorter, the
/// forces between the middles of both are those of half of each. What is of no tree, or of none any more, has stride 0.
void giveStride(WorldImpl& world, std::uint32_t index, int stride) {
    BodyRecord& body = world.bodies[index];
    if (stride == 0) body.stride = 1;
    if (stride == 0 || stride == body.stride) return;
    BodyState& state = world.states[index];
    const float early = 0.5f * world.context.h * static_cast<float>(stride - static_cast<int>(body.stride));
    body.stride = static_cast<std::uint8_t>(stride) & 15u;
    state.v -= early * (body.gravityScale * world.settings.gravity + state.invMass * body.force);
    state.w -= early * (world.inertias[index] * body.torque);
}

void chooseStrides(WorldImpl& world) {
    direct::TreePlan& chains = world.chains;
    if (chains.treeCount() == 0 && !world.strides.any) return;
    std::atomic<bool> changed{!chains.isGrouped()};
    // What was just made is settled among all bodies, before the step or within its first substep.
    const bool mayBeAlone = world.newJoints.empty() && world.freshManifolds.empty();
    world.runner.parallelFor(static_cast<int>(chains.treeCount()), 8, [&](int begin, int end, int) {
        for (auto t = static_cast<std::size_t>(begin); t < static_cast<std::size_t>(end); ++t) {
            const Pace pace = paceOf(world, chains.treeAt(t), mayBeAlone);
            if (chains.setPace(t, pace.stride, pace.alone)) changed.store(true, std::memory_order_relaxed);
        }
    });
    if (changed.load(std::memory_order_relaxed)) {
        chains.group(direct::selectTreeKernels(world.graph.lanes()));
        markTrees(world);
    }
    listShared(world);
}

void noteGaps(WorldImpl& world, const DirectIsland& island) {
    constexpr std::uint8_t kCalmSteps = 16;
    const BodyRecord& first = world.bodies[world.directBodies[island.firstBody]];
    int stride = first.mayStride, calm = island.ajar ? 0 : first.calmSteps;
    if (island.open || island.swept) {
        stride = std::max(stride / 2, 1);
    } else if (!island.ajar && ++calm >= kCalmSteps) {
        stride = std::min(2 * stride, kLongest);
        calm = 0;
    }
    if (island.swept) rescaleJoints(world, island, 1 / static_cast<float>(first.stride));
    forMembers(world, island, [&](std::uint32_t body) {
        world.bodies[body].mayStride = static_cast<std::uint8_t>(stride) & 15u;
        world.bodies[body].calmSteps = static_cast<std::uint8_t>(calm);
    });
}

void rescaleJoints(WorldImpl& world, const DirectIsland& island, float ratio) {
    for (std::uint32_t j = 0; j < island.jointCount; ++j)
        rescaleJoint(world.jointSims[world.directJoints[island.firstJoint + j]], ratio);
}

}  // namespace ragtop
