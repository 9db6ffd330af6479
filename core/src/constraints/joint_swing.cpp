#include "constraints/joint_swing.h"

#include <cmath>
#include <limits>
#include <string>

#include "base/check_tunables.h"
#include "constraints/joint_angle.h"
#include "constraints/joint_constants.h"

namespace ragtop {
namespace {

constexpr float kFar = std::numeric_limits<float>::infinity();

float magnitude(float a) { return a < 0 ? -a : a; }

/// Angle between unit vectors, precise for small ones.
float angleBetween(const Vec3& a, const Vec3& b) { return 2 * arcTan2(length(a - b), length(a + b)); }

struct SwingVector {
    float y, z, size;
};
SwingVector swingOf(const Vec3& d) {
    const float across = std::sqrt(d.y * d.y + d.z * d.z), angle = arcTan2(across, d.x);
    if (!(across > kNoDirection)) return {0, d.x < 0 ? kPi : 0.0f, angle};
    return {-angle * d.z / across, angle * d.y / across, angle};
}

/// Half a turn away, any axis leads back.
SwingMargin circleMargin(float limit, const Vec3& d) {
    const float across = std::sqrt(d.y * d.y + d.z * d.z), margin = limit - jointAngle(across, d.x);
    if (!(across > kNoDirection)) return {margin, d.x < 0 ? Vec3{0, 0, -1} : Vec3{}};
    return {margin, {0, d.z / across, -d.y / across}};
}

/// A place of the ellipse's edge, its tangent with growing φ, and how far d lies along that tangent.
struct EdgePlace {
    Vec3 place, tangent;
    float ahead;
};
EdgePlace edgePlace(float y, float z, const SinCos& phi, const Vec3& d) {
    const float sy = y * phi.cos, sz = z * phi.sin, dy = -y * phi.sin, dz = z * phi.cos;
    const float r = std::sqrt(sy * sy + sz * sz), dr = (sy * dy + sz * dz) / r;
    const SinCos turn = sinCos(r);
    const float q = turn.sin / r, dq = (turn.cos - q) / r * dr;
    const Vec3 tangent{-turn.sin * dr, dq * sz + q * dz, -(dq * sy + q * dy)};
    return {{turn.cos, q * sz, -q * sy}, tangent, dot(tangent, d)};
}

/// Between two directions of the quadrant, `share` of the chord from the first.
SinCos between(const SinCos& a, const SinCos& b, float share) {
    const float s = a.sin + share * (b.sin - a.sin), c = a.cos + share * (b.cos - a.cos);
    const float inverse = 1 / std::sqrt(s * s + c * c);
    return {inverse * s, inverse * c};
}

/// The place between `low` and `high` at which d has no part along the edge, by false position with halving [Illinois];
/// d lies ahead at `low` and behind at `high`. It ends when no place between could be nearer by more than kEnough.
/// On a half axis its end is another such place: close to it d has hardly any part along the edge, and false position
/// would creep away from it.
EdgePlace nearestPlace(const SwingLimit& limit, const Vec3& d, SinCos low, float atLow, SinCos high, float atHigh) {
    constexpr int kEvaluations = 14, kHalvings = 3;
    constexpr float kEnough = 5e-5f, kAbreast = 1e-4f;  // rad
    constexpr float kUneven = 0.05f;
    EdgePlace best{};
    int side = 0;
    for (int i = 0; i < kEvaluations; ++i) {
        const bool uneven = atLow < -kUneven * atHigh || -atHigh < kUneven * atLow;
        const bool halves = i < kHalvings && uneven;
        const SinCos next = between(low, high, halves ? 0.5f : atLow / (atLow - atHigh));
        best = edgePlace(limit.y, limit.z, next, d);
        // Along the way to the end the distance δ falls by dδ = ahead/sin δ dφ, with less and less ahead.
        const SinCos& end = best.ahead > 0 ? high : low;
        const float gain = magnitude(best.ahead * (next.cos * end.sin - next.sin * end.cos));
        const float sine = length(cross(d, best.place));
        if (gain < 2 * kEnough * sine || magnitude(best.ahead) < kAbreast * length(best.tangent)) break;
        if (best.ahead > 0) {
            low = next, atLow = best.ahead;
            if (side == 1 && !halves) atHigh *= 0.5f;
            side = 1;
        } else {
            high = next, atHigh = best.ahead;
            if (side == -1 && !halves) atLow *= 0.5f;
            side = -1;
        }
    }
    return best;
}

/// The nearest place of the edge in the quadrant of d. Its ends are stationary too where d is on a half axis, and the
/// nearest only if d lies towards them from a little further on.
EdgePlace nearestInQuadrant(const SwingLimit& limit, const Vec3& d) {
    constexpr SinCos kFirst{0, 1}, kLast{1, 0};
    constexpr SinCos kAfterFirst{0.019998667f, 0.9998f}, kBeforeLast{0.9998f, 0.019998667f};  // 0.02 rad from them
    const auto at = [&](const SinCos& phi) { return edgePlace(limit.y, limit.z, phi, d); };
    const EdgePlace low = at(kAfterFirst), high = at(kBeforeLast);
    if (low.ahead > 0 && high.ahead < 0) return nearestPlace(limit, d, kAfterFirst, low.ahead, kBeforeLast, high.ahead);
    if (!(low.ahead > 0)) {
        const EdgePlace end = at(kFirst);
        return end.ahead > 0 && low.ahead < 0 ? nearestPlace(limit, d, kFirst, end.ahead, kAfterFirst, low.ahead) : end;
    }
    const EdgePlace end = at(kLast);
    return end.ahead < 0 && high.ahead > 0 ? nearestPlace(limit, d, kBeforeLast, high.ahead, kLast, end.ahead) : end;
}

SwingMargin ellipseMargin(const SwingLimit& limit, const Vec3& direction) {
    const SwingVector swing = swingOf(direction);
    const float flipY = swing.y < 0 ? -1.0f : 1.0f, flipZ = swing.z < 0 ? -1.0f : 1.0f;
    // Turning a component of the swing vector round mirrors z or y of the direction, and axes of turning once more.
    const Vec3 d{direction.x, flipZ * direction.y, flipY * direction.z};
    const EdgePlace edge = nearestInQuadrant(limit, d);
    const Vec3 tangent = normalized(edge.tangent, {}), inwards = cross(edge.place, tangent);
    const float handed = -flipY * flipZ;
    return {arcTan2(dot(inwards, d), dot(edge.place, d)),
            handed * Vec3{tangent.x, flipZ * tangent.y, flipY * tangent.z}};
}

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

/// The part of the edge that is nearest to d, and of the arcs that d is beside and within the second nearest.
void polygonMargins(const SwingLimit& limit, const Vec3& d, SwingMargin (&sides)[SwingLimit::kSides]) {
    const std::uint32_t n = limit.corners;
    bool isArc = false;
    const auto consider = [&](const SwingMargin& side, bool arc) {
        const float distance = magnitude(side.margin);
        if (distance < magnitude(sides[0].margin)) {
            if (isArc && sides[0].margin > 0) sides[1] = sides[0];
            sides[0] = side;
            isArc = arc;
        } else if (arc && side.margin > 0 && distance < sides[1].margin) {
            sides[1] = side;
        }
    };
    for (std::uint32_t i = 0; i < n; ++i) {
        const std::uint32_t next = i + 1 == n ? 0 : i + 1;
        const Vec3 &from = limit.corner[i], &to = limit.corner[next], &inwards = limit.edge[i];
        const Vec3 along = cross(inwards, d);
        if (dot(along, from) <= 0 && dot(along, to) >= 0) {
            consider({arcTan2(dot(inwards, d), length(along)), normalized(-along, {})}, true);
            continue;
        }
        // The corner that this edge begins with; the other is the next edge's.
        const bool concave = dot(limit.edge[i == 0 ? n - 1 : i - 1], to) < 0;
        const Vec3 away = normalized(cross(from, d), {});
        const float angle = angleBetween(d, from);
        consider(concave ? SwingMargin{angle, away} : SwingMargin{-angle, -away}, false);
    }
    if (sides[0].margin < 0) sides[1] = {kFar, {}};
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
            sides[0] = ellipseMargin(limit, d);
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

Range twistAt(const SwingLimit& limit, const Vec3& d) {
    constexpr float kSame = 1e-8f;  // of a squared distance: at a corner its own range counts
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
    constexpr float kApart = 1e-3f;
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
