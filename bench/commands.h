#pragma once

#include <CLI/CLI.hpp>

/// The program's subcommands, each in a file of its own. They set the exit code.
namespace ragtop {

void addStabilityCommand(CLI::App& app, int& exitCode);

}  // namespace ragtop
