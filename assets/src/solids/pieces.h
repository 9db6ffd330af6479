#pragma once

#include <functional>
#include <vector>

#include "ragtop/tasks.h"
#include "solids/air.h"
#include "solids/cut_search.h"
#include "solids/point_hull.h"

namespace ragtop {

/// Bounds of a decomposition in the units of the solid.
struct PieceLimits {
    std::size_t pieces = 1;
    double error = 0;  ///< farthest air
    double air = 0;    ///< volume of the hulls beyond that of the solid
};

/// Cuts a solid until its hulls keep within the limits, or no cut helps, or there are several times as many as allowed.
/// Shows the hulls at stages on the way, the last one included, and ends where `isEnough` says so.
void cutToPieces(CutSolid solid, const PieceLimits& limits, const Air& air, const TaskRunner& tasks,
                 const std::function<bool(std::vector<PointHull>)>& isEnough);

/// Joins hulls, those that take up least air first: down to the allowed number, and on as long as the limits hold.
std::vector<PointHull> joinPieces(std::vector<PointHull> hulls, double solidVolume, const PieceLimits& limits,
                                  const Air& air, const TaskRunner& tasks);

}  // namespace ragtop
