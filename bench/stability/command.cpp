#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <fstream>
#include <memory>
#include <set>

#include "../subcommands.h"
#include "report.h"
#include "suite.h"

namespace ragtop {
namespace {

using namespace stability;

struct Arguments {
    std::vector<std::string> engines{"ragtop"};
    std::string filter, json, records;
    bool brief = false, longer = false, list = false;
    int jobs = 1;
};

SuiteOptions optionsOf(const Arguments& arguments) {
    SuiteOptions options;
    const auto wanted = [&](const std::string& name) {
        return std::ranges::any_of(arguments.engines, [&](const std::string& e) { return e == name || e == "all"; });
    };
    for (const EngineKind& kind : engineKinds())
        if (wanted(kind.name)) options.engines.push_back(&kind);
    try {
        options.filter = std::regex(arguments.filter, std::regex::ECMAScript | std::regex::icase);
    } catch (const std::regex_error& error) {
        throw CLI::ValidationError("--filter", "\"" + arguments.filter + "\" is no regular expression");
    }
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

int runStability(const Arguments& arguments) {
    const SuiteOptions options = optionsOf(arguments);
    if (arguments.list) {
        for (const std::string& name : selectedCases(options)) fmt::print("{}\n", name);
        return 0;
    }
    std::vector<Row> rows;
    fmt::print("{}", tableHead());
    runSuite(options, [&](const std::vector<Row>& more) {
        for (const Row& row : more) fmt::print("{}", tableLine(row));
        std::fflush(stdout);
        rows.insert(rows.end(), more.begin(), more.end());
    });
    if (!arguments.json.empty()) write(arguments.json, toJson(rows));
    std::set<std::string> families;
    for (const Row& row : rows) families.insert(row.family);
    const auto failed = std::ranges::count_if(rows, [](const Row& r) { return !r.pass; });
    const auto ragtopFailed = std::ranges::count_if(rows, [](const Row& r) { return !r.pass && r.engine == "ragtop"; });
    fmt::print("{} rows in {} families, {} fail, {} of them Ragtop's\n", rows.size(), families.size(), failed,
               ragtopFailed);
    return ragtopFailed == 0 ? 0 : 1;
}

void addStability(CLI::App& app) {
    CLI::App* command = app.add_subcommand("stability", "Test accuracy and stability against known answers");
    const auto arguments = std::make_shared<Arguments>();
    std::vector<std::string> names{"all"};
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
    command->add_flag("--list", arguments->list, "Print the names of the cases and run nothing");
    command->callback([arguments] {
        if (const int code = runStability(*arguments); code != 0) throw CLI::RuntimeError(code);
    });
}

const bench::Subcommand stability(addStability);

}  // namespace
}  // namespace ragtop
