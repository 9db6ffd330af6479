#pragma once

#include "world/world_impl.h"

/// Multirate: trees of joints whose gaps stay small take several substeps of the world at once (docs/adr/0021); those
/// that nothing else has part in do so by themselves (docs/adr/0006).
namespace ragtop {

/// How each body of this step goes through it; groups trees anew that changed.
void chooseStepFactors(WorldImpl& world);
/// Trees that nothing else has part in go through the whole step, each group of them in one task.
void stepIndependentTrees(WorldImpl& world);
/// A body of a tree that takes as many substeps of the world at once from now on.
void setStepFactor(WorldImpl& world, std::uint32_t body, int stepFactor);

/// Calls visit(k, bodies) for those that take 2ᵏ substeps of the world at once and are not independent.
template <class Visit>
void forSharedBodies(const WorldImpl& world, Visit&& visit) {
    for (std::size_t k = 0; k < world.directSet.multirate.lists.size(); ++k) {
        const bool whole = k == 0 && !world.directSet.multirate.any;
        const AlignedArray<std::uint32_t>& some = world.directSet.multirate.lists[k];
        const std::span<const std::uint32_t> list = whole ? world.freezing.solved : std::span(some.data(), some.size());
        if (!list.empty()) visit(static_cast<int>(k), list);
    }
}

/// Calls visit(bodies, begin, end, context) in parallel for those that begin a substep of their own now.
template <class Visit>
void forBodiesInTurn(WorldImpl& world, Visit&& visit) {
    forSharedBodies(world, [&](int k, std::span<const std::uint32_t> list) {
        if (world.context.substep % (1 << k) != 0) return;
        SolverContext own = world.context;
        own.h *= static_cast<float>(1 << k);
        world.runner.parallelFor(static_cast<int>(list.size()), 64,
                                 [&](int begin, int end, int) { visit(list.data(), begin, end, own); });
    });
}

}  // namespace ragtop
