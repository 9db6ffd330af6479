#include <benchmark/benchmark.h>

#include <cmath>
#include <string>
#include <vector>

#include "ragtop/spring_bones.h"

/// What ragdolls and their secondary motion cost on one thread.
namespace ragtop {
namespace {

/// Chains of eight bones on one head that moves, at 60 frames a second.
void springChains(benchmark::State& state) {
    const auto chains = static_cast<int>(state.range(0)), colliders = static_cast<int>(state.range(1));
    constexpr int kBones = 8;
    Skeleton skeleton;
    skeleton.bones.push_back({"head", -1, {}});
    SpringBonesDef def;
    for (int i = 0; i < chains; ++i) {
        const float angle = 2 * kPi * static_cast<float>(i) / static_cast<float>(chains);
        const Vec3 outward{std::cos(angle), 0, std::sin(angle)};
        const int first = static_cast<int>(skeleton.bones.size());
        for (int k = 0; k < kBones; ++k)
            skeleton.bones.push_back(
                {"hair", k == 0 ? 0 : first + k - 1, {(0.1f + 0.05f * static_cast<float>(k)) * outward, {}}});
        def.chains.push_back({.first = first, .last = first + kBones - 1});
    }
    for (int i = 0; i < colliders; ++i) def.colliders.push_back({.bone = 0, .shape = Capsule{0.08f, 0.1f}});
    SpringBones springs(skeleton, def);
    std::vector<Pose> pose(skeleton.bones.size());
    int frame = 0;
    for (auto _ : state) {
        state.PauseTiming();
        const double t = ++frame / 60.0;
        const Pose head{{0.2 * std::sin(5 * t), 0, 0}, rotationAbout({0, 1, 0}, static_cast<float>(std::sin(3 * t)))};
        for (std::size_t i = 0; i < pose.size(); ++i) pose[i] = head * skeleton.bones[i].bind;
        state.ResumeTiming();
        springs.step(pose, 1 / 60.0);
    }
    state.counters["time/bone"] =
        benchmark::Counter(static_cast<double>(chains) * kBones,
                           benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}
BENCHMARK(springChains)
    ->ArgNames({"chains", "colliders"})
    ->Args({10, 0})
    ->Args({1000, 0})
    ->Args({1000, 4})
    ->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace ragtop
