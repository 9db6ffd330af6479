#include <fmt/format.h>

#include <vector>

#include "../extremes.h"
#include "../families.h"
#include "../scenery.h"

namespace ragtop::stability {
namespace {
namespace mass_ratios_cases {

const Material kMaterial = surface(0.5f);

int addCube(Scene& scene, const DVec3& middle, float mass) {
    return add(scene, solidBody(Box{{0.5f, 0.5f, 0.5f}}, middle, mass, kMaterial));
}

/// Unit cubes of these masses (kg) on top of each other, from below.
Scene columnOf(const std::vector<float>& masses) {
    Scene scene;
    addFloor(scene, kMaterial);
    Dice dice(7);
    for (std::size_t i = 0; i < masses.size(); ++i)
        addCube(scene, DVec3{0, static_cast<double>(i) + 0.5, 0} + jitter(dice, 0.001f), masses[i]);
    return scene;
}

/// Rows of cubes of 1 kg, each on the gap between two below, with a heavy one on top.
Scene pyramidWithCap(int rows, float capMass) {
    Scene scene;
    addFloor(scene, kMaterial);
    Dice dice(3);
    constexpr double kSpacing = 1.1;
    for (int row = 0; row < rows; ++row)
        for (int i = 0; i < rows - row; ++i)
            addCube(scene, DVec3{kSpacing * (i + 0.5 * row), row + 0.5, 0} + jitter(dice, 0.001f), 1);
    addCube(scene, {kSpacing * 0.5 * (rows - 1), rows + 0.5, 0}, capMass);
    return scene;
}

struct Sinking {
    double time = 0;  ///< s, until the topmost body had lost half its size
    double depth = 0;
};

Sinking watch(Run& run, double seconds) {
    const int top = static_cast<int>(run.scene().bodies.size()) - 1;
    const double from = run.height(top);
    Sinking result;
    run.advance(seconds, [&] {
        result.depth = larger(result.depth, from - run.height(top));
        if (!(result.depth < 0.5)) return false;
        result.time = run.time();
        return true;
    });
    return result;
}

void heavyOnLight(Trial& trial, float ratio) {
    Run run = trial.start(columnOf({1, ratio}));
    trial.expectAtMost("sinks", watch(run, 10).depth, 0.002, "m");
}

void stands(Trial& trial, const Scene& scene) {
    constexpr double kSeconds = 60;
    Run run = trial.start(scene);
    const Sinking result = watch(run, kSeconds);
    trial.expectAtLeast("stands", result.time, kSeconds, "s");
    trial.expectAtMost("sinks", result.depth, 0.005, "m");
}

}  // namespace mass_ratios_cases
}  // namespace

Family massRatios() {
    using namespace mass_ratios_cases;
    Family family{"mass_ratio", {}};
    for (const int ratio : {10, 100, 1000, 10000})
        family.cases.push_back({fmt::format("{} kg on 1 kg", ratio),
                                [ratio](Trial& trial) { heavyOnLight(trial, static_cast<float>(ratio)); }});
    family.cases.push_back({"five alternating at 100:1", [](Trial& trial) {
                                stands(trial, columnOf({1, 100, 1, 100, 1}));
                            }});
    for (const int cap : {100, 300})
        family.cases.push_back({fmt::format("{} kg on a pyramid of ten rows", cap),
                                [cap](Trial& trial) { stands(trial, pyramidWithCap(10, static_cast<float>(cap))); }});
    return family;
}

}  // namespace ragtop::stability
