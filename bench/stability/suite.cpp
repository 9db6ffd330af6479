#include "suite.h"

#include <fmt/format.h>

#include <array>
#include <limits>

#include "families.h"
#include "isolation.h"
#include "report.h"

namespace ragtop::stability {
namespace {

constexpr double kStep = 1.0 / 60;
/// The sweep of --long, beside the standard step.
constexpr std::array kOtherSteps{15, 30, 120, 240};

struct Job {
    const Case* test;
    Trial::Setting setting;
};

void addJobs(const Family& family, const Case& test, const SuiteOptions& options, std::vector<Job>& jobs) {
    if (test.selection > options.selection) return;
    for (const EngineKind* engine : options.engines) {
        if (test.ragtopOnly && engine->make != makeRagtop) continue;
        const bool longer = options.selection == Selection::longer;
        const Trial::Setting setting{family.name, test.name, engine, kStep, longer, options.records};
        const auto addJob = [&](const Trial::Setting& s) {
            if (std::regex_search(s.family + "/" + s.name, options.filter)) jobs.push_back({&test, s});
        };
        addJob(setting);
        if (!longer || !test.swept) continue;
        for (const int rate : kOtherSteps) {
            Trial::Setting other = setting;
            other.dt = 1.0 / rate;
            other.name += fmt::format(" @ 1/{} s", rate);
            addJob(other);
        }
    }
}

std::vector<Job> jobsOf(const std::vector<Family>& families, const SuiteOptions& options) {
    std::vector<Job> jobs;
    for (const Family& family : families)
        for (const Case& test : family.cases) addJobs(family, test, options, jobs);
    return jobs;
}

/// Empty when the engine cannot represent the case.
std::vector<Row> runJob(const Job& job) {
    Trial trial(job.setting);
    try {
        job.test->run(trial);
    } catch (const Unsupported&) {
        return {};
    }
    return trial.rows();
}

Row rowOfDeath(const Trial::Setting& setting, const std::string& death) {
    constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
    return {setting.family, setting.name + ": " + death, setting.engine->name, kNone, 0, 0, "", false, 0};
}

}  // namespace

void runSuite(const SuiteOptions& options, const std::function<void(const std::vector<Row>&)>& report) {
    const std::vector<Family> families = allFamilies();
    const std::vector<Job> jobs = jobsOf(families, options);
    std::vector<std::function<std::string()>> works;
    for (const Job& job : jobs) works.push_back([&job] { return toJson(runJob(job)); });
    runIsolated(works, options.jobs, [&](std::size_t i, const Outcome& outcome) {
        report(outcome.death.empty() ? rowsFromJson(outcome.text)
                                     : std::vector{rowOfDeath(jobs[i].setting, outcome.death)});
    });
}

std::vector<std::string> selectedCases(const SuiteOptions& options) {
    const std::vector<Family> families = allFamilies();
    std::vector<std::string> names;
    for (const Job& job : jobsOf(families, options)) {
        std::string name = job.setting.family + "/" + job.setting.name;
        if (names.empty() || names.back() != name) names.push_back(std::move(name));
    }
    return names;
}

}  // namespace ragtop::stability
