#include "subcommands.h"

#include <vector>

namespace ragtop::bench {

namespace {

std::vector<void (*)(CLI::App&)>& all() {
    static std::vector<void (*)(CLI::App&)> subcommands;
    return subcommands;
}

}  // namespace

Subcommand::Subcommand(void (*add)(CLI::App&)) { all().push_back(add); }

void addSubcommands(CLI::App& app) {
    for (const auto add : all()) add(app);
}

}  // namespace ragtop::bench
