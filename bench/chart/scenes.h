#pragma once

#include <string>
#include <vector>

#include "../stability/suite.h"
#include "point.h"

namespace ragtop::chart {

/// A scene of the chart: a case of the stability suite, and which of its rows are the error.
struct ChartScene {
    std::string name, title;
    std::string family, test;
    /// The rows; the one that errs most counts.
    std::vector<std::string> quantities;
    ReferenceKind reference = ReferenceKind::closedForm;
    /// What errors are shares of, in the unit of the rows; 0: of the row's reference.
    double scale = 0;
    /// Smallest error that means anything here, and the one from which on the point has failed.
    double floor = 1e-5, failsFrom = 1;
    double longest = 10;      ///< s, that the case may run on at once
    bool quick = false;       ///< drawn by --quick too
    std::string how;          ///< how the reference was got, one line
    bool endsItself = false;  ///< the case ends its runs when it has seen enough, not when something fell
};

/// In the order of the documentation.
const std::vector<ChartScene>& allScenes();

/// The suite's case; throws std::logic_error where there is none.
const stability::Case& caseOf(const ChartScene& scene);

}  // namespace ragtop::chart
