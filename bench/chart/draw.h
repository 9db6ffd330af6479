#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "point.h"

namespace ragtop::chart {

/// What the page shows, as JSON: scenes, variants, points, and the comparisons of analysis.h.
std::string documentOf(const Points& points);

/// Writes the page, with the points in it, in one file that needs no other. Throws std::runtime_error where it cannot
/// be written, or where build/page/chart.html is absent, which scripts/page.sh builds.
void drawPage(const Points& points, const std::filesystem::path& file);

/// Draws the page's overview as a picture, by node. Returns why it could not, or nothing.
std::string drawPicture(const std::filesystem::path& page, const std::filesystem::path& picture);

/// In Markdown, with how many of each engine's scenes Ragtop dominates.
std::string lossTable(const Points& points);
std::string cheapestTable(const Points& points);
std::string sceneTable();

}  // namespace ragtop::chart
