#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "trial.h"

namespace ragtop::stability {

std::string tableHead();
std::string tableLine(const Row& row);
/// A list of {family, case, engine, value, reference, bound, unit, pass, ms, note}; a number that is
/// none becomes null, and so does `pass` of a row that was skipped.
std::string toJson(const std::vector<Row>& rows);
std::vector<Row> rowsFromJson(const std::string& text);

}  // namespace ragtop::stability
