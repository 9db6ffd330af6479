#pragma once

#include "world/world_impl.h"

/// Trees of joints that are calm take several substeps of the world at once (docs/adr/0031-calm-chains.md).
namespace ragtop {

/// How many each body of this step does; groups trees anew that changed.
void chooseStrides(WorldImpl& world);
/// Shorter at once where joints of a tree opened, longer when they have been closed for a while.
void noteGaps(WorldImpl& world, const DirectIsland& island);
/// Loads of as many substeps as its joints are swept at once.
void rescaleJoints(WorldImpl& world, const DirectIsland& island, float ratio);

/// Calls visit(bodies, begin, end, context) in parallel for those that begin a substep of their own now.
template <class Visit>
void forBodiesInTurn(WorldImpl& world, Visit&& visit) {
    for (std::size_t k = 0; k < world.strides.lists.size(); ++k) {
        const bool whole = k == 0 && !world.strides.any;
        const AlignedArray<std::uint32_t>& some = world.strides.lists[k];
        const std::span<const std::uint32_t> list = whole ? world.rest.solved : std::span(some.data(), some.size());
        if (list.empty() || world.context.substep % (1 << k) != 0) continue;
        SolverContext own = world.context;
        own.h *= static_cast<float>(1 << k);
        world.runner.parallelFor(static_cast<int>(list.size()), 64,
                                 [&](int begin, int end, int) { visit(list.data(), begin, end, own); });
    }
}

}  // namespace ragtop
