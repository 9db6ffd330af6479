#include <fmt/format.h>

#include "../extremes.h"
#include "../families.h"
#include "../scenery.h"

namespace ragtop::stability {
namespace {
namespace step_sizes_cases {

/// Ten unit boxes at a step of 1/rate, whatever the suite's own step is.
void stack(Trial& trial, int rate) {
    constexpr int kBoxes = 10;
    constexpr double kSeconds = 10;
    Scene scene;
    const Material material = surface(0.5f);
    addFloor(scene, material);
    Dice dice(kBoxes);
    for (int i = 0; i < kBoxes; ++i)
        add(scene, solidBody(Box{{0.5f, 0.5f, 0.5f}}, DVec3{0, i + 0.5, 0} + jitter(dice, 0.001f), 1, material));
    trial.setStep(1.0 / rate);
    Run run = trial.start(scene);
    double loss = 0;
    run.advance(kSeconds, [&] {
        loss = larger(loss, kBoxes - 0.5 - run.height(kBoxes));
        return loss < 0.5;
    });
    trial.expectAtLeast("stands", run.time(), kSeconds, "s");
    trial.expectAtMost("height lost", loss, 0.005, "m");
}

}  // namespace step_sizes_cases
}  // namespace

Family stepSizes() {
    using namespace step_sizes_cases;
    Family family{"step_size", {}};
    for (const int rate : {15, 30, 120, 240})
        family.cases.push_back(
            {fmt::format("ten boxes at 1/{} s", rate), [rate](Trial& trial) { stack(trial, rate); }, Kind::oneStep});
    return family;
}

}  // namespace ragtop::stability
