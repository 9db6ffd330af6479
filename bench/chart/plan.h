#pragma once

#include <vector>

#include "sweep.h"

namespace ragtop::chart {

/// Scenes times variants times settings.
std::vector<Task> plan(const std::vector<const ChartScene*>& scenes, const std::vector<const Variant*>& variants,
                       Effort effort, const MeasureOptions& options);

}  // namespace ragtop::chart
