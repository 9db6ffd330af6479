#include "launch.h"

#include <benchmark/benchmark.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <exception>

#include "subcommands.h"

namespace {

/// The micro-benchmarks, with the options of Google Benchmark.
int runBenchmarks(int argc, char** argv) {
    benchmark::Initialize(&argc, argv);
    if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 1;
    benchmark::RunSpecifiedBenchmarks();
    benchmark::Shutdown();
    return 0;
}

}  // namespace

namespace ragtop::bench {

int run(int argc, char** argv) {
    CLI::App app{
        "Measures Ragtop. Without a subcommand: the micro-benchmarks, with Google Benchmark's options, such as "
        "--benchmark_filter=REGEX",
        "ragtop_bench"};
    app.require_subcommand(0, 1);
    addSubcommands(app);
    app.allow_extras();  // Google Benchmark's
    try {
        app.parse(argc, argv);
    } catch (const CLI::ParseError& error) {
        return app.exit(error);
    } catch (const std::exception& error) {
        std::fprintf(stderr, "ragtop_bench: %s\n", error.what());
        return 2;
    }
    if (app.get_subcommands().empty()) return runBenchmarks(argc, argv);
    return 0;
}

}  // namespace ragtop::bench
