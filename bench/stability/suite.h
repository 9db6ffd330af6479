#pragma once

#include <functional>
#include <regex>
#include <string>
#include <vector>

#include "trial.h"

namespace ragtop::stability {

/// When a case runs.
enum class Kind {
    swept,       ///< always; --long repeats it at other steps
    oneStep,     ///< always, at the standard step or at those it chooses
    ragtopOnly,  ///< the same, but it asks for what only Ragtop has
    longer,      ///< only with --long
};

/// A scene with its parameters, and what is measured in it.
struct Case {
    std::string name;
    std::function<void(Trial&)> run;
    Kind kind = Kind::swept;
};

/// Cases about one thing.
struct Family {
    std::string name;
    std::vector<Case> cases;
};

/// What --short runs is listed in brief_cases.h, --long adds to the normal selection.
enum class Selection { brief, normal, longer };

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
