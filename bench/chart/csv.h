#pragma once

#include <filesystem>
#include <stdexcept>
#include <string>
#include <string_view>

#include "point.h"

/// Points as comma-separated values; docs/chart.md has the columns.
namespace ragtop::chart {

/// "file:line: what is wrong with it".
struct CsvError : std::runtime_error {
    using std::runtime_error::runtime_error;
};

/// The names of the columns, which are those of this version.
std::string csvHead();
/// A line with its end. Numbers have as many digits as tell them from all others, those that are none are left empty.
/// `index` of `count` is the point's place, so that a file that is cut off shows.
std::string csvLine(const Point& point, std::size_t index, std::size_t count);

struct CsvPlace {
    Point point;
    std::size_t index = 0, count = 0;
};
/// Throws CsvError; `place` says where the line is.
CsvPlace parseCsvLine(std::string_view line, const std::string& place);

std::string toCsv(const Points& points);
/// Throws CsvError for files that cannot be read, are of another version, or end early.
Points readCsv(const std::filesystem::path& file);

/// Writes the file whole or not at all. Throws std::runtime_error, "file: cannot be written: why".
void writeWhole(const std::filesystem::path& file, std::string_view text);

}  // namespace ragtop::chart
