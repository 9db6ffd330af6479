#include "variants.h"

#include <algorithm>
#include <cmath>

namespace ragtop::chart {
namespace {

using namespace stability;

Variant ragtop(const char* name, SolverChoice solver, const char* what) {
    return {"ragtop",
            name,
            RAGTOP_VERSION,
            what,
            {1.0 / 60, 4, 0},
            {1, 2, 4, 8, 16},
            {0},
            solver == SolverChoice::automatic,
            [solver](const Scene& scene, const Setting& setting) {
                return makeRagtop(scene, {.substeps = setting.substeps, .solver = solver});
            }};
}

#ifdef RAGTOP_WITH_BULLET
Variant bullet(const char* name, BulletSolver solver, const char* what) {
    return {"bullet",
            name,
            bulletVersion(),
            what,
            {1.0 / 60, 1, 10},
            {1},
            {4, 10, 20, 50, 100},
            true,
            [solver](const Scene& scene, const Setting& setting) {
                return makeBullet(scene,
                                  {.substeps = setting.substeps, .iterations = setting.iterations, .solver = solver});
            }};
}
#endif

#ifdef RAGTOP_WITH_MUJOCO
Variant mujoco(const char* name, const MujocoOptions& options, bool quick, const char* what) {
    return {"mujoco",
            name,
            mujocoVersion(),
            what,
            {1.0 / 60, 8, 100},
            {1},
            {10, 100},
            quick,
            [options](const Scene& scene, const Setting& setting) {
                MujocoOptions own = options;
                own.substeps = setting.substeps;
                own.iterations = setting.iterations;
                return makeMujoco(scene, own);
            }};
}
#endif

#ifdef RAGTOP_WITH_ODE
Variant ode(const char* name, bool exact, const char* what) {
    return {"ode",
            name,
            odeVersion(),
            what,
            {1.0 / 60, 1, exact ? 0 : 20},
            {1},
            exact ? std::vector{0} : std::vector{10, 20, 50, 100},
            true,
            [exact](const Scene& scene, const Setting& setting) {
                return makeOde(scene, {.exact = exact, .substeps = setting.substeps, .iterations = setting.iterations});
            }};
}
#endif

std::vector<Variant> make() {
    std::vector<Variant> variants{
        ragtop("ragtop", SolverChoice::automatic, "default settings"),
        ragtop("ragtop-sweeps", SolverChoice::iterative, "sweeps in every island"),
        ragtop("ragtop-direct", SolverChoice::direct, "the direct solver wherever it fits"),
    };
    const auto add = [&variants](Variant variant) { variants.push_back(std::move(variant)); };
#ifdef RAGTOP_WITH_BULLET
    add(bullet("bullet", BulletSolver::sequential, "sequential impulses, single precision"));
    add(bullet("bullet-nncg", BulletSolver::nncg, "nonlinear conjugate gradients"));
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
    add(ode("ode", false, "quick step: sweeps in random order"));
    add(ode("ode-exact", true, "Dantzig's pivoting"));
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

/// Quick sweeps have the standard number and the one after it.
std::vector<int> thinned(const std::vector<int>& all, int standard, Effort effort) {
    if (effort != Effort::quick) return all;
    const auto at = std::ranges::find(all, standard);
    if (at == all.end()) return {all.back()};
    return {at, at + std::min<std::ptrdiff_t>(2, all.end() - at)};
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
