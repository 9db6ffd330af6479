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
    double error = 0;          ///< farthest air
    double air = 0;            ///< volume of the hulls beyond that of the solid
    std::size_t corners = 64;  ///< of each hull
};

/// A hull and what it holds of the solid.
struct Piece {
    std::vector<CutSolid> solids;
    PointHull hull;
};

/// Could hulls of two pieces touch?
bool areNear(const PointHull& a, const PointHull& b);

/// Cuts a solid until its hulls keep within the limits, or no cut helps, or there are several times as many as allowed.
/// Shows the pieces at stages on the way, the last one included, and ends where `isEnough` says so.
void cutToPieces(CutSolid solid, CutOrder order, const PieceLimits& limits, const Air& air, const TaskRunner& tasks,
                 const std::function<bool(std::vector<Piece>)>& isEnough);

/// Joins pieces, those first that take up least air: down to the allowed number, and on as long as the limits hold.
std::vector<Piece> joinPieces(std::vector<Piece> pieces, double solidVolume, const PieceLimits& limits, const Air& air,
                              const TaskRunner& tasks);

/// Moves the borders of pieces that keep to the volume but not to the error, from the piece with the deepest air into
/// those beside it.
void evenOut(std::vector<Piece>& pieces, double solidVolume, const PieceLimits& limits, const Air& air,
             const TaskRunner& tasks);

}  // namespace ragtop
