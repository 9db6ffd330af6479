#include <benchmark/benchmark.h>

#include <vector>

#include "serve/frame_encoder.h"

/// Encoding of poses for pages. Argument: nodes, all of which move.
namespace ragtop {
namespace {

void encodePoses(benchmark::State& state) {
    std::vector<NodePose> poses(static_cast<std::size_t>(state.range(0)));
    for (std::uint32_t i = 0; i < poses.size(); ++i) poses[i].node = i;
    FrameEncoder encoder;
    double time = 0;
    for (auto _ : state) {
        time += 1.0 / 64;
        for (NodePose& node : poses) node.pose.position.x = time;
        encoder.update(poses, 0, time);
        benchmark::DoNotOptimize(encoder.encode(encoder.sequence() - 1));
    }
    state.SetItemsProcessed(state.iterations() * state.range(0));
}

BENCHMARK(encodePoses)->Arg(2000)->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace ragtop
