#pragma once

#include "direct/equations.h"

namespace ragtop::direct {

/// What solving took.
struct SolveReport {
    int solves = 0;
    int iterations = 0;  ///< Newton steps
    int factorizations = 0;
    int softness = 0;     ///< stages by which points give way more than asked for, in the next solve of this step
    double residual = 0;  ///< of the impulses, relative
    bool converged = true;
};

/// Damped Newton on a system whose targets are set: from loads that hold, nothing is done. `factored` tells whether the
/// system still has a factor of an earlier solve of this step, and is kept up. The velocity is left in the system; it
/// is finite whatever happens.
void solve(Equations& equations, bool startFromLoads, bool& factored, SolveReport& report);

/// May a system be factorized so many times more in this step?
bool mayFactor(const Equations& equations, const SolveReport& report, int more = 1);

inline constexpr int kPivots = 512;  ///< after which a system falls back; struck tangles take seven on average
/// A system of joints alone, from the sides of their bounds that its rows have: a linear system but for these, which
/// block principal pivoting finds in finitely many steps [Júdice, Pires, 1994] where Newton's method meets one bound
/// after the other. False when it did not converge, at a velocity that is finite.
bool pivot(Equations& equations, bool& factored, SolveReport& report, int mostPivots = kPivots);

}  // namespace ragtop::direct
