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
    /// --short runs it, and so the tests of every build. Not where it takes seconds, or compares times, which needs an
    /// idle machine. One that fails is never taken out for that.
    bool brief = true;
};

/// Cases about one thing.
struct Family {
    std::string name;
    std::vector<Case> cases;
};

/// --short runs the brief cases, --long adds to the normal selection.
enum class Selection { brief, normal, longer };

struct SuiteOptions {
    std::vector<const EngineKind*> engines;
    std::regex filter{""};  ///< searched for in "family/case"
    Selection selection = Selection::normal;
    bool redOnly = false;    ///< no cases but those with rows that are known to fail
    std::vector<int> rates;  ///< steps a second at which all run; empty for 60, and what the selection adds
    bool sabotaged = false;  ///< with Ragtop's saboteurs instead of the engines
    std::optional<std::filesystem::path> records;
    int jobs = 1;  ///< processes that run cases
};

/// Runs the selected cases; `report` is given the rows of each case in turn. Returns the processor time that all of
/// them took, s.
double runSuite(const SuiteOptions& options, const std::function<void(const std::vector<Row>&)>& report);

/// Lists what would run, as "family/case".
std::vector<std::string> selectedCases(const SuiteOptions& options);

/// How many rows Ragtop has at least in a selection that no filter narrows. Fewer are a failure, since a row that is
/// gone would hold for ever; whoever adds some raises it.
int expectedRows(Selection selection);
/// What is wrong with the number of Ragtop's rows in such a selection; empty where they are all there, or skipped
/// where that is none.
std::string whyTooFew(const std::vector<Row>& rows, Selection selection);

/// Is this where nothing may be missing? Told by CI=true in the environment.
bool isInCi();

}  // namespace ragtop::stability
