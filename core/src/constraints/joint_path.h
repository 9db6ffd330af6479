#pragma once

#include <cstdint>
#include <string>

#include "ragtop/joint_parts.h"

namespace ragtop {

/// Where on a curve a joint is.
struct PathPlace {
    std::uint32_t segment = 0, tracked = 0;
    std::int32_t laps = 0;
    float parameter = 0;
    Vec3 across{0, 1, 0};  ///< unit vector across the curve that turns with it, in A's frame
};

/// A compiled curve and where on it a joint is. Segment i goes from point i to the next; its parameter is in [0, 1].
struct PathRows {
    static constexpr int kMost = Curve::kMostPoints;
    std::uint32_t points = 0, segments = 0, align = 0;
    Vec3 point[kMost], slope[kMost];  ///< m, and m per m of chord
    float chord[kMost] = {};          ///< m, of each segment
    float start[kMost] = {};          ///< m along the curve to its beginning
    float length = 0;                 ///< m

    PathPlace at;  ///< carried from substep to substep
};
/// Keeps the place where the curve is still the same.
void compile(PathRows& path, const Curve& curve, bool align);

struct CurvePoint {
    Vec3 place, tangent;  ///< m, and its unit vector
    Vec3 curvature;       ///< 1/m, how the tangent turns along the curve
};
CurvePoint curvePoint(const PathRows& path, std::uint32_t segment, float parameter);
/// Moves to the place of the curve that is nearest to `p`: of the whole curve at first, near the last one from then on.
void follow(PathRows& path, const Vec3& p);
/// m from the first point, with all laps.
double travelAlong(const PathRows& path);

/// Empty when points are apart and enough; otherwise the complaint.
std::string whyInvalidCurve(const Curve& curve);

}  // namespace ragtop
