// Which islands are solved directly: what bears on what, and the choice.

#include <algorithm>

#include "base/economy.h"
#include "islands/measure_islands.h"
#include "world/world_impl.h"

namespace ragtop {

/// Choices change when support edges do, so they are made anew only then: at once where a direct island has part in it
/// or something was just made or put somewhere, else every few steps.
void WorldImpl::chooseSolvers() {
    constexpr std::uint64_t kPeriod = 16;  // steps between choices that nothing hurries: a quarter of a second at 60 Hz
    const ConstraintGraph::Color& list = tables.graph.color(ConstraintGraph::kDirect);
    const bool atOnce = partition.islands.structureChanged || partition.islands.directChanged;
    if (!economy.seldomChoices || (partition.islands.graphChanged && (atOnce || clock.stepCount % kPeriod == 0))) {
        partition.islands.uniteConstraints(tables, false);
        const MeasureView view{tables,   tables.bodies, partition.islands, machine.stageMemory,
                               settings, clock.dt,      solving.context.h};
        measureIslands(view);
        partition.islands.graphChanged = decideIslands(
            view, static_cast<std::int32_t>(std::min(clock.stepCount - partition.islands.choiceStep, kPeriod)));
        partition.islands.choiceStep = clock.stepCount;
        activity().applyChoices(tables);
        if (partition.islands.structureChanged)
            loadNewContacts(view, solving.context.gravityStep, tables.graph, collision.finds.fresh);
        partition.islands.structureChanged = partition.islands.directChanged = false;
        partition.direct.grouped = false;
    }
    const bool anyDirect = !list.manifolds.empty() || !list.joints.empty();
    // Sleeping may have emptied the list since.
    if (!partition.direct.grouped || partition.direct.treesChanged) partition.articulations.forget();
    if (!partition.direct.grouped || !anyDirect || partition.direct.treesChanged) groupDirect(directView());
    partition.direct.grouped = true;
    partition.direct.treesChanged = false;
}

}  // namespace ragtop
