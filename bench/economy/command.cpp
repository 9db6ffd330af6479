#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cmath>
#include <fstream>
#include <memory>
#include <nlohmann/json.hpp>
#include <vector>

#include "../speed/rows.h"
#include "../stability/isolation.h"
#include "../subcommands.h"
#include "base/economy.h"
#include "mixed_scene.h"

namespace ragtop {
namespace economy_bench {
namespace {

using Json = nlohmann::ordered_json;

/// One thing that a step saves, switched off.
struct Saving {
    const char* name;
    void (*switchOff)(WorldSettings&);
};

constexpr Saving kNothing{"nothing", [](WorldSettings&) {}};
constexpr Saving kSavings[] = {
    {"sleeping", [](WorldSettings& settings) { settings.sleeping = false; }},
    {"frozen bodies", [](WorldSettings&) { economy.freezing = false; }},
    {"manifold reuse", [](WorldSettings&) { economy.manifoldReuse = false; }},
    {"islands", [](WorldSettings&) { economy.islands = false; }},
    {"choice of solver: all direct", [](WorldSettings& settings) { settings.solver = SolverChoice::direct; }},
    {"choice of solver: all by iteration", [](WorldSettings& settings) { settings.solver = SolverChoice::iterative; }},
    {"choices only where edges change", [](WorldSettings&) { economy.seldomChoices = false; }},
    {"zero-iteration exit", [](WorldSettings&) { economy.zeroIterations = false; }},
    {"calm trees", [](WorldSettings&) { economy.calmTrees = false; }},
    {"independent trees", [](WorldSettings&) { economy.independentTrees = false; }},
};
constexpr Saving kAll{"everything", [](WorldSettings& settings) {
                          for (const Saving& saving : kSavings) saving.switchOff(settings);
                          settings.solver = SolverChoice::automatic;
                      }};

std::vector<Saving> allSavings() {
    std::vector<Saving> all{kNothing};
    all.insert(all.end(), std::begin(kSavings), std::end(kSavings));
    all.push_back(kAll);
    return all;
}

struct Arguments {
    int runs = 5;
    std::string json, table;
};

/// In a process of its own, which has its own switches.
Json played(const Saving& saving, bool measured) {
    Json result;
    const auto work = [&] {
        WorldSettings settings;
        saving.switchOff(settings);
        const Played played = playMixedScene(settings, measured);
        return Json{{"ms", played.ms}, {"figures", played.figures}}.dump();
    };
    stability::runIsolated({work}, 1, [&](std::size_t, const stability::Outcome& outcome) {
        if (!outcome.death.empty())
            throw std::runtime_error(fmt::format("the scene without {} ends: {}", saving.name, outcome.death));
        result = Json::parse(outcome.text);
    });
    return result;
}

/// Runs of all savings in turn, so that what disturbs one disturbs all; ratios are made run by run.
Json measure(int runs) {
    const std::vector<Saving> savings = allSavings();
    std::vector<std::vector<double>> ms(savings.size());
    Json rows = Json::array();
    for (const Saving& saving : savings) rows.push_back({{"off", saving.name}});
    for (int run = 0; run < runs; ++run)
        for (std::size_t i = 0; i < savings.size(); ++i) ms[i].push_back(played(savings[i], false)["ms"]);
    for (std::size_t i = 0; i < savings.size(); ++i) {
        std::vector<double> ratios;
        for (std::size_t run = 0; run < ms[i].size(); ++run) ratios.push_back(ms[i][run] / ms[0][run]);
        const speed::Median ratio = *speed::medianOf(ratios);
        rows[i]["ms"] = speed::medianOf(ms[i])->value;
        rows[i]["ratio"] = {ratio.value, ratio.lower, ratio.upper};
        rows[i]["figures"] = played(savings[i], true)["figures"];
    }
    return rows;
}

std::string tableOf(const Json& rows) {
    std::string text = "| Switched off | ms/s | Cost | Interval |", line = "|---|---|---|---|",
                bounds = "| *bound* | | | |";
    for (const Figure& figure : kFigures) {
        text += fmt::format(" {}, {} |", figure.name, figure.unit);
        line += "---|";
        bounds += std::isfinite(figure.bound) ? fmt::format(" *{:g}* |", figure.bound) : " – |";
    }
    text += "\n" + line + "\n" + bounds + "\n";
    for (const Json& row : rows) {
        const Json& ratio = row.at("ratio");
        text += fmt::format("| {} | {:.1f} | {:.2f} | {:.2f}–{:.2f} |", row.at("off").get<std::string>(),
                            row.at("ms").get<double>(), ratio.at(0).get<double>(), ratio.at(1).get<double>(),
                            ratio.at(2).get<double>());
        for (std::size_t i = 0; i < kFigures.size(); ++i) {
            const Json& value = row.at("figures").at(i);
            // A number that JSON has no word for is none.
            const double figure = value.is_number() ? value.get<double>() : INFINITY;
            text +=
                figure > kFigures[i].bound ? fmt::format(" **{:.2g}** |", figure) : fmt::format(" {:.2g} |", figure);
        }
        text += "\n";
    }
    return text;
}

Json read(const std::string& path) {
    std::ifstream stream(path, std::ios::binary);
    if (!stream) throw std::runtime_error(path + ": cannot be read");
    try {
        return Json::parse(stream);
    } catch (const Json::exception& error) {
        throw std::runtime_error(fmt::format("{}: {}", path, error.what()));
    }
}

void runEconomy(const Arguments& arguments) {
    if (!arguments.table.empty()) {
        const Json rows = read(arguments.table);
        try {
            fmt::print("{}", tableOf(rows));
        } catch (const Json::exception& error) {
            throw std::runtime_error(fmt::format("{}: is no result of --json: {}", arguments.table, error.what()));
        }
        return;
    }
    const Json rows = measure(arguments.runs);
    fmt::print("{}", tableOf(rows));
    if (arguments.json.empty()) return;
    std::ofstream file(arguments.json, std::ios::binary);
    file << rows.dump(1) << '\n';
    if (!file.flush()) throw std::runtime_error(arguments.json + ": cannot be written");
}

void addEconomy(CLI::App& app) {
    CLI::App* command =
        app.add_subcommand("economy", "What each thing that a step leaves out saves, and what it changes");
    const auto arguments = std::make_shared<Arguments>();
    command->add_option("--runs", arguments->runs, "Of each, in turn; medians count")
        ->check(CLI::Range(1, 1000))
        ->capture_default_str();
    command->add_option("--json", arguments->json, "Write the rows to this file");
    command->add_option("--table", arguments->table, "Print the table of such a file and measure nothing");
    command->callback([arguments] { runEconomy(*arguments); });
}

const bench::Subcommand economyCommand(addEconomy);

}  // namespace
}  // namespace economy_bench
}  // namespace ragtop
