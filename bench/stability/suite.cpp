#include "suite.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <limits>
#include <stdexcept>
#include <string_view>

#include "families.h"
#include "isolation.h"
#include "red_rows.h"
#include "report.h"
#include "sabotage.h"

namespace ragtop::stability {
namespace {

/// Steps a second.
constexpr int kRate = 60;
/// The sweep of --long, beside the standard rate.
constexpr std::array kOtherRates{15, 30, 120, 240};

struct Job {
    const Case* test;
    Trial::Setting setting;
};

const EngineKind kSaboteurs{"saboteurs", nullptr};

bool isSelected(const Case& test, Selection selection) {
    if (selection == Selection::brief && !test.brief) return false;
    return test.kind != Kind::longer || selection == Selection::longer;
}

std::vector<const EngineKind*> enginesOf(const Case& test, const SuiteOptions& options) {
    if (options.sabotaged) return {&kSaboteurs};
    std::vector<const EngineKind*> engines;
    for (const EngineKind* engine : options.engines)
        if (engine->make && (test.kind != Kind::ragtopOnly || engine->name == "ragtop")) engines.push_back(engine);
    return engines;
}

std::vector<int> ratesOf(const Case& test, const SuiteOptions& options) {
    if (!options.rates.empty()) return options.rates;
    std::vector<int> rates{kRate};
    if (options.selection == Selection::longer && test.kind == Kind::swept)
        rates.insert(rates.end(), kOtherRates.begin(), kOtherRates.end());
    return rates;
}

std::string nameAt(const Case& test, int rate) {
    return rate == kRate ? test.name : fmt::format("{} @ 1/{} s", test.name, rate);
}

void addJobs(const Family& family, const Case& test, const SuiteOptions& options, std::vector<Job>& jobs) {
    if (!isSelected(test, options.selection) || (options.redOnly && !hasRedRow(family.name + "/" + test.name))) return;
    for (const EngineKind* engine : enginesOf(test, options))
        for (const int rate : ratesOf(test, options)) {
            const std::string name = nameAt(test, rate);
            if (std::regex_search(family.name + "/" + name, options.filter))
                jobs.push_back({&test, {family.name, name, engine, 1.0 / rate, options.records}});
        }
}

/// A family without a case in the short selection would go untested in every build.
void checkSelections(const std::vector<Family>& families) {
    for (const Family& family : families)
        if (std::ranges::none_of(family.cases, [](const Case& test) { return isSelected(test, Selection::brief); }))
            throw std::logic_error(fmt::format("{} has no case in the short selection", family.name));
}

std::vector<Job> jobsOf(const std::vector<Family>& families, const SuiteOptions& options) {
    checkSelections(families);
    std::vector<Job> jobs;
    for (const Family& family : families)
        for (const Case& test : family.cases) addJobs(family, test, options, jobs);
    return jobs;
}

/// In place of the rows of a case that has none.
Row rowWithout(const Trial::Setting& setting, Verdict verdict, const std::string& why) {
    constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
    return {setting.family, setting.name, setting.engine->name, kNone, 0, 0, "", verdict, 0, why};
}

Verdict verdictOfMissing() { return isInCi() ? Verdict::fails : Verdict::skipped; }

std::vector<Row> runJob(const Job& job) {
    Trial trial(job.setting);
    try {
        if (job.setting.engine == &kSaboteurs) return sabotage(*job.test, job.setting);
        job.test->run(trial);
    } catch (const Missing& missing) {
        return {rowWithout(job.setting, verdictOfMissing(), missing.what())};
    } catch (const Unsupported& unsupported) {
        return {rowWithout(job.setting, Verdict::skipped, unsupported.what())};
    } catch (const std::exception& error) {
        return {rowWithout(job.setting, Verdict::fails, error.what())};
    }
    return trial.rows();
}

}  // namespace

double runSuite(const SuiteOptions& options, const std::function<void(const std::vector<Row>&)>& report) {
    const std::vector<Family> families = allFamilies();
    const std::vector<Job> jobs = jobsOf(families, options);
    for (const EngineKind* engine : options.engines)
        if (!engine->make)
            report({rowWithout({"", "all cases", engine, 0, {}}, verdictOfMissing(),
                               "this program was built without it")});
    std::vector<std::function<std::string()>> works;
    for (const Job& job : jobs) works.push_back([&job] { return toJson(runJob(job)); });
    double seconds = 0;
    runIsolated(works, options.jobs, [&](std::size_t i, const Outcome& outcome) {
        seconds += outcome.seconds;
        report(outcome.death.empty() ? rowsFromJson(outcome.text)
                                     : std::vector{rowWithout(jobs[i].setting, Verdict::fails, outcome.death)});
    });
    return seconds;
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

int expectedRows(Selection selection) { return selection == Selection::brief ? 684 : 720; }

std::string whyTooFew(const std::vector<Row>& rows, Selection selection) {
    const auto isOwn = [](const Row& row) { return row.engine == "ragtop"; };
    const bool skips =
        std::ranges::any_of(rows, [&](const Row& row) { return isOwn(row) && row.verdict == Verdict::skipped; });
    const auto own = std::ranges::count_if(rows, isOwn), expected = std::ptrdiff_t{expectedRows(selection)};
    if (own >= expected || (skips && !isInCi())) return {};
    return fmt::format("{} rows of Ragtop's, {} are expected", own, expected);
}

bool isInCi() {
    const char* ci = std::getenv("CI");
    return ci && std::string_view(ci) == "true";
}

}  // namespace ragtop::stability
