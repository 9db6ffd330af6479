#pragma once

namespace ragtop {

/// What steps leave out because it would change nothing that counts, each of which can be switched off to measure what
/// it saves and what it does to results (`ragtop_bench economy`). All are on, and but for measurements stay so: they
/// are of the whole process, and may be changed only while no world steps.
struct Economy {
    bool islands = true;         ///< sleep and the choice of solvers are each island's; off: one for all that is awake
    bool seldomChoices = true;   ///< solvers are chosen when support edges change; off: in every step
    bool zeroIterations = true;  ///< direct islands whose last solution still holds take no iteration
    bool manifoldReuse = true;   ///< manifolds of pairs that have hardly moved are placed, not found
    bool calmTrees = true;       ///< trees that turn little and what springs hold upright take several substeps at once
    bool independentTrees = true;  ///< those that touch nothing go through the step by themselves
    bool freezing = true;          ///< bodies at rest on what is fixed are left out of the solver
};
inline Economy economy;

}  // namespace ragtop
