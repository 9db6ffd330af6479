#include "suite.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <future>
#include <thread>

#include "families.h"

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

std::vector<Row> runJob(const Job& job) {
    Trial trial(job.setting);
    try {
        job.test->run(trial);
    } catch (const Unsupported&) {
        return {};
    }
    return trial.rows();
}

}  // namespace

void runSuite(const SuiteOptions& options, const std::function<void(const std::vector<Row>&)>& report) {
    const std::vector<Family> families = allFamilies();
    const std::vector<Job> jobs = jobsOf(families, options);
    std::vector<std::promise<std::vector<Row>>> results(jobs.size());
    std::atomic<std::size_t> next = 0;
    std::vector<std::jthread> workers;
    for (int i = 0; i < options.jobs; ++i)
        workers.emplace_back([&] {
            for (std::size_t job = next++; job < jobs.size(); job = next++) {
                try {
                    results[job].set_value(runJob(jobs[job]));
                } catch (...) {
                    results[job].set_exception(std::current_exception());
                }
            }
        });
    for (auto& result : results) report(result.get_future().get());
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
