#include <benchmark/benchmark.h>

#include <cstddef>
#include <vector>

#include "../tests/core/scenes.h"
#include "ragtop/tasks.h"

/// Whole steps of scenes, and saving, restoring and hashing of a large one. Argument: threads.
namespace ragtop {
namespace {

constexpr double kStep = 1.0 / 60;

WorldConfig configFor(const benchmark::State& state) {
    const int threads = static_cast<int>(state.range(0));
    return {.tasks = threads > 1 ? threadTasks(threads) : serialTasks()};
}

void report(benchmark::State& state, const World& world) {
    const StepStats stats = world.stats();
    state.counters["bodies"] = stats.awakeBodies;
    state.counters["contacts"] = stats.touching;
    if (stats.touching > 0)
        state.counters["time/contact"] = benchmark::Counter(
            stats.touching, benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}

/// A scene that rests but may not sleep.
template <class Build>
void resting(benchmark::State& state, Build&& build) {
    WorldSettings settings;
    settings.sleeping = false;
    World world(settings, configFor(state));
    build(world);
    for (int i = 0; i < 60; ++i) world.step(kStep);
    for (auto _ : state) world.step(kStep);
    report(state, world);
}

void tower(benchmark::State& state) {
    resting(state, [](World& world) { scenes::addTower(world); });
}
void houses(benchmark::State& state) {
    resting(state, [](World& world) {
        scenes::addFloor(world);
        for (int i = 0; i < 10; ++i) scenes::addHouse(world, {}, 3, 6.0 * i, false);
    });
}
void pyramid(benchmark::State& state) {
    resting(state, [](World& world) { scenes::addPyramid(world, {}, 12); });
}
void hills(benchmark::State& state) {
    resting(state, [](World& world) {
        scenes::addHills(world);
        scenes::addMixedShapes(world, {}, 200);
    });
}
void figures(benchmark::State& state) {
    resting(state, [](World& world) {
        scenes::addFloor(world);
        for (int i = 0; i < 20; ++i) scenes::addFigure(world, {}, 2 * i, 2);
    });
}
void sleepers(benchmark::State& state) {
    World world({}, configFor(state));
    scenes::addFloor(world);
    for (int i = 0; i < 10; ++i) scenes::addBricks(world, {}, 20, 10, i);
    for (int i = 0; i < 600; ++i) world.step(kStep);
    for (auto _ : state) world.step(kStep);
    report(state, world);
}

void threadCounts(benchmark::internal::Benchmark* bench) {
    bench->ArgName("threads")->Arg(1)->Arg(2)->Unit(benchmark::kMicrosecond)->UseRealTime();
}
BENCHMARK(tower)->Apply(threadCounts);
BENCHMARK(houses)->Apply(threadCounts);
BENCHMARK(pyramid)->Apply(threadCounts);
BENCHMARK(hills)->Apply(threadCounts);
BENCHMARK(figures)->Apply(threadCounts);
BENCHMARK(sleepers)->Apply(threadCounts);

/// 2,000 resting bricks.
class Bricks : public benchmark::Fixture {
public:
    void SetUp(const benchmark::State&) override {
        WorldSettings settings;
        settings.sleeping = false;
        world = World(settings);
        scenes::addFloor(world);
        for (int i = 0; i < 10; ++i) scenes::addBricks(world, {}, 20, 10, i);
        for (int i = 0; i < 60; ++i) world.step(kStep);
        memory.resize(world.saveSize());
        world.save(memory);
    }
    void count(benchmark::State& state) const {
        state.counters["contacts"] = world.stats().contacts;
        state.SetBytesProcessed(static_cast<std::int64_t>(state.iterations()) *
                                static_cast<std::int64_t>(memory.size()));
    }
    World world;
    std::vector<std::byte> memory;
};

BENCHMARK_DEFINE_F(Bricks, save)(benchmark::State& state) {
    for (auto _ : state) benchmark::DoNotOptimize(world.save(memory));
    count(state);
}
BENCHMARK_DEFINE_F(Bricks, restore)(benchmark::State& state) {
    for (auto _ : state) world.restore(memory);
    count(state);
}
BENCHMARK_DEFINE_F(Bricks, hash)(benchmark::State& state) {
    for (auto _ : state) benchmark::DoNotOptimize(world.hash());
    count(state);
}
BENCHMARK_REGISTER_F(Bricks, save)->Unit(benchmark::kMicrosecond);
BENCHMARK_REGISTER_F(Bricks, restore)->Unit(benchmark::kMicrosecond);
BENCHMARK_REGISTER_F(Bricks, hash)->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace ragtop
