#pragma once

#include <cstdint>
#include <span>

#include "base/aligned_array.h"
#include "base/stage_memory.h"
#include "contacts/tables.h"
#include "islands/islands.h"
#include "ragtop/settings.h"

/// Which islands are solved directly: what bears on what, and the choice.
namespace ragtop {

/// What measuring islands reads, and where it leaves what it finds.
struct MeasureView {
    ConstTables tables;
    Bodies& bodies;    ///< the choice of each
    Islands& islands;  ///< load paths and features, in memory of this stage
    StageMemory& stageMemory;
    const WorldSettings& settings;
    float dt, h;  ///< s, of the step and of a substep
    const IslandLists* some;  ///< islands that alone are looked at; none: all that is awake

    std::span<const std::uint32_t> members() const {
        return some ? some->bodies : std::span<const std::uint32_t>(bodies.awake.begin(), bodies.awake.end());
    }
};

/// True of what was just made and stands: it has no speed at all, as nothing keeps once it has been stepped.
bool isUntouched(const Bodies& bodies, std::uint32_t body);
/// Finds what the choice of a solver is made by, for each island.
void measureIslands(const MeasureView& v);
/// Writes the choice for each island into its bodies, so many steps after the last one. True while some island's choice
/// will change by itself.
bool decideIslands(const MeasureView& v, std::int32_t elapsed);
/// The weight that the estimate hands down to each point, for each contact along which bodies stand or slide and that
/// bears nothing; what pushes today is no weight. Follows measureIslands. `fresh`: their manifolds.
void loadNewContacts(const MeasureView& v, float gravityStep, ConstraintGraph& graph,
                     AlignedArray<std::uint32_t>& fresh);

}  // namespace ragtop
