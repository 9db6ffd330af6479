#include "constraints/joint_swing.h"

#include <cmath>
#include <limits>
#include <string>

#include "base/check_tunables.h"
#include "constraints/joint_geometry.h"
#include "constraints/joint_constants.h"
#include "constraints/swing_ellipse.h"

namespace ragtop {
namespace {

constexpr float kFar = std::numeric_limits<float>::infinity();

/// Angle between unit vectors, precise for small ones.
float angleBetween(const Vec3& a, const Vec3& b) { return 2 * jointAngle(length(a - b), length(a + b)); }

/// A margin of the angle φ of d about the axis `k`, of which d must not be a multiple: its rate is ω · u/c with the
/// unit vector u below and c the sine of the angle between d and k. The row is scaled by c, margin and rate alike, so
/// that it fades where φ loses its meaning.
SwingMargin wedgeMargin(const Range& range, const Vec3& d, const Vec3& k) {
    const Vec3 across = cross(k, {1, 0, 0});
    const float along = d.x, aside = dot(across, d), off = dot(k, d), c = std::sqrt(along * along + aside * aside);
    if (!(c > kNoDirection)) return {kFar, {}};
    const float angle = arcTan2(aside, along);
    const float toLower = angle - range.lower, toUpper = range.upper - angle;
    const Vec3 u = c * k - (off / c) * (d - off * k);
    return toLower < toUpper ? SwingMargin{c * toLower, u} : SwingMargin{c * toUpper, -u};
}

/// The arc after corner `index` where d is beside it, else that corner.
struct EdgePart {
    float square;  ///< of the chord to d
    std::uint32_t index;
    float sine;  ///< of the margin to an arc
    bool isArc;

