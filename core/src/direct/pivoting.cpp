// Systems of joints alone.

#include <cmath>
#include <limits>

#include "direct/newton.h"

namespace ragtop::direct {

namespace {

constexpr int kQuick = 128;      ///< of these that are chosen for speed
constexpr int kBlocks = 4;       ///< times that rows may change sides together without fewer being wrong
constexpr int kRefinements = 2;  ///< of the answer, by which rounding of the factor is taken back

/// v ← v − H⁻¹ g: the answer where rows keep their sides.
void stepTo(Equations& equations, double* v, const double* gradient) {
    double* change = equations.scratch.direction.data();
    const std::size_t n = equations.unknowns();
    for (std::size_t k = 0; k < n; ++k) change[k] = -gradient[k];
    equations.solve(change);
    for (std::size_t k = 0; k < n; ++k) v[k] += change[k];
}

/// The answer for the sides that rows have. False when it cannot be had.
bool answerSides(Equations& equations, bool& factored, SolveReport& report) {
    double* v = equations.velocity.data();
    double* gradient = equations.scratch.gradient.data();
    Residual residual = equations.evaluateSides(v, gradient);
    if (!std::isfinite(residual.norm)) return false;
    if (!factored || equations.regionsChanged()) {
        if (!mayFactor(equations, report) || !equations.factorize()) return false;
        factored = true;
        ++report.factorizations;
    }
    for (int i = 0; i < kRefinements && residual.norm > tuning::kResidual * residual.scale; ++i) {
        stepTo(equations, v, gradient);
        ++report.iterations;
        residual = equations.evaluateSides(v, gradient);
    }
    report.residual = residual.scale > 0 ? residual.norm / residual.scale : 0;
    return std::isfinite(residual.norm);
}

}  // namespace

/// All rows that are wrong change sides together as long as that leaves fewer of them, or has done lately; else the one
/// that is wrong by most. Where that does not end, the last of them does, which cannot come round to the same sides
/// again [Murty, 1974].
bool pivot(Equations& equations, bool& factored, SolveReport& report, int mostPivots) {
    std::size_t fewest = std::numeric_limits<std::size_t>::max();
    int blocks = kBlocks;
    for (int i = 0; i < mostPivots; ++i) {
        if (!answerSides(equations, factored, report)) return false;
        const std::size_t wrong = equations.askSides(equations.velocity.data());
        if (wrong == 0) return true;
        const bool fewer = wrong < fewest;
        if (fewer) {
            fewest = wrong;
            blocks = kBlocks;
        } else if (blocks > 0) {
            --blocks;
        }
        const SideChange alone = i < kQuick ? SideChange::farthest : SideChange::last;
        equations.changeSides(fewer ? SideChange::leap : blocks > 0 ? SideChange::step : alone);
    }
    return false;
}

}  // namespace ragtop::direct
