#include "world/world_strides.h"

#include <algorithm>

#include "direct/joint_tuning.h"

namespace ragtop {

namespace {

constexpr int kLongest = 1 << (direct::TreePlan::kStrides - 1);

template <class Visit>
void forMembers(const WorldImpl& world, const DirectIsland& island, Visit&& visit) {
    for (std::uint32_t i = 0; i < island.bodyCount; ++i) visit(world.directBodies[island.firstBody + i]);
}

/// The substeps that a tree takes at once: as many as its gaps allow and no link turns too far in. What it hangs from
/// stands still, and nobody looks at it between two substeps.
int strideOf(const WorldImpl& world, const direct::TreePlan::Tree& tree) {
    const DirectIsland& island = world.directIslands[tree.owner];
    const BodyState& anchor = world.states[tree.anchor];
    if (!island.strides || anchor.v != Vec3{} || anchor.w != Vec3{}) return 1;
    for (const StepModule* module : world.modules)
        if (module->beforeSubstep) return 1;
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
    return stride;
}

/// Speeds of a body that joints hold belong to the middle of a substep. Where the next one is longer or shorter, the
/// forces between the middles of both are those of half of each.
void giveStride(WorldImpl& world, std::uint32_t index, int stride) {
    BodyRecord& body = world.bodies[index];
    BodyState& state = world.states[index];
    const float early = 0.5f * world.context.h * static_cast<float>(stride - static_cast<int>(body.stride));
    body.stride = static_cast<std::uint8_t>(stride) & 15u;
    state.v -= early * (body.gravityScale * world.settings.gravity + state.invMass * body.force);
    state.w -= early * (world.inertias[index] * body.torque);
}

}  // namespace

void chooseStrides(WorldImpl& world) {
    BodyStrides& strides = world.strides;
    direct::TreePlan& chains = world.chains;
    if (chains.treeCount() == 0 && !strides.any) return;
    bool changed = false;
    strides.any = false;
    strides.marks.resizeForOverwrite(world.bodies.size());
    for (const std::uint32_t body : world.awakeBodies) strides.marks[body] = 0;
    for (std::size_t t = 0; t < chains.treeCount(); ++t) {
        const int stride = strideOf(world, chains.treeAt(t));
        changed |= chains.setStride(t, stride);
        strides.any |= stride > 1;
        forMembers(world, world.directIslands[chains.treeAt(t).owner],
                   [&](std::uint32_t body) { strides.marks[body] = static_cast<std::uint8_t>(stride); });
    }
    if (changed) chains.group(direct::selectTreeKernels(world.graph.lanes()));
    for (AlignedArray<std::uint32_t>& list : strides.lists) list.clear();
    for (const std::uint32_t body : world.rest.solved) {
        BodyRecord& record = world.bodies[body];
        if (strides.marks[body] == 0)
            record.stride = 1;  // of no tree, or of none any more
        else if (strides.marks[body] != record.stride)
            giveStride(world, body, strides.marks[body]);
        if (strides.any) strides.lists[static_cast<std::size_t>(record.stride / 2)].push(body);
    }
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
