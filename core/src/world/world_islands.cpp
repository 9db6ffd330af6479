// Which islands are solved directly: what bears on what, and the choice.

#include <algorithm>

#include "base/economy.h"
#include "islands/measure_islands.h"
#include "world/world_impl.h"

namespace ragtop {

/// What is not looked at again waits on for the end of its cooldown.
static void passCooldowns(Bodies& bodies, const AlignedArray<std::uint32_t>& parent, std::int32_t elapsed) {
    for (const std::uint32_t body : bodies.awake)
        if (std::int32_t& steps = bodies[body].direct.steps; steps < 0 && parent[body] == kNone)
            steps = std::min(steps + elapsed, 0);
}

/// Choices change when support edges do, so they are made anew only then: at once for all islands where something was
/// just made or put somewhere, and for those that are solved directly where edges of theirs changed; else every few
/// steps.
void WorldImpl::chooseSolvers(const Activity& active, const DirectView& direct) {
    constexpr std::uint64_t kPeriod = 16;  // steps between choices that nothing hurries: a quarter of a second at 60 Hz
    const ConstraintGraph::Color& list = tables.graph.color(ConstraintGraph::kDirect);
    Islands& islands = partition.islands;
    const bool all = !economy.seldomChoices || !economy.islands ||
                     (islands.graphChanged && (islands.structureChanged || clock.stepCount % kPeriod == 0 ||
                                               (islands.directChanged && tables.couplings.slots.count() > 0)));
    if (all || islands.directChanged) {
        const auto elapsed = static_cast<std::int32_t>(std::min(clock.stepCount - islands.choiceStep, kPeriod));
        IslandLists lists;
        if (all)
            islands.uniteConstraints(tables, false);
        else
            lists = islands.findDirect(tables);
        const IslandLists* some = all ? nullptr : &lists;
        const MeasureView view{tables,   tables.bodies, islands,           machine.stageMemory,
                               settings, clock.dt,      solving.context.h, some};
        measureIslands(view);
        const bool waiting = decideIslands(view, elapsed);
        islands.graphChanged = !all || waiting;
        if (!all) passCooldowns(tables.bodies, islands.parent, elapsed);
        islands.choiceStep = clock.stepCount;
        active.applyChoices(tables, some);
        if (islands.structureChanged)
            loadNewContacts(view, solving.context.gravityStep, tables.graph, collision.finds.fresh);
        islands.structureChanged = islands.directChanged = false;
        partition.direct.grouped = false;
    }
    const bool anyDirect = !list.manifolds.empty() || !list.joints.empty();
    // Sleeping may have emptied the list since.
    if (!partition.direct.grouped || partition.direct.treesChanged) partition.articulations.forget();
    if (!partition.direct.grouped || !anyDirect || partition.direct.treesChanged) groupDirect(direct);
    partition.direct.grouped = true;
    partition.direct.treesChanged = false;
}

}  // namespace ragtop
