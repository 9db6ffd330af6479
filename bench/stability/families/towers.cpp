#include <fmt/format.h>

#include <cmath>
#include <vector>

#include "../extremes.h"
#include "../families.h"
#include "../scenery.h"

namespace ragtop::stability {
namespace {
namespace towers_cases {

constexpr int kLevels = 18;
constexpr double kLong = 0.075, kWide = 0.025, kHigh = 0.015;  ///< m
constexpr double kLoose = 0.0005;                              ///< m, by which the middle blocks are thinner
constexpr double kFriction = 0.4;

/// Levels of three blocks, each crossing the one below; the middle ones are thinner and carry nothing.
struct Tower {
    Scene scene;
    std::vector<int> blocks;

    int middleOf(int level) const { return blocks[static_cast<std::size_t>(3 * level + 1)]; }
};

Tower tower() {
    Tower tower;
    const Material material = surface(static_cast<float>(kFriction));
    addFloor(tower.scene, material);
    for (int level = 0; level < kLevels; ++level)
        for (int i = -1; i <= 1; ++i) {
            const double high = i == 0 ? kHigh - kLoose : kHigh, aside = 1.01 * kWide * i;
            const bool alongX = level % 2 == 0;
            const Vec3 half = toVec3(0.5 * DVec3{alongX ? kLong : kWide, high, alongX ? kWide : kLong});
            BodyDef def =
                fixedBody(Box{half}, {alongX ? 0 : aside, kHigh * level + high / 2, alongX ? aside : 0}, material);
            def.type = BodyType::dynamic;
            def.shapes[0].density = 600;
            tower.blocks.push_back(add(tower.scene, def));
        }
    return tower;
}

double largestMove(const Run& run, const Tower& tower, int except) {
    double worst = 0;
    for (const int block : tower.blocks)
        if (block != except) worst = larger(worst, run.moved(block));
    return worst;
}

void stands(Trial& trial) {
    constexpr double kSeconds = 60;
    const Tower scene = tower();
    Run run = trial.start(scene.scene);
    double worst = 0;
    run.advance(kSeconds, [&] {
        worst = larger(worst, largestMove(run, scene, -1));
        return worst < kHigh;
    });
    trial.expectAtLeast("stands", run.time(), kSeconds, "s");
    trial.expectAtMost("largest move", worst, kHigh / 10, "m");
}

/// A loose block pushed with twice the friction of its own weight: it starts with a = μ g and leaves, nothing else
/// does.
void push(Trial& trial, int level) {
    const Tower scene = tower();
    const int block = scene.middleOf(level);
    const double weight =
        kGravity * static_cast<double>(massOf(scene.scene.bodies[static_cast<std::size_t>(block)].def).mass);
    Run run = trial.start(scene.scene);
    run.advance(1);
    const Vec3 along = level % 2 == 0 ? Vec3{1, 0, 0} : Vec3{0, 0, 1};
    // As long as its middle is over the block below it moves freely.
    const double seconds = 0.1;
    const auto count = std::lround(seconds / trial.dt());
    for (long i = 0; i < count; ++i) {
        run.engine().push(block, static_cast<float>(2 * kFriction * weight) * along, run.position(block));
        run.step();
    }
    const double exact = 0.5 * kFriction * kGravity * seconds * seconds;
    trial.expectNear("pushed block", run.moved(block), exact, 0.1 * exact, "m");
    run.advance(2);
    trial.expectAtMost("largest move of the others", largestMove(run, scene, block), kHigh / 10, "m");
}

}  // namespace towers_cases
}  // namespace

Family towers() {
    using namespace towers_cases;
    Family family{"tower", {{"18 levels", stands}}};
    for (int level = 0; level < kLevels; ++level)
        family.cases.push_back(
            {fmt::format("loose block of level {}", level), [level](Trial& trial) { push(trial, level); }});
    return family;
}

}  // namespace ragtop::stability
