#include "suite.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <limits>
#include <set>
#include <stdexcept>

#include "brief_cases.h"
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

bool isSelected(const Family& family, const Case& test, Selection selection) {
    if (selection == Selection::brief) return std::ranges::count(kBriefCases, family.name + "/" + test.name) > 0;
    return test.kind != Kind::longer || selection == Selection::longer;
}

void addJobs(const Family& family, const Case& test, const SuiteOptions& options, std::vector<Job>& jobs) {
    if (!isSelected(family, test, options.selection)) return;
    for (const EngineKind* engine : options.engines) {
        if (test.kind == Kind::ragtopOnly && engine->make != makeRagtop) continue;
        const auto addJob = [&](double dt, const std::string& name) {
            if (std::regex_search(family.name + "/" + name, options.filter))
                jobs.push_back({&test, {family.name, name, engine, dt, options.records}});
        };
        addJob(kStep, test.name);
        if (options.selection != Selection::longer || test.kind != Kind::swept) continue;
        for (const int rate : kOtherSteps) addJob(1.0 / rate, fmt::format("{} @ 1/{} s", test.name, rate));
    }
}

/// A name that no case has any more would drop a test silently.
void checkBriefCases(const std::vector<Family>& families) {
    std::set<std::string, std::less<>> names;
    for (const Family& family : families)
        for (const Case& test : family.cases) names.insert(family.name + "/" + test.name);
    for (const std::string_view name : kBriefCases)
        if (!names.contains(name)) throw std::logic_error(fmt::format("brief_cases.h: there is no case {}", name));
}

std::vector<Job> jobsOf(const std::vector<Family>& families, const SuiteOptions& options) {
    checkBriefCases(families);
    std::vector<Job> jobs;
    for (const Family& family : families)
        for (const Case& test : family.cases) addJobs(family, test, options, jobs);
    return jobs;
}

Row rowOfFailure(const Trial::Setting& setting, const std::string& what) {
    constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
    return {setting.family, setting.name, setting.engine->name, kNone, 0, 0, "", false, 0, what};
}

/// Empty when the engine cannot represent the case.
std::vector<Row> runJob(const Job& job) {
    Trial trial(job.setting);
    try {
        job.test->run(trial);
    } catch (const Unsupported&) {
        return {};
    } catch (const std::exception& error) {
        return {rowOfFailure(job.setting, error.what())};
    }
    return trial.rows();
}

}  // namespace

void runSuite(const SuiteOptions& options, const std::function<void(const std::vector<Row>&)>& report) {
    const std::vector<Family> families = allFamilies();
    const std::vector<Job> jobs = jobsOf(families, options);
    std::vector<std::function<std::string()>> works;
    for (const Job& job : jobs) works.push_back([&job] { return toJson(runJob(job)); });
    runIsolated(works, options.jobs, [&](std::size_t i, const Outcome& outcome) {
        report(outcome.death.empty() ? rowsFromJson(outcome.text)
                                     : std::vector{rowOfFailure(jobs[i].setting, outcome.death)});
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
