#pragma once

#include "direct/island_system.h"

namespace ragtop::direct {

/// What solving took.
struct SolveReport {
    int iterations = 0;  ///< Newton steps
    int factorizations = 0;
    double residual = 0;  ///< of the impulses, relative
    bool converged = true;
};

/// Damped Newton on a system whose targets are set: from loads that hold, nothing is done. `factored` tells whether the
/// system still has a factor of an earlier solve of this step, and is kept up. The velocity is left in the system; it
/// is finite whatever happens.
void solve(IslandSystem& system, bool startFromLoads, bool& factored, SolveReport& report);

/// A system of joints alone, in so many steps at most of an active set [Hintermüller, Ito, Kunisch, 2002]: rigid rows
/// hold after each of them, and rows with bounds hold or give as the step before has found them.
void solveJoints(IslandSystem& system, int steps, bool& factored, SolveReport& report);

}  // namespace ragtop::direct
