#include <fmt/format.h>

#include <set>
#include <string_view>
#include <utility>
#include <vector>

#include "../../../tests/core/scenes.h"
#include "../families.h"
#include "ragtop/tasks.h"

namespace ragtop::stability {
namespace {
namespace determinism_cases {

constexpr int kSteps = 600;

World build(const scenes::Scenario& scenario, int threads, int lanes) {
    WorldConfig config;
    config.tasks = threads > 1 ? threadTasks(threads) : serialTasks();
    config.lanes = lanes;
    World world({}, config);
    scenario.build(world, {});
    return world;
}

std::uint64_t hashAfter(World& world, const scenes::Scenario& scenario, int steps) {
    for (int i = 0; i < steps; ++i) scenes::advance(world, scenario);
    return world.hash();
}

/// Different results of all thread counts, all lane widths, a second run and a run restored half way.
void sameBits(Trial& trial, const scenes::Scenario& scenario) {
    std::set<std::uint64_t> hashes;
    // Each count of threads with another width: whichever of them mattered, the results would differ.
    constexpr std::pair<int, int> kThreadsAndLanes[] = {{1, 0}, {2, 4}, {4, 8}, {16, 16}};
    for (const auto& [threads, lanes] : kThreadsAndLanes) {
        World world = build(scenario, threads, lanes);
        hashes.insert(hashAfter(world, scenario, kSteps));
    }
    World world = build(scenario, 1, 0);
    hashAfter(world, scenario, kSteps / 2);
    std::vector<std::byte> half(world.saveSize());
    world.save(half);
    hashes.insert(hashAfter(world, scenario, kSteps / 2));
    world.restore(half);
    hashes.insert(hashAfter(world, scenario, kSteps / 2));
    trial.expectNear("different hashes", static_cast<double>(hashes.size()), 1, 0, "1");
}

}  // namespace determinism_cases
}  // namespace

Family determinism() {
    using namespace determinism_cases;
    Family family{"determinism", {}};
    // The tests of every build ask the same of each of these scenes, for every number of threads and width.
    for (const scenes::Scenario& scenario : scenes::kScenarios)
        family.cases.push_back({scenario.name, [&scenario](Trial& trial) { sameBits(trial, scenario); },
                                Kind::ragtopOnly, scenario.name == std::string_view("joints")});
    return family;
}

}  // namespace ragtop::stability
