#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "ragtop/shape.h"
#include "solids/vectors.h"

/// Solids of triangles that planes cut exactly.
namespace ragtop {

/// Where a cut has closed a solid: the edges of the cut, running so that the cut is counter-clockwise seen from
/// outside. They are a cycle: what sums over it need, and no order or triangles.
struct Cap {
    DPlane plane;  ///< its normal points out of the solid
    std::vector<std::array<std::uint32_t, 2>> edges;
};

/// Every vertex is one of a triangle or a cap, so that the hull of the vertices is that of the solid.
struct CutSolid {
    std::vector<DVec3> vertices;
    std::vector<Triangle> triangles;
    std::vector<Cap> caps;
};

/// Vertices closer to a plane than this lie on it; solids are about 1 large, and of single precision.
inline constexpr double kOnPlane = 2e-6;

double volumeOf(const CutSolid& solid);

/// What a plane would leave below it, and the corners of each part of that which lies apart from the others.
struct Remainder {
    double volume = 0, cutArea = 0;
    std::vector<std::vector<DVec3>> corners;
};
Remainder remainderBelow(const CutSolid& solid, const DPlane& plane);

/// The part below the plane, closed by a cap.
CutSolid partBelow(const CutSolid& solid, const DPlane& plane);

/// What does not hang together, where bounds keep it apart.
std::vector<CutSolid> separated(CutSolid solid);

/// What does not hang together, each with the hollows in it; where these are many, those near each other as one, so
/// that there are no more than `most`.
std::vector<CutSolid> bodiesOf(CutSolid solid, std::size_t most);

constexpr DPlane flipped(const DPlane& plane) { return {-1.0 * plane.normal, -plane.offset}; }

}  // namespace ragtop