    bool isWithin() const { return isArc && sine > 0; }
};
/// chord² = 2 (1 − cos θ) = 2 sin² θ/(1 + cos θ)
EdgePart edgePart(const SwingLimit& limit, std::uint32_t i, const Vec3& d) {
    const Vec3 &from = limit.corner[i], &to = limit.corner[i + 1 == limit.corners ? 0 : i + 1];
    const Vec3 along = cross(limit.edge[i], d);
    if (!(dot(along, from) <= 0 && dot(along, to) >= 0)) return {lengthSquared(d - from), i, 0, false};
    const float sine = dot(limit.edge[i], d), square = sine * sine, rest = square < 1 ? 1 - square : 0.0f;
    return {2 * square / (1 + std::sqrt(rest)), i, sine, true};
}
SwingMargin marginTo(const SwingLimit& limit, const EdgePart& part, const Vec3& d) {
    const std::uint32_t i = part.index, n = limit.corners;
    if (part.isArc) {
        const Vec3 along = cross(limit.edge[i], d);
        return {jointAngle(part.sine, length(along)), normalized(-along, {})};
    }
    const Vec3 &from = limit.corner[i], &to = limit.corner[i + 1 == n ? 0 : i + 1];
    const bool concave = dot(limit.edge[i == 0 ? n - 1 : i - 1], to) < 0;
    const Vec3 away = normalized(cross(from, d), {});
    const float angle = angleBetween(d, from);
    return concave ? SwingMargin{angle, away} : SwingMargin{-angle, -away};
}

/// The part of the edge that is nearest to d, and of the arcs that d is beside and within the second nearest.
void polygonMargins(const SwingLimit& limit, const Vec3& d, SwingMargin (&sides)[SwingLimit::kSides]) {
    EdgePart nearest{kFar, 0, 0, false}, second = nearest;
    for (std::uint32_t i = 0; i < limit.corners; ++i) {
        const EdgePart part = edgePart(limit, i, d);
        if (part.square < nearest.square) {
            if (nearest.isWithin()) second = nearest;
            nearest = part;
        } else if (part.isWithin() && part.square < second.square) {
            second = part;
        }
    }
    sides[0] = marginTo(limit, nearest, d);
    if (second.isArc && !(sides[0].margin < 0)) sides[1] = marginTo(limit, second, d);
}

}  // namespace

Vec3 directionOfSwing(float y, float z) {
    const float angle = std::sqrt(y * y + z * z);
    const SinCos turn = sinCos(angle);
    const float q = angle > kNoDirection ? turn.sin / angle : 1.0f;
    return {turn.cos, q * z, -q * y};
}

void compile(SwingLimit& limit, const ReachPolygon& polygon) {
    limit.shape = SwingShape::polygon;
    limit.corners = static_cast<std::uint32_t>(polygon.count);
    for (std::uint32_t i = 0; i < limit.corners; ++i) {
        limit.corner[i] = normalized(polygon.corners[i].direction);
        limit.twist[i] = polygon.corners[i].twist;
    }
    for (std::uint32_t i = 0; i < limit.corners; ++i)
        limit.edge[i] = normalized(cross(limit.corner[i], limit.corner[i + 1 == limit.corners ? 0 : i + 1]));
}

void swingMargins(const SwingLimit& limit, const Vec3& d, SwingMargin (&sides)[SwingLimit::kSides]) {
    sides[0] = sides[1] = {kFar, {}};
    switch (limit.shape) {
        case SwingShape::free:
            break;
        case SwingShape::circle:
            sides[0] = circleMargin(limit.y, d);
            break;
        case SwingShape::ellipse:
            sides[0] = ellipseMargin(limit.y, limit.z, d);
            break;
        case SwingShape::pyramid:
            sides[0] = wedgeMargin(limit.rangeY, d, {0, 1, 0});
            sides[1] = wedgeMargin(limit.rangeZ, d, {0, 0, 1});
            break;
        case SwingShape::polygon:
            polygonMargins(limit, d, sides);
            break;
    }
}

namespace {

constexpr float kSame = 1e-8f;  // of a squared distance: at a corner its own range counts

}  // namespace

Range twistAt(const SwingLimit& limit, const Vec3& d) {
    float lower = 0, upper = 0, sum = 0;
    for (std::uint32_t i = 0; i < limit.corners; ++i) {
        const float distance = lengthSquared(d - limit.corner[i]) + kSame;
        const float weight = 1 / (distance * distance);
        lower += weight * limit.twist[i].lower;
        upper += weight * limit.twist[i].upper;
        sum += weight;
    }
    return {lower / sum, upper / sum};
}

/// With weights W = |d − c|⁻⁴ and d' = ω × d:  W' = 4 |d − c|⁻⁶ ω · (d × c),  (Σ W L/Σ W)' = Σ W' (L − mean)/Σ W.
TwistTilt twistTiltAt(const SwingLimit& limit, const Vec3& d, const Range& range) {
    TwistTilt tilt;
    float sum = 0;
    for (std::uint32_t i = 0; i < limit.corners; ++i) {
        const float near = 1 / (lengthSquared(d - limit.corner[i]) + kSame), weight = near * near;
        const Vec3 grows = (4 * weight * near) * cross(d, limit.corner[i]);
        tilt.lower += (limit.twist[i].lower - range.lower) * grows;
        tilt.upper += (limit.twist[i].upper - range.upper) * grows;
        sum += weight;
    }
    return {(1 / sum) * tilt.lower, (1 / sum) * tilt.upper};
}

namespace {

std::string cornerName(int i) { return "reach.corners[" + std::to_string(i) + "]"; }

/// Do two arcs that share no corner cross?
bool arcsCross(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
    const Vec3 n = cross(a, b), m = cross(c, d), line = cross(n, m);
    const auto within = [&](const Vec3& p) {
        return dot(cross(n, a), p) > 0 && dot(cross(b, n), p) > 0 && dot(cross(m, c), p) > 0 && dot(cross(d, m), p) > 0;
    };
    return within(line) || within(-line);
}

}  // namespace

std::string whyInvalidReach(const ReachPolygon& polygon) {
    constexpr float kApart = 1e-3f;  // rad, 0.06°
    const int n = polygon.count;
    if (n < 3 || n > ReachPolygon::kMostCorners)
        return "reach.count is " + std::to_string(n) + ", must be in [3, " +
               std::to_string(ReachPolygon::kMostCorners) + "]";
    Vec3 corners[ReachPolygon::kMostCorners];
    for (int i = 0; i < n; ++i) {
        const ReachCorner& corner = polygon.corners[static_cast<std::size_t>(i)];
        if (std::string why = whyOutOfRange(corner, cornerName(i) + "."); !why.empty()) return why;
        if (!(length(corner.direction) > kNoDirection))
            return cornerName(i) + ".direction is zero, must point somewhere";
        corners[i] = normalized(corner.direction);
    }
    for (int i = 0; i < n; ++i) {
        const int next = (i + 1) % n;
        if (!(length(cross(corners[i], corners[next])) > kApart))
            return cornerName(next) + ".direction is the same as or opposite to that of corner " + std::to_string(i) +
                   ", must differ by more than 0.001 rad and less than half a turn";
        for (int j = i + 2; j < n; ++j) {
            if ((j + 1) % n == i) continue;
            if (arcsCross(corners[i], corners[next], corners[j], corners[(j + 1) % n]))
                return "reach: the edges after corners " + std::to_string(i) + " and " + std::to_string(j) +
                       " cross, must not";
        }
    }
    return {};
}

}  // namespace ragtop
