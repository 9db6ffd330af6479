#include <benchmark/benchmark.h>
#include <fmt/format.h>

#include <exception>
#include <vector>

#include "commands.h"

namespace {

/// Google Benchmark reads its own options.
void runBenchmarks(const char* program, std::vector<std::string> options) {
    options.insert(options.begin(), program);
    std::vector<char*> arguments;
    for (std::string& option : options) arguments.push_back(option.data());
    int count = static_cast<int>(arguments.size());
    benchmark::Initialize(&count, arguments.data());
    benchmark::RunSpecifiedBenchmarks();
}

}  // namespace

int main(int argc, char** argv) {
    CLI::App app{"Measures Ragtop: without a command its speed, with --benchmark_ options", "ragtop_bench"};
    app.allow_extras();
    app.require_subcommand(0, 1);
    int exitCode = 0;
    ragtop::addStabilityCommand(app, exitCode);
    try {
        app.parse(argc, argv);
        if (app.get_subcommands().empty()) runBenchmarks(argv[0], app.remaining());
    } catch (const CLI::ParseError& error) {
        return app.exit(error);
    } catch (const std::exception& error) {
        fmt::print(stderr, "ragtop_bench: {}\n", error.what());
        return 2;
    }
    return exitCode;
}
