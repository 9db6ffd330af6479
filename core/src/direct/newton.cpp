#include "direct/newton.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/economy.h"
#include "direct/choice.h"

namespace ragtop::direct {

namespace {

constexpr int kIterations = 12;        ///< Newton steps from loads of the substep before
constexpr int kMoreIterations = 40;    ///< of each stage where those do not suffice
constexpr int kLook = 4;               ///< after so many of the former, what has come no nearer is given up
constexpr double kNoNearer = 0.9;      ///< of the impulses: a residual that tells of none of them yet
constexpr int kLeastFactors = 40;      ///< of a step that has to be approached: five of each of its solves
constexpr int kEasy = 4;               ///< Newton steps of a softer system, after which the next may be harder
constexpr int kLargeFactors = 6;       ///< in one step of a large island; it stays as it was
constexpr double kMostProducts = 1e6;  ///< of blocks, in all factorizations of one step; some 0.1 s
constexpr int kBudget = 160;           ///< Newton steps in one step of the world, after which softer systems answer
constexpr int kSolveBudget = 20;       ///< of each solve so far, where substeps are many
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

/// Of a velocity that was not evaluated.
constexpr Residual kUnknown{std::numeric_limits<double>::infinity(), 0};

/// The α at which the slope has fallen enough: 1 where the quadratic model is right, else by false position with
/// halving [Illinois], which a convex function cannot defeat.
double lineSearch(const Equations& equations, const double* v, const double* d, double slope0) {
    double low = 0, slopeLow = slope0, high = 1;
    double slopeHigh = equations.slopeAlong(v, d, high);
    const double enough = kLineSlope * std::fabs(slope0);
    if (!(slopeHigh > enough)) return 1;
    int side = 0;
    for (int i = 0; i < kLineSteps; ++i) {
        const double alpha = (low * slopeHigh - high * slopeLow) / (slopeHigh - slopeLow);
        const double slope = equations.slopeAlong(v, d, alpha);
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

bool isLarge(const Equations& equations) { return equations.bodies.size() > kMostBodies; }

/// With loads s λ̂ bodies have ℓ(s) = ½ s² λ̂ᵀ A λ̂ + s λ̂ᵀ (u_free − û) more energy than without, A = J M⁻¹ Jᵀ, of which
/// rows take no more than they are asked to bring. Loads of which ℓ(1) > 0 would throw what they hold, as of what was
/// wedged and has come free: they are shrunk to what takes most. True where it did; speeds are those with the loads. Of
/// contacts alone: the energy guard watches what joints hold (world/energy_guard.h).
bool shrinkLoads(Equations& equations) {
    double along = 0, square = 0;
    for (const SystemContact& c : equations.contacts)
        for (std::uint32_t j = 0; j < c.count; ++j) {
            const SystemPoint& p = equations.points[c.first + j];
            along += p.load[0] * (p.speed[0] + c.friction * p.slip - p.target) + p.load[1] * p.speed[1] +
                     p.load[2] * p.speed[2];
        }
    for (std::size_t i = 0; i < equations.bodies.size(); ++i) {
        const SystemBody& body = equations.bodies[i];
        const double *v = equations.velocity.data() + 6 * i, *from = equations.free.data() + 6 * i;
        for (int k = 0; k < 3; ++k) square += body.mass[k] * (v[k] - from[k]) * (v[k] - from[k]);
        const DVec3 turn = load(v + 3) - load(from + 3);
        square += dot(turn, (body.inertia + body.stiffness) * turn);
    }
    if (!(along - 0.5 * square > 0)) return false;
    const double best = 1 - along / square, share = best > 0 ? best : 0;
    for (SystemPoint& p : equations.points)
        for (double& load : p.load) load *= share;
    equations.loadsKept = false;
    return true;
}

/// A step of Newton's method to where points and rows would be if none changed its region: loads answer to small
/// changes of what they are asked for as they did, while the speeds of light bodies under great loads tell nothing.
/// `evaluated`: speeds there are known.
void predict(Equations& equations, bool evaluated, bool& factored, SolveReport& report) {
    double *v = equations.velocity.data(), *direction = equations.scratch.direction.data();
    if (evaluated)
        equations.evaluateSidesAgain(v, direction);
    else
        equations.evaluateSides(v, direction);
    if (!factored || equations.regionsChanged()) {
        if (!mayFactor(equations, report) || !equations.factorize()) return;
        factored = true;
        ++report.factorizations;
    }
    for (std::size_t k = 0; k < equations.unknowns(); ++k) direction[k] = -direction[k];
    equations.solve(direction);
    for (std::size_t k = 0; k < equations.unknowns(); ++k) v[k] += direction[k];
    ++report.iterations;
}

/// A residual that ends the search before its first step.
bool isSolved(const Residual& residual, double enough) {
    return (residual.norm <= enough * residual.scale && economy.zeroIterations) || residual.norm == 0;
}

/// One convex problem. False when it did not converge. `residual` is that at the velocity that is left.
bool minimize(Equations& equations, int iterations, double enough, bool& factored, SolveReport& report,
              Residual& residual) {
    const std::size_t n = equations.unknowns();
    double* v = equations.velocity.data();
    double* gradient = equations.scratch.gradient.data();
    double* direction = equations.scratch.direction.data();
    double last = 0;
    bool stale = true;
    for (int i = 0; i < iterations; ++i) {
        residual = equations.evaluate(v, gradient);
        report.residual = residual.scale > 0 ? residual.norm / residual.scale : 0;
        if (!std::isfinite(residual.norm)) return false;
        if (isSolved(residual, enough) || (i > 0 && residual.norm <= enough * residual.scale)) return true;
        const bool slow = i > 0 && residual.norm > kStale * last;
        if (slow && !stale && residual.norm <= kRounding * residual.scale) return true;
        if (i == kLook && iterations <= kIterations && residual.norm > kNoNearer * residual.scale) break;
        last = residual.norm;
        const bool outdated = slow || equations.regionsChanged();
        if (!factored || (outdated && mayFactor(equations, report))) {
            if (!mayFactor(equations, report) || !equations.factorize()) return false;
            factored = true;
            stale = false;
            ++report.factorizations;
        } else {
            stale = true;
        }
        for (std::size_t k = 0; k < n; ++k) direction[k] = -gradient[k];
        equations.solve(direction);
        ++report.iterations;
        const double slope = dot(gradient, direction, n);
        if (!(slope < 0)) return residual.norm <= kRounding * residual.scale;
        equations.changeAlong(direction);
        const double alpha = lineSearch(equations, v, direction, slope);
        for (std::size_t k = 0; k < n; ++k) v[k] += alpha * direction[k];
    }
    residual = kUnknown;
    return report.residual <= kRounding;
}

/// What a softer system has answered: velocities and loads that belong to each other, and leave the speeds R λ.
void takeSofter(Equations& equations) {
    equations.loadsAt(equations.velocity.data());
    equations.keepPointLoads();
}

enum class Approach { failed, softer, found };

/// Loads far from the answer make a stiff system a hard one. Softer systems are easy, and the loads that each finds
/// bring the next one near its answer. Where that is not found either, as where a wall lands that has lost its loads in
/// the air, the softer system's holds where no joints pull: the substeps that follow harden it.
Approach approach(Equations& equations, int budget, bool& factored, SolveReport& report) {
    const bool jointed = equations.rows.size() > 0;
    double scale = 1;
    for (int stage = 0; stage < kStages; ++stage) scale *= kStage;
    equations.scaleResistance(scale);
    bool any = false, found = false;
    for (int stage = 0; stage <= kStages; ++stage) {
        const bool mayTry = jointed || ((found || !any) && (stage < kStages || report.iterations <= budget));
        factored = false;
        if (mayTry && any) {
            equations.askForLoads();
            predict(equations, found, factored, report);
        }
        Residual residual;
        found = mayTry && minimize(equations, kMoreIterations, tuning::kResidual, factored, report, residual);
        if (stage == kStages) break;
        if (found) {
            equations.takeLoads();
            for (std::size_t k = 0; k < equations.unknowns(); ++k) equations.scratch.trial[k] = equations.velocity[k];
            report.softness = kStages - stage;
        }
        any |= found;
        equations.scaleResistance(1 / kStage);
    }
    factored = false;
    // Joints whose bodies have the speeds of softer contacts gain energy.
    if (found || !any || jointed) {
        report.softness = 0;
        return found ? Approach::found : Approach::failed;
    }
    for (std::size_t k = 0; k < equations.unknowns(); ++k) equations.velocity[k] = equations.scratch.trial[k];
    takeSofter(equations);
    return Approach::softer;
}

/// As soft as the last solve of this step was answered: what was too hard then is so still. What comes easily is harder
/// next time. False where there is no answer.
bool staySoft(Equations& equations, bool evaluated, bool& factored, SolveReport& report) {
    double scale = 1;
    for (int stage = 0; stage < report.softness; ++stage) scale *= kStage;
    equations.scaleResistance(scale);
    factored = false;
    if (!evaluated) equations.askForLoads();
    const int before = report.iterations;
    predict(equations, evaluated, factored, report);
    Residual residual;
    const bool found = minimize(equations, kMoreIterations, tuning::kResidual, factored, report, residual);
    if (found) equations.takeLoads();
    equations.scaleResistance(1 / scale);
    factored = false;
    if (found) takeSofter(equations);
    if (!found || report.iterations - before <= kEasy) --report.softness;
    return found;
}

/// One round of the method of multipliers leaves the speeds R (λ − λ̂). A large island, whose factor is dear, uses it
/// until they are next to nothing, so that the substeps that follow find loads that hold.
void refine(Equations& equations, bool& factored, SolveReport& report) {
    for (int round = 0; round < kRefining && !equations.loadsHold(kRefined); ++round) {
        equations.takeLoads();
        Residual residual;
        if (!minimize(equations, kIterations, tuning::kResidual, factored, report, residual)) return;
    }
}

}  // namespace

bool mayFactor(const Equations& equations, const SolveReport& report, int more) {
    if (isLarge(equations) && report.factorizations >= kLargeFactors) return false;
    return (report.factorizations + more) * static_cast<double>(equations.factorProducts()) <= kMostProducts;
}

void solve(Equations& equations, bool startFromLoads, bool& factored, SolveReport& report) {
    double* v = equations.velocity.data();
    report.converged |= isLarge(equations);
    const int budget = std::max(kBudget, kSolveBudget * ++report.solves);
    if (startFromLoads) {
        equations.velocityOfLoads(v);
        equations.loadsAt(v);
        if (economy.zeroIterations && equations.loadsHold()) {
            equations.keepLoads();
            equations.stopRounding();
            return;
        }
        if (equations.rows.size() == 0 && shrinkLoads(equations)) {
            equations.velocityOfLoads(v);
            equations.loadsAt(v);
        }
    }
    if (startFromLoads) equations.takeSidesOfLoads();
    if (equations.points.size() == 0 && pivot(equations, factored, report)) return;
    if (startFromLoads) equations.askForLoads();
    if (report.softness > 0 && staySoft(equations, startFromLoads, factored, report)) return;
    const double enough = kSlipChange * equations.gravityStep;
    // Where joints pull, slips go round in circles of speeds that do not matter: those of the solve before do.
    const int rounds = equations.rows.size() > 0 ? 1 : kSlipRounds;
    bool last = false;
    for (int round = 0; !last; ++round) {
        if (equations.points.size() > 0 && !isLarge(equations))
            predict(equations, startFromLoads && round == 0, factored, report);
        Residual residual;
        bool found = minimize(equations, kIterations, kSlipResidual, factored, report, residual);
        if (found) {
            last = equations.slipsChange() <= enough || round + 1 >= rounds;
            if (last && !isSolved(residual, tuning::kResidual))
                found = minimize(equations, kIterations, tuning::kResidual, factored, report, residual);
        }
        Approach way = found ? Approach::found : Approach::failed;
        const bool mayApproach =
            equations.rows.size() == 0 ? mayFactor(equations, report, kLeastFactors) : report.iterations <= budget;
        if (!found && !isLarge(equations) && mayApproach) {
            way = approach(equations, budget, factored, report);
            last = true;  // at its slips each round would have to be approached again
        }
        if (way == Approach::softer) return;
        if (way == Approach::failed) {
            // Newton's steps descend, so that the velocity is sane; the impulses need not be. A large island goes on
            // from there in its next solve.
            if (!isLarge(equations)) equations.keepLoads();
            report.converged = false;
            return;
        }
        equations.updateSlips();
    }
    if (startFromLoads && isLarge(equations)) refine(equations, factored, report);
}

}  // namespace ragtop::direct
