#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <fstream>
#include <memory>
#include <set>

#include "../subcommands.h"
#include "red_rows.h"
#include "report.h"
#include "sabotage.h"
#include "suite.h"

namespace ragtop::stability {
namespace {

struct Arguments {
    std::vector<std::string> engines{"ragtop"};
    std::string filter, json, records;
    std::vector<int> rates;
    bool brief = false, longer = false, red = false, list = false;
    int jobs = 1;
};

SuiteOptions optionsOf(const Arguments& arguments) {
    SuiteOptions options;
    const auto wanted = [&](const std::string& name) {
        return std::ranges::any_of(
            arguments.engines, [&](const std::string& e) { return e == name || (e == "all" && name != "saboteurs"); });
    };
    options.sabotaged = wanted("saboteurs");
    if (options.sabotaged && arguments.engines.size() > 1)
        throw CLI::ValidationError("--engine", "saboteurs run without others");
    for (const EngineKind& kind : engineKinds())
        if (wanted(kind.name)) options.engines.push_back(&kind);
    try {
        options.filter = std::regex(arguments.filter, std::regex::ECMAScript | std::regex::icase);
    } catch (const std::regex_error& error) {
        throw CLI::ValidationError("--filter", "\"" + arguments.filter + "\" is no regular expression");
    }
    options.redOnly = arguments.red;
    options.rates = arguments.rates;
    if (arguments.brief) options.selection = Selection::brief;
    if (arguments.longer) options.selection = Selection::longer;
    if (!arguments.records.empty()) {
        std::filesystem::create_directories(arguments.records);
        options.records = arguments.records;
    }
    options.jobs = arguments.jobs;
    return options;
}

void write(const std::string& path, const std::string& text) {
    std::ofstream file(path, std::ios::binary);
    file << text;
    if (!file.flush()) throw std::runtime_error(path + ": cannot be written");
}

std::ptrdiff_t count(const std::vector<Row>& rows, Verdict verdict) {
    return std::ranges::count(rows, verdict, &Row::verdict);
}

bool areAllThere(const Arguments& arguments, const SuiteOptions& options, const std::vector<Row>& rows) {
    const bool isWhole = arguments.filter.empty() && arguments.rates.empty() && !arguments.red;
    if (!isWhole || !std::ranges::count(options.engines, "ragtop", &EngineKind::name)) return true;
    const std::string why = whyTooFew(rows, options.selection);
    if (!why.empty()) fmt::print("{}\n", why);
    return why.empty();
}

/// Prints how many rows hold and the names of those of Ragtop and its saboteurs that do not; true when all do but those
/// that are known not to, and none of these does, or has become worse.
bool conclude(const std::vector<Row>& rows, double seconds) {
    std::set<std::string> families;
    for (const Row& row : rows) families.insert(row.family);
    std::vector<Row> failed, red, worse, cured;
    for (const Row& row : rows) {
        const bool fails = row.verdict == Verdict::fails;
        const RedRow* known = redRowOf(row);
        if (known && row.verdict != Verdict::skipped)
            (!fails ? cured : isWorse(row, *known) ? worse : red).push_back(row);
        else if (fails && (row.engine == "ragtop" || row.engine == "saboteurs"))
            failed.push_back(row);
    }
    fmt::print(
        "{} rows in {} families, {} skipped, {} fail, {} of them Ragtop's, {} of these known; {:.0f} s of processor "
        "time\n",
        rows.size(), families.size(), count(rows, Verdict::skipped), count(rows, Verdict::fails),
        failed.size() + red.size() + worse.size(), red.size() + worse.size(), seconds);
    for (const Row& row : red) fmt::print("red: {}/{} {}\n", row.family, row.name, row.note);
    for (const Row& row : worse)
        fmt::print("red, and worse: {}/{}, off by {:.2g}, {:.2g} is known\n", row.family, row.name,
                   std::abs(row.value - row.reference), redRowOf(row)->off);
    for (const Row& row : failed) fmt::print("fails: {}/{} {}\n", row.family, row.name, row.note);
    for (const Row& row : cured) fmt::print("holds, and is no longer red: {}/{}\n", row.family, row.name);
    return failed.empty() && worse.empty() && cured.empty();
}

int runStability(const Arguments& arguments) {
    const SuiteOptions options = optionsOf(arguments);
    if (arguments.list) {
        for (const std::string& name : selectedCases(options)) fmt::print("{}\n", name);
        return 0;
    }
    std::vector<Row> rows;
    fmt::print("{}", tableHead());
    const double seconds = runSuite(options, [&](const std::vector<Row>& more) {
        for (const Row& row : more) fmt::print("{}", tableLine(row));
        std::fflush(stdout);
        rows.insert(rows.end(), more.begin(), more.end());
    });
    if (!arguments.json.empty()) write(arguments.json, toJson(rows));
    if (options.sabotaged) fmt::print("\n{}\n", saboteurTable(rows));
    const bool holds = conclude(rows, seconds);
    return areAllThere(arguments, options, rows) && holds ? 0 : 1;
}

void addStability(CLI::App& app) {
    CLI::App* command = app.add_subcommand("stability", "Test accuracy and stability against known answers");
    const auto arguments = std::make_shared<Arguments>();
    std::vector<std::string> names{"all", "saboteurs"};
    for (const EngineKind& kind : engineKinds()) names.push_back(kind.name);
    command->add_option("--engine", arguments->engines, "Engines to test")->check(CLI::IsMember(names))->delimiter(',');
    command->add_option("--filter", arguments->filter,
                        "Only cases whose \"family/case\" this regular expression finds");
    command->add_option("--json", arguments->json, "Write the rows to this file");
    command->add_option("--record", arguments->records, "Write a .glb of each run into this folder");
    command->add_option("--jobs", arguments->jobs, "Cases that run at once; times are right for 1 only")
        ->check(CLI::Range(1, 64));
    CLI::Option* longer = command->add_flag("--long", arguments->longer, "Also other steps, ensembles and long drifts");
    command->add_flag("--short", arguments->brief, "Only what the tests run")->excludes(longer);
    command->add_flag("--red", arguments->red, "Only cases with rows that are known to fail");
    command->add_option("--rates", arguments->rates, "Steps a second at which every case runs, instead of 60")
        ->check(CLI::Range(15, 960))
        ->delimiter(',')
        ->excludes(longer);
    command->add_flag("--list", arguments->list, "Print the names of the cases and run nothing");
    command->callback([arguments] {
        if (const int code = runStability(*arguments); code != 0) throw CLI::RuntimeError(code);
    });
}

const bench::Subcommand stability(addStability);

}  // namespace
}  // namespace ragtop::stability
