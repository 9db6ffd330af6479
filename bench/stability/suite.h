#pragma once

#include <functional>
#include <regex>
#include <string>
#include <vector>

#include "trial.h"

namespace ragtop::stability {

/// Which selections a case belongs to; each holds those before it.
enum class Selection {
    brief,   ///< part of the tests of every build
    normal,
    longer,  ///< only with --long
};

/// A scene with its parameters, and what is measured in it.
struct Case {
    std::string name;
    std::function<void(Trial&)> run;
    Selection selection = Selection::normal;
    bool swept = true;        ///< --long repeats it at other steps
    bool ragtopOnly = false;  ///< asks for something that only Ragtop's interface has
};

/// Cases about one thing.
struct Family {
    std::string name;
    std::vector<Case> cases;
};

struct SuiteOptions {
    std::vector<const EngineKind*> engines;
    std::regex filter{""};  ///< searched for in "family/case"
    Selection selection = Selection::normal;
    std::optional<std::filesystem::path> records;
    int jobs = 1;  ///< processes that run cases
};

/// Runs the selected cases; `report` is given the rows of each case in turn.
void runSuite(const SuiteOptions& options, const std::function<void(const std::vector<Row>&)>& report);

/// Lists what would run, as "family/case".
std::vector<std::string> selectedCases(const SuiteOptions& options);

}  // namespace ragtop::stability
