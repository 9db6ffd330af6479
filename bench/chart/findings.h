#pragma once

#include <string>

#include "point.h"

namespace ragtop::chart {

/// Why Ragtop takes longer than an engine in a scene, or never errs as little; empty where nobody has told.
std::string reasonOf(const std::string& scene, const std::string& engine);

/// What others have published of engines, as these points have it: a table in Markdown.
std::string findingsTable(const Points& points);

}  // namespace ragtop::chart
