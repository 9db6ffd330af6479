#pragma once

namespace CLI {
class App;
}

namespace ragtop::bench {

/// A measurement that is more than a benchmark's loop. A file with one at namespace scope adds it to the program.
struct Subcommand {
    /// `add` adds the subcommand, whose callback measures and prints.
    explicit Subcommand(void (*add)(CLI::App&));
};

void addSubcommands(CLI::App& app);

}  // namespace ragtop::bench
