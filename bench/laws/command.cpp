#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>

#include "../stability/isolation.h"
#include "../subcommands.h"
#include "frames.h"
#include "laws.h"
#include "meddle.h"
#include "shrink.h"

namespace ragtop::laws {
namespace {

using nlohmann::json;

struct Arguments {
    std::vector<std::string> kinds{"all"}, engines{"ragtop"}, laws{"all"};
    std::string seeds = "1..20", out;
    double time = 0;  ///< s; 0: no bound
    bool views = false, restore = false, meddle = false, each = false;
    int jobs = 1;
};

struct Seeds {
    std::uint64_t first = 1, last = 1;
};

Seeds seedsOf(const std::string& text) {
    const std::size_t dots = text.find("..");
    try {
        const std::uint64_t first = std::stoull(text.substr(0, dots));
        const std::uint64_t last = dots == std::string::npos ? first : std::stoull(text.substr(dots + 2));
        if (last < first) throw std::invalid_argument(text);
        return {first, last};
    } catch (const std::logic_error&) {
        throw CLI::ValidationError("--seeds", "\"" + text + "\" is no range such as 1..100");
    }
}

template <class T>
std::vector<const T*> chosen(std::span<const T> all, const std::vector<std::string>& names, const char* option) {
    std::vector<const T*> found;
    for (const std::string& name : names) {
        const std::size_t before = found.size();
        for (const T& one : all)
            if (name == "all" || name == one.name) found.push_back(&one);
        if (found.size() == before) throw CLI::ValidationError(option, "\"" + name + "\" is not known");
    }
    return found;
}

/// One scene of a kind in one engine.
struct Job {
    const Kind* kind;
    const stability::EngineKind* engine;
    std::uint64_t seed;
};

void addNumbers(json& values, const Watched& watched) {
    values.update({{"mean", watched.meanMs}, {"median", watched.medianMs}, {"worst", watched.worstMs}});
    // JSON has no number that is none.
    for (const Law& law : allLaws())
        values[law.name] = std::isfinite(watched.*law.value) ? json(watched.*law.value) : json("none");
}

/// With lengths in metres of the scene, which is what bounds are of.
Watched asInScene(Watched watched, double length) {
    for (double* value : {&watched.gap, &watched.restGap, &watched.moved, &watched.overlap, &watched.restOverlap})
        *value /= length;
    return watched;
}

/// Views in which other laws hold than in the scene itself.
std::vector<std::string> otherVerdicts(const Drawn& drawn, const stability::EngineKind& engine,
                                       const std::vector<std::string>& laws, bool holds) {
    std::vector<std::string> names;
    for (const Seen& view : allViews())
        if ((view.hasCars || drawn.scene.vehicles.empty()) &&
            broken(asInScene(watch(view.from(drawn), engine), view.length), laws).empty() != holds)
            names.push_back(view.name);
    return names;
}

std::string runJob(const Job& job, const Arguments& arguments) {
    const Drawn drawn = draw(*job.kind, job.seed);
    Watched watched;
    const bool meddles = arguments.meddle && job.engine->name == "ragtop";
    try {
        if (!meddles) watched = watch(drawn, *job.engine);
    } catch (const stability::Unsupported& reason) {
        return json{{"unsupported", reason.what()}}.dump();
    }
    if (arguments.restore && job.engine->name == "ragtop") watched.restored = restoresAlike(drawn, job.seed);
    if (meddles) watched.meddled = meddle(drawn, job.seed);
    json found = {{"broken", broken(watched, arguments.laws)}};
    if (!meddles) addNumbers(found, watched);
    if (arguments.views) found["views"] = otherVerdicts(drawn, *job.engine, arguments.laws, found["broken"].empty());
    return found.dump();
}

/// Sums of a kind in an engine.
struct Tally {
    int scenes = 0, failed = 0, unsupported = 0;
    double ms = 0, worstOverMedian = 0, worstMs = 0;
    std::map<std::string, int> laws;  ///< how many scenes break each
    std::map<std::string, double> worst;
    std::vector<std::uint64_t> seeds;  ///< that fail
};

void noteNumbers(Tally& tally, const json& found) {
    tally.ms += found["mean"].get<double>();
    tally.worstMs = std::max(tally.worstMs, found["worst"].get<double>());
    tally.worstOverMedian =
        std::max(tally.worstOverMedian, found["worst"].get<double>() / found["median"].get<double>());
    for (const Law& law : allLaws()) {
        const json& value = found[law.name];
        double& worst = tally.worst[law.name];
        if (!value.is_number())
            worst = std::nan("");
        else if (!(value.get<double>() <= worst) && !std::isnan(worst))
            worst = value.get<double>();
    }
}

void note(Tally& tally, const Job& job, const json& found) {
    if (found.contains("unsupported")) {
        ++tally.unsupported;
        return;
    }
    ++tally.scenes;
    if (found.contains("mean")) noteNumbers(tally, found);
    bool fails = false;
    for (const json& law : found["broken"]) ++tally.laws[law.get<std::string>()], fails = true;
    if (found.contains("views"))
        for (const json& view : found["views"]) ++tally.laws["seen " + view.get<std::string>()], fails = true;
    if (!fails) return;
    ++tally.failed;
    tally.seeds.push_back(job.seed);
}

void print(const std::string& name, const Tally& tally) {
    fmt::print("{:<24} {:>5} of {:<5} fail  {:>8.4f} ms a step, worst {:.2f} ms = {:.1f} × its median\n", name,
               tally.failed, tally.scenes, tally.scenes > 0 ? tally.ms / tally.scenes : 0.0, tally.worstMs,
               tally.worstOverMedian);
    for (const Law& law : allLaws()) {
        if (!tally.worst.contains(law.name)) continue;
        const auto count = tally.laws.find(law.name);
        fmt::print("  {:<22} {:>5}  worst {:.4g} {} (bound {:.4g})\n", law.name,
                   count == tally.laws.end() ? 0 : count->second, tally.worst.at(law.name), law.unit, law.bound);
    }
    for (const auto& law : tally.laws)
        if (std::ranges::none_of(allLaws(), [&](const Law& known) { return known.name == law.first; }))
            fmt::print("  {:<22} {:>5}\n", law.first, law.second);
    if (tally.unsupported > 0) fmt::print("  {} scenes cannot be expressed\n", tally.unsupported);
    if (tally.seeds.empty()) return;
    std::string seeds;
    for (std::size_t i = 0; i < tally.seeds.size() && i < 12; ++i) seeds += " " + std::to_string(tally.seeds[i]);
    fmt::print("  seeds{}{}\n", seeds, tally.seeds.size() > 12 ? " …" : "");
}

/// Writes the first failing scene of a kind, made as small as it can be while it breaks the same law.
void keep(const Kind& kind, const Tally& tally, const stability::EngineKind& engine, const Arguments& arguments) {
    const std::string& folder = arguments.out;
    const Drawn drawn = draw(kind, tally.seeds.front());
    if (!drawn.scene.vehicles.empty()) return;  // no file has them; the seed makes them again
    const std::vector<std::string> laws = broken(watch(drawn, engine), arguments.laws);
    if (laws.empty()) return;
    const Drawn small = shrunk(drawn, [&](const Drawn& scene) {
        const std::vector<std::string> now = broken(watch(scene, engine), arguments.laws);
        return std::ranges::find(now, laws.front()) != now.end();
    });
    std::filesystem::create_directories(folder);
    const std::filesystem::path file = std::filesystem::path(folder) / (drawn.scene.name + ".json");
    saveScene(small.scene, file);
    fmt::print("  {}: {} bodies, {} joints break \"{}\"\n", file.string(), small.scene.bodies.size(),
               small.scene.joints.size(), laws.front());
}

void checkLaws(const std::vector<std::string>& names) {
    for (const std::string& name : names) {
        const bool known = name == "all" || name == kRestoredLaw ||
                           std::ranges::find(kMeddledLaws, name) != kMeddledLaws.end() ||
                           std::ranges::any_of(allLaws(), [&](const Law& law) { return law.name == name; });
        if (!known) throw CLI::ValidationError("--law", "\"" + name + "\" is no law");
    }
}

int runLaws(const Arguments& arguments) {
    const Seeds seeds = seedsOf(arguments.seeds);
    const auto kinds = chosen(allKinds(), arguments.kinds, "--kind");
    const auto engines = chosen(stability::engineKinds(), arguments.engines, "--engine");
    checkLaws(arguments.laws);
    const auto start = std::chrono::steady_clock::now();
    bool failed = false;
    for (const stability::EngineKind* engine : engines)
        for (const Kind* kind : kinds) {
            std::vector<Job> jobs;
            for (std::uint64_t seed = seeds.first; seed <= seeds.last; ++seed) jobs.push_back({kind, engine, seed});
            std::vector<std::function<std::string()>> works;
            for (const Job& job : jobs)
                works.push_back([&, job] {
                    const std::chrono::duration<double> gone = std::chrono::steady_clock::now() - start;
                    const bool late = arguments.time > 0 && gone.count() > arguments.time;
                    return late ? json{{"unsupported", "no time left"}}.dump() : runJob(job, arguments);
                });
            Tally tally;
            stability::runIsolated(works, arguments.jobs, [&](std::size_t i, const stability::Outcome& outcome) {
                if (outcome.death.empty()) {
                    const json found = json::parse(outcome.text);
                    note(tally, jobs[i], found);
                    if (arguments.each) fmt::print("{} {} {}\n", kind->name, jobs[i].seed, outcome.text);
                    return;
                }
                ++tally.scenes, ++tally.failed, ++tally.laws["ends the program: " + outcome.death];
                tally.seeds.push_back(jobs[i].seed);
            });
            print(kind->name + " in " + engine->name, tally);
            failed |= tally.failed > 0;
            if (!arguments.out.empty() && !tally.seeds.empty()) keep(*kind, tally, *engine, arguments);
        }
    return failed ? 1 : 0;
}

void addLaws(CLI::App& app) {
    auto arguments = std::make_shared<Arguments>();
    CLI::App* command =
        app.add_subcommand("laws", "Looks for scenes that break a law of physics; fails when it finds one");
    command->add_option("--kind", arguments->kinds, "Kinds of scenes, or all")->delimiter(',');
    command->add_option("--seeds", arguments->seeds, "FIRST..LAST, or one seed");
    command->add_option("--engine", arguments->engines, "Engines, or all")->delimiter(',');
    command->add_option("--law", arguments->laws, "Laws that count, or all; the others are printed")->delimiter(',');
    command->add_option("--time", arguments->time, "Seconds after which no scene is begun");
    CLI::Option* views =
        command->add_flag("--views", arguments->views, "Also from moving, turned, distant, larger and reversed frames");
    command->add_flag("--restore", arguments->restore, "Also saved and restored at random steps");
    command
        ->add_flag("--meddle", arguments->meddle,
                   "Instead with bodies and joints made, moved, changed and destroyed on the way")
        ->excludes(views);
    command->add_flag("--each", arguments->each, "Print what each scene showed");
    command->add_option("--out", arguments->out,
                        "Write the first failing scene of each kind, made small, into this folder");
    command->add_option("--jobs", arguments->jobs, "Scenes that run at once; times are right for 1 only")
        ->check(CLI::Range(1, 64));
    command->callback([arguments] {
        if (const int code = runLaws(*arguments); code != 0) throw CLI::RuntimeError(code);
    });
}

const bench::Subcommand laws_(addLaws);

}  // namespace
}  // namespace ragtop::laws
