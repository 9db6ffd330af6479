#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <fstream>
#include <memory>
#include <optional>

#include "../subcommands.h"
#include "ragtop/world.h"
#include "rows.h"

namespace ragtop {
namespace {

using namespace speed;

struct Arguments {
    std::vector<std::string> scenes;
    std::vector<std::string> engines{"ragtop", "bullet"};
    std::vector<int> threads{1, 2};
    int lanes = 0, runs = 4;
    std::string json, history;
    bool processor = false, list = false;

    bool plays(const std::string& engine) const { return std::ranges::find(engines, engine) != engines.end(); }
    Clock clock() const { return processor ? Clock::processor : Clock::wall; }
};

/// A course, one of its rows, or the beginning of several courses' names ("scaling").
bool isMeant(const std::string& name, const CourseKind& kind) {
    return name == kind.name || kind.name.starts_with(name + "_") ||
           std::ranges::find(kind.rows, name) != kind.rows.end();
}

std::vector<std::string> allRows() {
    std::vector<std::string> rows;
    for (const CourseKind& kind : courseKinds()) rows.insert(rows.end(), kind.rows.begin(), kind.rows.end());
    return rows;
}

std::string whyUnknown(const std::string& name) {
    if (std::ranges::any_of(courseKinds(), [&](const CourseKind& kind) { return isMeant(name, kind); })) return {};
    return fmt::format("\"{}\" is no scene, must be one of {}", name, fmt::join(allRows(), ", "));
}

void keepFastest(std::optional<double>& best, double ms) { best = best ? std::min(*best, ms) : ms; }

/// Plays the engines in turn, so that what disturbs one disturbs all.
std::vector<Row> measure(const Course& course, const Arguments& arguments) {
    std::vector<Row> rows;
    const auto keep = [&](const std::vector<WindowResult>& results, int threads, const auto& into) {
        for (const WindowResult& result : results) {
            const auto isRow = [&](const Row& row) { return row.scene == result.name && row.threads == threads; };
            auto row = std::ranges::find_if(rows, isRow);
            if (row == rows.end()) {
                rows.emplace_back();
                row = rows.end() - 1;
                row->scene = result.name;
                row->threads = threads;
                row->quality = result.quality;
                row->work = result.work;
            }
            into(*row, result.ms);
        }
    };
    const bool ragtop = arguments.plays("ragtop"), bullet = arguments.plays("bullet") && hasBullet();
    const int lanes = World({}, {.lanes = arguments.lanes}).lanes();
    for (int run = 0; run < arguments.runs; ++run) {
        for (const int threads : ragtop ? arguments.threads : std::vector<int>{})
            keep(playRagtop(course, threads, lanes, arguments.clock()), threads, [&](Row& row, double ms) {
                row.lanes = lanes;
                keepFastest(row.ms, ms);
            });
        if (!bullet) continue;
        const std::vector<WindowResult> results = playBullet(course, arguments.clock());
        for (const int threads : ragtop ? arguments.threads : std::vector<int>{1})
            keep(results, threads, [](Row& row, double ms) { keepFastest(row.bulletMs, ms); });
    }
    std::ranges::stable_sort(rows, {}, &Row::threads);
    return rows;
}

void write(const std::string& path, const std::string& text) {
    std::ofstream file(path, std::ios::binary);
    file << text;
    if (!file.flush()) throw std::runtime_error(path + ": cannot be written");
}

void runSpeed(const Arguments& arguments) {
    if (arguments.list) return fmt::print("{}\n", fmt::join(allRows(), "\n"));
    if (!arguments.history.empty()) return fmt::print("{}", historyTable(arguments.history));
    std::vector<Row> rows;
    fmt::print("{}", tableHead());
    for (const CourseKind& kind : courseKinds()) {
        const auto meant = [&](const std::string& name) { return isMeant(name, kind); };
        if (!arguments.scenes.empty() && std::ranges::none_of(arguments.scenes, meant)) continue;
        for (Row& row : measure(kind.make(), arguments)) {
            fmt::print("{}", tableLine(row));
            std::fflush(stdout);
            rows.push_back(std::move(row));
        }
    }
    if (!arguments.json.empty()) write(arguments.json, toJson(rows));
}

void addSpeed(CLI::App& app) {
    CLI::App* command = app.add_subcommand("speed", "Time whole scenes beside Bullet");
    const auto arguments = std::make_shared<Arguments>();
    command->add_option("--scene", arguments->scenes, "Scenes, or how their names begin; all where none is given")
        ->check(CLI::Validator(whyUnknown, "SCENE"))
        ->delimiter(',');
    command->add_option("--engine", arguments->engines, "Engines to time")
        ->check(CLI::IsMember({"ragtop", "bullet"}))
        ->delimiter(',');
    command->add_option("--threads", arguments->threads, "Numbers of threads, one row each; Bullet has one")
        ->check(CLI::Range(1, 64))
        ->delimiter(',')
        ->capture_default_str();
    command->add_option("--lanes", arguments->lanes, "Width of Ragtop's solver; 0: the machine's best")
        ->check(CLI::IsMember({0, 4, 8, 16}));
    command->add_option("--runs", arguments->runs, "Of each engine, in turn; the fastest counts")
        ->check(CLI::Range(1, 1000))
        ->capture_default_str();
    command->add_option("--json", arguments->json, "Write the rows to this file");
    command->add_option("--history", arguments->history, "Only print the kept results of this folder as a table")
        ->check(CLI::ExistingDirectory);
    command->add_flag("--processor-time", arguments->processor,
                      "Count processor time, which for one thread is right on a busy machine too");
    command->add_flag("--list", arguments->list, "Print the names of the scenes and run nothing");
    command->callback([arguments] { runSpeed(*arguments); });
}

const bench::Subcommand speedCommand(addSpeed);

}  // namespace
}  // namespace ragtop
