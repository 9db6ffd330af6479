#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "contender.h"

namespace ragtop::speed {

/// One window of a course on so many threads.
struct Row {
    std::string scene;
    int threads = 1, lanes = 0;
    std::optional<double> ms, bulletMs;  ///< mean over the window's steps, of the fastest run
    Quality quality;
    Work work;
    std::optional<double> ratio() const;  ///< Bullet's time over Ragtop's
};

std::string tableHead();
std::string tableLine(const Row& row);
/// A list of objects with the keys of docs/speed.md.
std::string toJson(const std::vector<Row>& rows);
/// A table in Markdown: the ratios of each scene in every file of the folder, oldest first. Throws std::runtime_error
/// naming a file that is none of ours.
std::string historyTable(const std::filesystem::path& folder);

}  // namespace ragtop::speed
