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
    const ConstraintGraph::Color& list = graph.color(ConstraintGraph::kDirect);
    const bool atOnce = islands.structureChanged || islands.directChanged;
    if (!economy.seldomChoices || (islands.graphChanged && (atOnce || stepCount % kPeriod == 0))) {
        islands.uniteConstraints(tables(), false);
        const MeasureView view{tables(), bodies, islands, stageMemory, settings, dt, context.h};
        measureIslands(view);
        islands.graphChanged =
            decideIslands(view, static_cast<std::int32_t>(std::min(stepCount - islands.choiceStep, kPeriod)));
        islands.choiceStep = stepCount;
        activity().applyChoices(tables());
        if (islands.structureChanged) loadNewContacts(view, context.gravityStep, graph, contactFinds.fresh);
        islands.structureChanged = islands.directChanged = false;
        directSet.grouped = false;
    }
    const bool anyDirect = !list.manifolds.empty() || !list.joints.empty();
    // Sleeping may have emptied the list since.
    if (!directSet.grouped || directSet.treesChanged) articulations.forget();
    if (!directSet.grouped || !anyDirect || directSet.treesChanged) groupDirect(directView());
    directSet.grouped = true;
    directSet.treesChanged = false;
}

}  // namespace ragtop
