#pragma once

#include <cstdint>
#include <string>

#include "constraints/joint_geometry.h"
#include "ragtop/joint_parts.h"

/// How far a direction d, that of B's x axis in A's joint frame, is from the edge of what it may be.
namespace ragtop {

using SwingMargin = SwingMarginOf<float>;

enum class SwingShape : std::uint32_t { free, circle, ellipse, pyramid, polygon };

/// Edges that may be reached at once.
constexpr int sidesOf(SwingShape shape) {
    return shape == SwingShape::free ? 0 : shape == SwingShape::circle || shape == SwingShape::ellipse ? 1 : 2;
}

/// A compiled limit of the swing.
struct SwingLimit {
    static constexpr int kSides = 2;  ///< rows: upper and lower, or of both angles
    SwingShape shape = SwingShape::free;
    float y = 0, z = 0;                       ///< rad, half angles of circle and ellipse
    Range rangeY{}, rangeZ{};                 ///< rad, of the pyramid
    std::uint32_t corners = 0;                ///< of the polygon
    Vec3 corner[ReachPolygon::kMostCorners];  ///< unit vectors
    Vec3 edge[ReachPolygon::kMostCorners];    ///< unit normals, inwards, of the arc from each to the next
    Range twist[ReachPolygon::kMostCorners];  ///< rad, at each corner
};
void compile(SwingLimit& limit, const ReachPolygon& polygon);

/// The nearest edge, and a second one where two may be reached at once. Sides that are not there have an endless
/// margin.
void swingMargins(const SwingLimit& limit, const Vec3& d, SwingMargin (&sides)[SwingLimit::kSides]);
/// The twist that a polygon allows at d: the mean of its corners' by the inverse fourth power of their distance.
Range twistAt(const SwingLimit& limit, const Vec3& d);
/// How the ends of that range grow as d turns: by ω · lower and ω · upper.
struct TwistTilt {
    Vec3 lower, upper;
};
TwistTilt twistTiltAt(const SwingLimit& limit, const Vec3& d, const Range& range);

/// B's x axis after a swing, a rotation vector across x, and the other way round.
Vec3 directionOfSwing(float y, float z);

/// Empty when edges do not cross and the corners are apart; otherwise the complaint.
std::string whyInvalidReach(const ReachPolygon& polygon);

}  // namespace ragtop
