#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <memory>

#include "../subcommands.h"
#include "csv.h"
#include "draw.h"
#include "findings.h"
#include "plan.h"
#include "programs.h"

namespace ragtop::chart {
namespace {

struct Arguments {
    std::vector<std::string> scenes, engines, programs;
    std::string out = "out/chart", point, draw, renew, losses, cheapest, findings;
    bool quick = false, longer = false, resume = false, again = false, list = false, sceneTable = false;
    int jobs = 1, repeats = 0;
    double limit = 0, patience = 10;
    std::uint64_t seed = 1;
};

Effort effortOf(const Arguments& arguments) {
    if (arguments.quick) return Effort::quick;
    return arguments.longer ? Effort::longer : Effort::normal;
}

std::string namesOf(const auto& all) {
    std::string names;
    for (const auto& each : all) names += (names.empty() ? "" : ", ") + each.name;
    return names;
}

std::vector<const ChartScene*> scenesOf(const Arguments& arguments) {
    std::vector<const ChartScene*> scenes;
    for (const ChartScene& scene : allScenes())
        if (arguments.scenes.empty() ? !arguments.quick || scene.quick
                                     : std::ranges::count(arguments.scenes, scene.name) > 0)
            scenes.push_back(&scene);
    for (const std::string& name : arguments.scenes)
        if (std::ranges::find(allScenes(), name, &ChartScene::name) == allScenes().end())
            throw CLI::ValidationError(
                "--scenes", fmt::format("\"{}\" is no scene, must be one of {}", name, namesOf(allScenes())));
    return scenes;
}

/// Those of programs, which live as long as this program.
const std::vector<Variant>& programsOf(const Arguments& arguments) {
    static const std::vector<Variant> programs = [&] {
        std::vector<Variant> all;
        for (const std::string& command : arguments.programs)
            all.push_back(programVariant(command, arguments.patience));
        return all;
    }();
    return programs;
}

/// An engine's name stands for all its variants; programs take part without being named.
std::vector<const Variant*> variantsOf(const Arguments& arguments) {
    std::vector<const Variant*> variants;
    const auto isAsked = [&](const Variant& variant) {
        if (arguments.engines.empty()) return !arguments.quick || variant.quick;
        return std::ranges::any_of(
            arguments.engines, [&](const std::string& name) { return name == variant.name || name == variant.engine; });
    };
    for (const Variant& variant : allVariants())
        if (isAsked(variant)) variants.push_back(&variant);
    for (const std::string& name : arguments.engines)
        if (std::ranges::none_of(allVariants(), [&](const Variant& v) { return v.name == name || v.engine == name; }))
            throw CLI::ValidationError(
                "--engines", fmt::format("\"{}\" is no engine, must be one of {}", name, namesOf(allVariants())));
    for (const Variant& variant : programsOf(arguments)) variants.push_back(&variant);
    return variants;
}

SweepOptions optionsOf(const Arguments& arguments) {
    constexpr int kRepeats[] = {3, 3, 9};
    constexpr double kLimits[] = {20, 20, 300};
    const auto effort = static_cast<std::size_t>(effortOf(arguments));
    SweepOptions options;
    options.measure = {arguments.seed, arguments.repeats > 0 ? arguments.repeats : kRepeats[effort]};
    options.limit = arguments.limit > 0 ? arguments.limit : kLimits[effort];
    options.jobs = arguments.jobs;
    options.resume = arguments.resume;
    options.again = arguments.again;
    return options;
}

void print(const Point& point) {
    const auto text = [](double value) {
        return std::isfinite(value) ? fmt::format("{:10.3g}", value) : fmt::format("{:>10}", "-");
    };
    const char* outcome = point.outcome == Outcome::measured ? ""
                          : point.outcome == Outcome::failed ? "fails: "
                                                             : "skipped: ";
    fmt::print("{:<48} error {} ms/s {} {}{}{}\n", point.key(), text(point.error), text(point.cpuMs),
               point.alone ? "" : "shared ", outcome, point.reason);
    std::fflush(stdout);
}

/// The CSV, and what can be drawn of it: the page needs its template, the picture node.
void write(const Points& points, const std::filesystem::path& folder) {
    const std::filesystem::path csv = folder / "chart.csv", page = folder / "chart.html",
                                picture = folder / "chart.svg";
    writeWhole(csv, toCsv(points));
    fmt::print("{}\n", csv.string());
    drawPage(points, page);
    fmt::print("{}\n", page.string());
    const std::string why = drawPicture(page, picture);
    fmt::print("{}\n", why.empty() ? picture.string() : "no picture: " + why);
}

void makeFolder(const std::filesystem::path& folder) {
    std::error_code code;
    std::filesystem::create_directories(folder, code);
    if (code) throw std::runtime_error(fmt::format("{}: cannot be made: {}", folder.string(), code.message()));
}

/// A point of any effort by its key.
Points measureOne(const Arguments& arguments) {
    Arguments all = arguments;
    all.longer = true;
    const SweepOptions options = optionsOf(arguments);
    for (const Effort effort : {Effort::quick, Effort::normal, Effort::longer}) {
        std::vector<Task> tasks = plan(scenesOf(all), variantsOf(all), effort, options.measure);
        std::erase_if(tasks, [&](const Task& task) { return task.point.key() != arguments.point; });
        if (!tasks.empty()) return sweep(tasks, options, print);
    }
    throw CLI::ValidationError("--point",
                               fmt::format("\"{}\" is no point, must be like stopping/ragtop@60x4i0", arguments.point));
}

/// A sweep that is kept, in which some points are to be measured anew: all of these must be in it.
Points keptSweep(const std::string& file, const std::vector<Task>& tasks) {
    Points kept = readCsv(file);
    for (const Task& task : tasks)
        if (std::ranges::find(kept, task.point.key(), &Point::key) == kept.end())
            throw std::runtime_error(fmt::format("{}: has no point {}", file, task.point.key()));
    return kept;
}

/// What was measured, in its places among the points of a sweep that is kept.
Points renewed(Points kept, const Points& measured) {
    for (const Point& point : measured) *std::ranges::find(kept, point.key(), &Point::key) = point;
    return kept;
}

/// Others are not left waiting, however this ends.
struct Dismissal {
    const Ranks& ranks;
    ~Dismissal() { ranks.dismiss(); }
};

int runChart(const Arguments& arguments) {
    if (!arguments.losses.empty()) return fmt::print("{}", lossTable(readCsv(arguments.losses))), 0;
    if (!arguments.cheapest.empty()) return fmt::print("{}", cheapestTable(readCsv(arguments.cheapest))), 0;
    if (!arguments.findings.empty()) return fmt::print("{}", findingsTable(readCsv(arguments.findings))), 0;
    if (arguments.sceneTable) return fmt::print("{}", sceneTable()), 0;
    if (!arguments.draw.empty()) {
        Points points = readCsv(arguments.draw);
        if (!arguments.scenes.empty()) {
            const std::vector<const ChartScene*> drawn = scenesOf(arguments);
            std::erase_if(points, [&](const Point& point) {
                return std::ranges::none_of(drawn, [&](const ChartScene* scene) { return scene->name == point.scene; });
            });
        }
        makeFolder(arguments.out);
        write(points, arguments.out);
        return 0;
    }
    if (!arguments.point.empty()) {
        fmt::print("{}", toCsv(measureOne(arguments)));
        return 0;
    }
    SweepOptions options = optionsOf(arguments);
    const std::vector<Task> tasks =
        plan(scenesOf(arguments), variantsOf(arguments), effortOf(arguments), options.measure);
    if (arguments.list) {
        for (const Task& task : tasks) fmt::print("{}\n", task.point.key());
        return 0;
    }
    const Ranks ranks;
    if (!ranks.isFirst()) {
        ranks.serve([&](std::size_t i) { return measureTask(tasks[i], options.measure); }, options.limit);
        return 0;
    }
    if (ranks.count() > 1) options.ranks = &ranks;
    const Dismissal dismissal{ranks};
    const Points kept = arguments.renew.empty() ? Points{} : keptSweep(arguments.renew, tasks);
    makeFolder(arguments.out);
    options.journal = std::filesystem::path(arguments.out) / "journal";
    Points points = sweep(tasks, options, print);
    if (!kept.empty()) points = renewed(kept, points);
    addSelfConsistency(points);
    const auto count = [&](Outcome outcome) { return std::ranges::count(points, outcome, &Point::outcome); };
    fmt::print("{} points, {} of them failed, {} that an engine cannot represent\n", points.size(),
               count(Outcome::failed), count(Outcome::unsupported));
    write(points, arguments.out);
    return 0;
}

void addChart(CLI::App& app) {
    CLI::App* command = app.add_subcommand("chart", "Chart what engines cost against what they get wrong");
    const auto a = std::make_shared<Arguments>();
    command->add_option("--scenes", a->scenes, "Scenes to draw; all of them")->delimiter(',');
    command->add_option("--engines", a->engines, "Engines, or variants of them; all of them")->delimiter(',');
    CLI::Option* quick = command->add_flag("--quick", a->quick, "Three scenes in five minutes");
    command->add_flag("--long", a->longer, "More steps and repeats")->excludes(quick);
    command->add_option("--engine-command", a->programs, "A program that speaks the protocol; may be given again");
    command->add_option("--patience", a->patience, "Seconds that an answer of such a program may take")
        ->check(CLI::Range(0.1, 3600.0));
    command->add_flag("--resume", a->resume, "Go on with the journal of a sweep that ended early");
    command->add_flag("--again", a->again, "With --resume, measure anew what other processes disturbed")
        ->needs("--resume");
    command->add_option("--out", a->out, "Folder for chart.csv, chart.html, chart.svg and the journal")
        ->capture_default_str();
    command->add_option("--jobs", a->jobs, "Points measured at once; none of them is timed then")
        ->check(CLI::Range(1, 64));
    command->add_option("--repeats", a->repeats, "Runs of each point; 1: without an interval of its time")
        ->check(CLI::Range(1, 1000));
    command->add_option("--limit", a->limit, "Seconds of processor time for a point")->check(CLI::Range(1.0, 86400.0));
    command->add_option("--seed", a->seed, "Of the perturbations of repeats");
    command->add_option("--point", a->point, "Measure this point alone and print it");
    command->add_flag("--list", a->list, "Print the points and measure nothing");
    command->add_option("--draw", a->draw, "Draw this CSV, or the scenes named of it, and measure nothing");
    command->add_option("--renew", a->renew, "Measure the points asked for, and keep the others of this CSV");
    command->add_flag("--scene-table", a->sceneTable, "Print the table of scenes");
    command->add_option("--losses", a->losses, "Print the table of where Ragtop loses in this CSV");
    command->add_option("--findings", a->findings, "Print the table of what others have published, seen in this CSV");
    command->add_option("--cheapest", a->cheapest, "Print the table of cheapest settings of this CSV");
    command->callback([a] {
        if (const int code = runChart(*a); code != 0) throw CLI::RuntimeError(code);
    });
}

const bench::Subcommand chartCommand(addChart);

}  // namespace
}  // namespace ragtop::chart
