#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <fstream>
#include <iterator>
#include <map>
#include <memory>
#include <optional>

#include "../subcommands.h"
#include "ragdoll_costs.h"
#include "ragtop/world.h"
#include "rows.h"

namespace ragtop::speed {
namespace {

/// What no course tells; measured only where it is named.
constexpr const char* kRagdolls = "ragdoll";

struct Arguments {
    std::vector<std::string> scenes;
    std::vector<std::string> engines{"ragtop", "bullet"};
    std::vector<int> threads{1, 2};
    int lanes = 0, runs = 6;
    std::string json, history, newest;
    bool processor = false, list = false;

    bool plays(const std::string& engine) const { return std::ranges::find(engines, engine) != engines.end(); }
    Clock clock() const { return processor ? Clock::processor : Clock::wall; }
};

/// A course or one of its rows; where there is none of that name, the beginning of several courses' names ("scaling").
bool isMeant(const std::string& name, const CourseKind& kind) {
    const auto isNamed = [&](const CourseKind& one) {
        return name == one.name || std::ranges::find(one.rows, name) != one.rows.end();
    };
    if (std::ranges::any_of(courseKinds(), isNamed)) return isNamed(kind);
    return kind.name.starts_with(name + "_");
}

std::vector<std::string> allRows() {
    std::vector<std::string> rows;
    for (const CourseKind& kind : courseKinds()) rows.insert(rows.end(), kind.rows.begin(), kind.rows.end());
    rows.push_back(kRagdolls);
    return rows;
}

std::string whyUnknown(const std::string& name) {
    if (name == kRagdolls ||
        std::ranges::any_of(courseKinds(), [&](const CourseKind& kind) { return isMeant(name, kind); }))
        return {};
    return fmt::format("\"{}\" is no scene, must be one of {}", name, fmt::join(allRows(), ", "));
}

/// The rows of a course while its runs come in.
class Rows {
public:
    Rows(const Course& course, const Arguments& arguments)
        : course_(course),
          arguments_(arguments),
          ragtop_(arguments.plays("ragtop")),
          bullet_(arguments.plays("bullet") && hasBullet()),
          lanes_(World({}, {.lanes = arguments.lanes}).lanes()) {}

    /// Plays the engines in turn, the other way round in every second run: what disturbs one disturbs all, and what
    /// grows warm or slow on the way is as much before as after.
    std::vector<Row> measure() {
        play(Purpose::quality, false);
        for (int run = 0; run < arguments_.runs; ++run) play(Purpose::times, run % 2 == 1);
        std::map<int, std::vector<Row>> byThreads;
        for (Row& row : rows_) byThreads[row.threads].push_back(std::move(row));
        rows_.clear();
        for (auto& [threads, rows] : byThreads) std::ranges::move(rows, std::back_inserter(rows_));
        return std::move(rows_);
    }

private:
    void play(Purpose purpose, bool bulletFirst) {
        std::vector<int> threads = arguments_.threads;
        if (bulletFirst) std::ranges::reverse(threads);
        if (bulletFirst) playTheOther(purpose);
        if (ragtop_)
            for (const int count : threads)
                for (const WindowResult& result : playRagtop(course_, count, lanes_, arguments_.clock(), purpose)) {
                    Row& row = rowOf(result.name, count);
                    row.lanes = lanes_;
                    keep(result, purpose, row.own);
                }
        if (!bulletFirst) playTheOther(purpose);
    }

    void playTheOther(Purpose purpose) {
        if (!bullet_) return;
        const std::vector<WindowResult> results = playBullet(course_, arguments_.clock(), purpose);
        for (const int count : ragtop_ ? arguments_.threads : std::vector<int>{1})
            for (const WindowResult& result : results) keep(result, purpose, rowOf(result.name, count).bullet);
    }

    static void keep(const WindowResult& result, Purpose purpose, Result& into) {
        if (purpose == Purpose::quality) {
            into.quality = result.quality;
            return;
        }
        into.ms.push_back(result.ms);
        into.worstMs.push_back(result.worstMs);
        if (!into.work) into.work = result.work;
    }

    Row& rowOf(const std::string& scene, int threads) {
        const auto isRow = [&](const Row& row) { return row.scene == scene && row.threads == threads; };
        const auto found = std::ranges::find_if(rows_, isRow);
        if (found != rows_.end()) return *found;
        Row& row = rows_.emplace_back();
        row.scene = scene;
        row.threads = threads;
        return row;
    }

    const Course& course_;
    const Arguments& arguments_;
    bool ragtop_, bullet_;
    int lanes_;
    std::vector<Row> rows_;
};

void write(const std::string& path, const std::string& text) {
    std::ofstream file(path, std::ios::binary);
    file << text;
    if (!file.flush()) throw std::runtime_error(path + ": cannot be written");
}

void runRagdolls(const Arguments& arguments) {
    if (arguments.scenes.size() > 1)
        throw std::invalid_argument("--scene ragdoll has rows of its own and stands alone");
    const std::vector<RagdollCost> costs = measureRagdolls(arguments.runs);
    if (!arguments.json.empty()) write(arguments.json, toJson(costs));
}

void runSpeed(const Arguments& arguments) {
    if (arguments.list) return fmt::print("{}\n", fmt::join(allRows(), "\n"));
    if (!arguments.history.empty()) return fmt::print("{}", historyTable(arguments.history));
    if (!arguments.newest.empty()) return fmt::print("{}", newestTable(arguments.newest));
    if (std::ranges::find(arguments.scenes, kRagdolls) != arguments.scenes.end()) return runRagdolls(arguments);
    std::vector<Row> rows;
    fmt::print("{}", tableHead());
    for (const CourseKind& kind : courseKinds()) {
        const auto meant = [&](const std::string& name) { return isMeant(name, kind); };
        if (!arguments.scenes.empty() && std::ranges::none_of(arguments.scenes, meant)) continue;
        const Course course = kind.make();
        for (Row& row : Rows(course, arguments).measure()) {
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
    command->add_option("--runs", arguments->runs, "Of each engine, in turn; medians count")
        ->check(CLI::Range(1, 1000))
        ->capture_default_str();
    command->add_option("--json", arguments->json, "Write the rows to this file");
    command->add_option("--history", arguments->history, "Only print the kept results of this folder as a table")
        ->check(CLI::ExistingDirectory);
    command->add_option("--newest", arguments->newest, "Only print the newest kept result of this folder as a table")
        ->check(CLI::ExistingDirectory);
    command->add_flag("--processor-time", arguments->processor,
                      "Count processor time, which for one thread is right on a busy machine too");
    command->add_flag("--list", arguments->list, "Print the names of the scenes and run nothing");
    command->callback([arguments] { runSpeed(*arguments); });
}

const bench::Subcommand speedCommand(addSpeed);

}  // namespace
}  // namespace ragtop::speed
