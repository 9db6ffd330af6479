#include "variants.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace ragtop::chart {
namespace {

using namespace stability;

/// What sweeps vary: games choose substeps of Ragtop from one on.
Variant ragtop(const char* name, SolverChoice solver, std::vector<int> substeps, const char* what) {
    return {"ragtop",
            name,
            RAGTOP_VERSION,
            what,
            {1.0 / 60, 4, 0},
            std::move(substeps),
            {0},
            solver == SolverChoice::automatic,
            [solver](const Scene& scene, const Setting& setting) {
                return makeRagtop(scene, {.substeps = setting.substeps, .solver = solver});
            }};
}

/// The first number of iterations is the variant's own.
template <class Options>
Variant peer(const char* engine, const char* name, const std::string& version, std::vector<int> iterations, bool quick,
             const char* what, std::unique_ptr<Engine> (*make)(const Scene&, const Options&), Options options) {
    const int standard = iterations.front();
    std::ranges::sort(iterations);
    return {engine,
            name,
            version,
            what,
            {1.0 / 60, 1, standard},
            {1},
            std::move(iterations),
            quick,
            [make, options](const Scene& scene, const Setting& setting) {
                Options own = options;
                if constexpr (requires { own.substeps; }) own.substeps = setting.substeps;
                if constexpr (requires { own.digits; })
                    own.digits = setting.iterations;
                else
                    own.iterations = setting.iterations;
                return make(scene, own);
            }};
}

#ifdef RAGTOP_WITH_BULLET
Variant bullet(const char* name, std::vector<int> iterations, bool quick, const char* what,
               BulletSolver solver = BulletSolver::sequential, decltype(&makeBullet) make = makeBullet) {
    return peer("bullet", name, bulletVersion(), std::move(iterations), quick, what, make,
                BulletOptions{.solver = solver});
}
#endif

#ifdef RAGTOP_WITH_MUJOCO
Variant mujoco(const char* name, const MujocoOptions& options, bool quick, const char* what) {
    Variant variant = peer("mujoco", name, mujocoVersion(), {100}, quick, what, makeMujoco, options);
    variant.standard.substeps = 8;
    return variant;
}
#endif

std::vector<Variant> make() {
    std::vector<Variant> variants{
        ragtop("ragtop", SolverChoice::automatic, {1, 2, 4, 8, 16}, "default settings"),
        ragtop("ragtop-sweeps", SolverChoice::iterative, {1, 4, 16}, "sweeps in every island"),
        ragtop("ragtop-direct", SolverChoice::direct, {1, 4, 16}, "the direct solver wherever it fits"),
    };
    const auto add = [&variants](Variant variant) { variants.push_back(std::move(variant)); };
#ifdef RAGTOP_WITH_BULLET
    add(bullet("bullet", {10, 4, 20}, true, "sequential impulses, single precision"));
    add(bullet("bullet-50", {50, 100}, false, "the same with 50 iterations, which games choose for stacks"));
    add(bullet("bullet-nncg", {10, 20}, true, "nonlinear conjugate gradients", BulletSolver::nncg));
    add(bullet("bullet-multibody", {10, 50}, false, "joints in reduced coordinates", {}, makeBulletMultibody));
#endif
#ifdef RAGTOP_WITH_BULLET_DOUBLE
    add(bullet("bullet-double", {10, 50}, false, "sequential impulses, double precision", {}, makeBulletDouble));
#endif
#ifdef RAGTOP_WITH_MUJOCO
    using enum MujocoIntegrator;
    constexpr auto kTrees = MujocoJoints::trees;
    add(mujoco("mujoco", {}, true, "Newton, elliptic cones, Euler; joints as equality constraints"));
    add(mujoco("mujoco-pyramids", {.pyramids = true}, true, "its default friction, a pyramid in the cone"));
    add(mujoco("mujoco-rk4", {.integrator = rk4}, false, "Runge–Kutta of fourth order"));
    add(mujoco("mujoco-implicit", {.integrator = implicit}, false, "implicit in velocity"));
    add(mujoco("mujoco-trees", {.joints = kTrees}, true, "its own trees of joints"));
    add(mujoco("mujoco-trees-rk4", {.joints = kTrees, .integrator = rk4}, false, "its own trees, Runge–Kutta"));
    add(mujoco("mujoco-trees-implicit", {.joints = kTrees, .integrator = implicit}, false, "its own trees, implicit"));
#endif
#ifdef RAGTOP_WITH_ODE
    add(peer("ode", "ode", odeVersion(), {20, 10, 100}, true, "quick step: sweeps in random order", makeOde,
             OdeOptions{}));
    add(peer("ode", "ode-exact", odeVersion(), {0}, true, "Dantzig's pivoting", makeOde, OdeOptions{.exact = true}));
#endif
#ifdef RAGTOP_WITH_DART
    add(peer("dart", "dart", dartVersion(), {0}, true, "reduced coordinates, Dantzig's pivoting", makeDart,
             DartOptions{}));
    add(peer("dart", "dart-sweeps", dartVersion(), {30, 100}, true, "reduced coordinates, projected Gauss–Seidel",
             makeDart, DartOptions{.sweeps = true}));
#endif
#ifdef RAGTOP_WITH_SIMBODY
    add(peer(
        "simbody", "simbody", simbodyVersion(), {3, 1, 6}, false,
        "reduced coordinates, Runge–Kutta–Merson; iterations are the digits that its control of errors is asked for",
        makeSimbody, SimbodyOptions{}));
#endif
    return variants;
}

std::vector<int> ratesOf(Effort effort) {
    switch (effort) {
        case Effort::quick:
            return {30, 60, 120, 240, 480};
        case Effort::normal:
            return {15, 30, 60, 120, 240, 480, 960};
        default:
            return {15, 20, 30, 45, 60, 90, 120, 180, 240, 480, 960, 1920};
    }
}

/// Quick sweeps have the least number, the standard one and the one after it.
std::vector<int> thinned(const std::vector<int>& all, int standard, Effort effort) {
    if (effort != Effort::quick) return all;
    const auto at = std::ranges::find(all, standard);
    if (at == all.end()) return {all.front(), all.back()};
    std::vector<int> some{at, at + std::min<std::ptrdiff_t>(2, all.end() - at)};
    if (some.front() != all.front()) some.insert(some.begin(), all.front());
    return some;
}

}  // namespace

const std::vector<Variant>& allVariants() {
    static const std::vector<Variant> variants = make();
    return variants;
}

std::vector<Setting> settingsOf(const Variant& variant, Effort effort) {
    std::vector<Setting> settings{variant.standard};
    for (const int rate : ratesOf(effort))
        for (const int substeps : thinned(variant.substeps, variant.standard.substeps, effort))
            for (const int iterations : thinned(variant.iterations, variant.standard.iterations, effort)) {
                const Setting setting{1.0 / rate, substeps, iterations};
                const bool known = std::ranges::any_of(settings, [&](const Setting& other) {
                    return std::lround(1 / other.step) == rate && other.substeps == substeps &&
                           other.iterations == iterations;
                });
                if (!known) settings.push_back(setting);
            }
    return settings;
}

}  // namespace ragtop::chart
