#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "contender.h"

namespace ragtop::speed {

/// What an engine did in a window.
struct Result {
    std::vector<double> ms, worstMs;  ///< by run: mean over the window's steps, and the slowest of them
    std::optional<Quality> quality;
    std::optional<Work> work;
};

/// A median of values drawn at random, and two of them between which that of all lies with this probability, whatever they
/// are distributed like: order statistics.
struct Median {
    double value, lower, upper, confidence;
};
/// The narrowest such interval of at least 95 %, or that of all values where they are too few. Empty for no values.
std::optional<Median> medianOf(std::vector<double> values);

/// One window of a course on so many threads. Runs of the engines with the same index were made one after the other.
struct Row {
    std::string scene;
    int threads = 1;
    std::optional<int> lanes;
    Result own, bullet;
    std::optional<Median> ratio() const;  ///< Bullet's time over Ragtop's, run by run
};

std::string tableHead();
std::string tableLine(const Row& row);
/// A list of objects with the keys of docs/speed.md.
std::string toJson(const std::vector<Row>& rows);
/// Tables in Markdown of the files of a folder, which throw std::runtime_error naming a file that is none of ours: the
/// ratios of each scene in every file, oldest first, and all that the newest tells of Ragtop and Bullet.
std::string historyTable(const std::filesystem::path& folder);
std::string newestTable(const std::filesystem::path& folder);

}  // namespace ragtop::speed
