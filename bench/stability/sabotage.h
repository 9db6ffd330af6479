#pragma once

#include <vector>

#include "suite.h"

namespace ragtop::stability {

/// Runs a case with one saboteur after the other (adapters/saboteurs.h) until each of its rows has failed for one that
/// loses nobody, and with the one that does. Tells for each row for how many it failed, and in its note for which; it
/// holds when that is one at least. Rows whose case runs nothing behind an engine's interface are skipped.
std::vector<Row> sabotage(const Case& test, Trial::Setting setting);

/// A table in Markdown of the saboteurs that the rows of each family fail for.
std::string saboteurTable(const std::vector<Row>& rows);

}  // namespace ragtop::stability
