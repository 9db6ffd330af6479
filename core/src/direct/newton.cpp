#include "direct/newton.h"

#include <cmath>

#include "base/economy.h"
#include "direct/choice.h"

namespace ragtop::direct {

namespace {

constexpr int kIterations = 12;        ///< Newton steps from loads of the substep before
constexpr int kMoreIterations = 40;    ///< of each stage where those do not suffice
constexpr int kLargeFactors = 6;       ///< in one step of a large island; it stays as it was
constexpr double kMostProducts = 1e6;  ///< of blocks, in all factorizations of one step; some 0.1 s
constexpr int kBudget = 160;           ///< Newton steps in one step of the world, after which no stages are tried
constexpr int kStages = 2;             ///< softer systems that lead to the one that was asked for
constexpr double kStage = 128;         ///< resistance of a stage over that of the next
constexpr int kSlipRounds = 4;         ///< of the De Saxcé loop, where no joints pull
constexpr int kRefining = 4;           ///< rounds of the method of multipliers of a large island
constexpr double kRefined = 0.1;       ///< of the speeds that may be left alone, where those rounds end
constexpr int kLineSteps = 30;
constexpr double kSlipResidual = 1e-4;  ///< of a system whose slips may still change
constexpr double kSlipChange = 1e-3;  ///< of a row by which slips may still change, in g h
constexpr double kLineSlope = 0.1;    ///< share of the slope that the line search leaves
constexpr double kStale = 0.25;       ///< share of the residual that an old factor may leave
constexpr double kRounding = 1e-5;    ///< relative residual at which lack of progress is rounding

/// The α at which the slope has fallen enough: 1 where the quadratic model is right, else by false position with
/// halving [Illinois], which a convex function cannot defeat.
double lineSearch(const IslandSystem& system, const double* v, const double* d, double slope0) {
    double low = 0, slopeLow = slope0, high = 1;
    double slopeHigh = system.slopeAlong(v, d, high);
    const double enough = kLineSlope * std::fabs(slope0);
    if (!(slopeHigh > enough)) return 1;
    int side = 0;
    for (int i = 0; i < kLineSteps; ++i) {
        const double alpha = (low * slopeHigh - high * slopeLow) / (slopeHigh - slopeLow);
        const double slope = system.slopeAlong(v, d, alpha);
        if (std::fabs(slope) <= enough) return alpha;
        if (slope > 0) {
            high = alpha, slopeHigh = slope;
            if (side == 1) slopeLow *= 0.5;
            side = 1;
        } else {
            low = alpha, slopeLow = slope;
            if (side == -1) slopeHigh *= 0.5;
            side = -1;
        }
    }
    return low;
}

double dot(const double* a, const double* b, std::size_t n) {
    double s = 0;
    for (std::size_t i = 0; i < n; ++i) s += a[i] * b[i];
    return s;
}

bool isLarge(const IslandSystem& system) { return system.bodyCount() > kMostBodies; }

/// A step of Newton's method to where points and rows would be if none changed its region: loads answer to small
/// changes of what they are asked for as they did, while the speeds of light bodies under great loads tell nothing.
void predict(IslandSystem& system, bool& factored, SolveReport& report) {
    double *v = system.velocity(), *direction = system.scratch().direction.data();
    system.evaluateSides(v, direction);
    if (!factored || system.regionsChanged()) {
        if (!mayFactor(system, report) || !system.factorize()) return;
        factored = true;
        ++report.factorizations;
    }
    for (std::size_t k = 0; k < system.unknowns(); ++k) direction[k] = -direction[k];
    system.solve(direction);
    for (std::size_t k = 0; k < system.unknowns(); ++k) v[k] += direction[k];
    ++report.iterations;
}

/// One convex problem. False when it did not converge.
bool minimize(IslandSystem& system, int iterations, double enough, bool& factored, SolveReport& report) {
    const std::size_t n = system.unknowns();
    double* v = system.velocity();
    double* gradient = system.scratch().gradient.data();
    double* direction = system.scratch().direction.data();
    double last = 0;
    bool stale = true;
    for (int i = 0; i < iterations; ++i) {
        const Residual residual = system.evaluate(v, gradient);
        report.residual = residual.scale > 0 ? residual.norm / residual.scale : 0;
        if (!std::isfinite(residual.norm)) return false;
        const bool mayEnd = i > 0 || economy.zeroIterations;
        if ((residual.norm <= enough * residual.scale && mayEnd) || residual.norm == 0) return true;
        const bool slow = i > 0 && residual.norm > kStale * last;
        if (slow && !stale && residual.norm <= kRounding * residual.scale) return true;
        last = residual.norm;
        const bool outdated = slow || system.regionsChanged();
        if (!factored || (outdated && mayFactor(system, report))) {
            if (!mayFactor(system, report) || !system.factorize()) return false;
            factored = true;
            stale = false;
            ++report.factorizations;
        } else {
            stale = true;
        }
        for (std::size_t k = 0; k < n; ++k) direction[k] = -gradient[k];
        system.solve(direction);
        ++report.iterations;
        const double slope = dot(gradient, direction, n);
        if (!(slope < 0)) return residual.norm <= kRounding * residual.scale;
        system.changeAlong(direction);
        const double alpha = lineSearch(system, v, direction, slope);
        for (std::size_t k = 0; k < n; ++k) v[k] += alpha * direction[k];
    }
    return report.residual <= kRounding;
}

/// Loads far from the answer make a stiff system a hard one. Softer systems are easy, and the loads that each finds
/// bring the next one near its answer.
bool approach(IslandSystem& system, bool& factored, SolveReport& report) {
    double scale = 1;
    for (int stage = 0; stage < kStages; ++stage) scale *= kStage;
    system.scaleResistance(scale);
    bool found = false;
    for (int stage = 0; stage <= kStages; ++stage) {
        factored = false;
        found = minimize(system, kMoreIterations, tuning::kResidual, factored, report);
        if (stage == kStages) break;
        if (found) system.takeLoads();
        system.scaleResistance(1 / kStage);
    }
    factored = false;
    return found;
}

/// One round of the method of multipliers leaves the speeds R (λ − λ̂). A large island, whose factor is dear, uses it
/// until they are next to nothing, so that the substeps that follow find loads that hold.
void refine(IslandSystem& system, bool& factored, SolveReport& report) {
    for (int round = 0; round < kRefining && !system.loadsHold(kRefined); ++round) {
        system.takeLoads();
        if (!minimize(system, kIterations, tuning::kResidual, factored, report)) return;
    }
}

}  // namespace

bool mayFactor(const IslandSystem& system, const SolveReport& report) {
    if (isLarge(system) && report.factorizations >= kLargeFactors) return false;
    return (report.factorizations + 1) * static_cast<double>(system.factorProducts()) <= kMostProducts;
}

void solve(IslandSystem& system, bool startFromLoads, bool& factored, SolveReport& report) {
    double* v = system.velocity();
    report.converged |= isLarge(system);
    if (startFromLoads) {
        system.velocityOfLoads(v);
        system.evaluate(v, system.scratch().gradient.data());
        if (economy.zeroIterations && system.loadsHold()) {
            system.keepLoads();
            system.stopRounding();
            return;
        }
    }
    if (startFromLoads) system.takeSidesOfLoads();
    if (system.pointCount() == 0 && pivot(system, factored, report)) return;
    if (startFromLoads) system.askForLoads();
    const double enough = kSlipChange * system.gravityStep();
    // Where joints pull, slips go round in circles of speeds that do not matter: those of the solve before do.
    const int rounds = system.rowCount() > 0 ? 1 : kSlipRounds;
    bool last = false;
    for (int round = 0; !last; ++round) {
        if (system.pointCount() > 0 && !isLarge(system)) predict(system, factored, report);
        bool found = minimize(system, kIterations, kSlipResidual, factored, report);
        if (found) {
            last = system.slipsChange() <= enough || round + 1 >= rounds;
            if (last) found = minimize(system, kIterations, tuning::kResidual, factored, report);
        }
        if (!found && (isLarge(system) || report.iterations > kBudget || !approach(system, factored, report))) {
            // Newton's steps descend, so that the velocity is sane; the impulses need not be. A large island goes on
            // from there in its next solve.
            if (!isLarge(system)) system.keepLoads();
            report.converged = false;
            return;
        }
        system.updateSlips();
    }
    if (startFromLoads && isLarge(system)) refine(system, factored, report);
}

}  // namespace ragtop::direct
