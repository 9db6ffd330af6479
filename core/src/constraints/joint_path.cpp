#include "constraints/joint_path.h"

#include <cmath>

#include "base/check_tunables.h"
#include "constraints/axes_writer.h"

namespace ragtop {
namespace {

/// Of a segment at a parameter, by it: the cubic with the ends p, q and slopes there.
struct Cubic {
    Vec3 place, first, second;
};
Cubic cubicAt(const PathRows& path, std::uint32_t segment, float t) {
    const std::uint32_t next = segment + 1 == path.points ? 0 : segment + 1;
    const float h = path.chord[segment];
    const Vec3 p = path.point[segment], d = path.point[next] - p;
    const Vec3 m = h * path.slope[segment], n = h * path.slope[next];
    const Vec3 b = 3.0f * d - 2.0f * m - n, c = m + n - 2.0f * d;
    return {p + t * (m + t * (b + t * c)), m + t * (2.0f * b + 3.0f * t * c), 2.0f * b + 6.0f * t * c};
}

/// m from the beginning of a segment to a parameter, by Gauss's rule of five points.
double lengthTo(const PathRows& path, std::uint32_t segment, float t) {
    constexpr double kAt[] = {0, 0.5384693101056831, 0.9061798459386640};
    constexpr double kWeight[] = {0.5688888888888889, 0.4786286704993665, 0.2369268850561891};
    double sum = 0;
    for (int i = -2; i <= 2; ++i) {
        const int k = i < 0 ? -i : i;
        const double at = 0.5 * static_cast<double>(t) * (1 + (i < 0 ? -kAt[k] : kAt[k]));
        sum += kWeight[k] * static_cast<double>(length(cubicAt(path, segment, static_cast<float>(at)).first));
    }
    return 0.5 * static_cast<double>(t) * sum;
}

/// The slopes for which the curvature has no jumps:
///   hᵢ mᵢ₋₁ + 2 (hᵢ₋₁ + hᵢ) mᵢ + hᵢ₋₁ mᵢ₊₁ = 3 (hᵢ dᵢ₋₁/hᵢ₋₁ + hᵢ₋₁ dᵢ/hᵢ),
/// and at free ends none. Each iteration takes at least half of the error away.
void solveSlopes(PathRows& path, bool closed) {
    constexpr int kIterations = 48;  // leave 2⁻⁴⁸ of the error: less than floats resolve
    const std::uint32_t n = path.points;
    const auto chordOf = [&](std::uint32_t i) {
        const std::uint32_t next = i + 1 == n ? 0 : i + 1;
        return (1 / path.chord[i]) * (path.point[next] - path.point[i]);
    };
    for (int iteration = 0; iteration < kIterations; ++iteration)
        for (std::uint32_t i = 0; i < n; ++i) {
            const std::uint32_t before = i == 0 ? n - 1 : i - 1, after = i + 1 == n ? 0 : i + 1;
            if (!closed && i == 0) {
                path.slope[i] = 0.5f * (3.0f * chordOf(0) - path.slope[1]);
            } else if (!closed && after == 0) {
                path.slope[i] = 0.5f * (3.0f * chordOf(before) - path.slope[before]);
            } else {
                const float h = path.chord[before], k = path.chord[i];
                path.slope[i] = (1 / (2 * (h + k))) * (3.0f * (k * chordOf(before) + h * chordOf(i)) -
                                                       k * path.slope[before] - h * path.slope[after]);
            }
        }
}

/// By how much the parameter has to change for the line to `p` to be across the curve.
float towards(const PathRows& path, std::uint32_t segment, float t, const Vec3& p) {
    const Cubic at = cubicAt(path, segment, t);
    const float along = lengthSquared(at.first), bend = dot(at.second, at.place - p);
    // Beyond the centre of curvature the nearest place is no longer a minimum; the step along the tangent leads on.
    const float slope = along + bend > 0.25f * along ? along + bend : along;
    return dot(at.first, p - at.place) / slope;
}

void findNearest(PathRows& path, const Vec3& p) {
    constexpr int kTries = 8;  // per segment, by trial
    float least = 3.4e38f;
    for (std::uint32_t s = 0; s < path.segments; ++s)
        for (int i = 0; i <= kTries; ++i) {
            const float t = static_cast<float>(i) / kTries;
            const float distance = lengthSquared(cubicAt(path, s, t).place - p);
            if (!(distance < least)) continue;
            least = distance;
            path.at.segment = s;
            path.at.parameter = t;
        }
    path.at.tracked = 1;
}

}  // namespace

void compile(PathRows& path, const Curve& curve, bool align) {
    const PathRows old = path;
    path = {};
    path.points = static_cast<std::uint32_t>(curve.count);
    path.segments = curve.closed ? path.points : path.points - 1;
    path.align = align ? 1 : 0;
    bool same = old.points == path.points && old.segments == path.segments;
    for (std::uint32_t i = 0; i < path.points; ++i) {
        path.point[i] = curve.points[i];
        same = same && path.point[i] == old.point[i];
    }
    for (std::uint32_t i = 0; i < path.segments; ++i)
        path.chord[i] = length(path.point[i + 1 == path.points ? 0 : i + 1] - path.point[i]);
    solveSlopes(path, curve.closed);
    double sum = 0;
    for (std::uint32_t i = 0; i < path.segments; ++i) {
        path.start[i] = static_cast<float>(sum);
        sum += lengthTo(path, i, 1);
    }
    path.length = static_cast<float>(sum);
    if (!same) return;
    path.at = old.at;
}

CurvePoint curvePoint(const PathRows& path, std::uint32_t segment, float parameter) {
    const float inside = parameter < 0 ? 0 : parameter > 1 ? 1 : parameter;
    const Cubic at = cubicAt(path, segment, inside);
    const float speed = length(at.first);
    const Vec3 tangent = normalized(at.first);
    const Vec3 bend = at.second - dot(at.second, tangent) * tangent;
    return {at.place + (parameter - inside) * at.first, tangent, (1 / (speed * speed)) * bend};
}

void follow(PathRows& path, const Vec3& p) {
    constexpr int kSteps = 6;  // of Newton's method, by trial
    constexpr float kEnough = 1e-6f;  // of a segment: eight roundings of a float
    const bool begins = path.at.tracked == 0;
    if (begins) findNearest(path, p);
    const bool closed = path.segments == path.points;
    for (int i = 0; i < kSteps; ++i) {
        const float inside = path.at.parameter < 0 ? 0 : path.at.parameter > 1 ? 1 : path.at.parameter;
        const float step = inside + towards(path, path.at.segment, inside, p) - path.at.parameter;
        path.at.parameter += step;
        const bool last = path.at.segment + 1 == path.segments, first = path.at.segment == 0;
        if (path.at.parameter > 1 && (closed || !last)) {
            path.at.segment = last ? 0 : path.at.segment + 1;
            path.at.laps += last;
            path.at.parameter = 0;
        } else if (path.at.parameter < 0 && (closed || !first)) {
            path.at.segment = first ? path.segments - 1 : path.at.segment - 1;
            path.at.laps -= first;
            path.at.parameter = 1;
        } else if (step < kEnough && step > -kEnough) {
            break;
        }
    }
    // Where a closed curve begins, its end is as near.
    if (begins) path.at.laps = 0;
}

double travelAlong(const PathRows& path) {
    const float t = path.at.parameter, inside = t < 0 ? 0 : t > 1 ? 1 : t;
    const double beyond =
        static_cast<double>(t - inside) * static_cast<double>(length(cubicAt(path, path.at.segment, inside).first));
    return static_cast<double>(path.at.laps) * static_cast<double>(path.length) +
           static_cast<double>(path.start[path.at.segment]) + lengthTo(path, path.at.segment, inside) + beyond;
}

/// B's anchor stays across the curve where it is nearest. As it travels the tangent turns, κ per metre, and so does
/// what is aligned with it: its rows take ω − (t × κ) ṡ.
void writePath(AxesWriter& write, PathRows& path, const JointPlace& place) {
    const Vec3 p = inverseRotate(place.a, place.gap);
    follow(path, p);
    const CurvePoint at = curvePoint(path, path.at.segment, path.at.parameter);
    const Vec3 tangent = rotate(place.a, at.tangent), off = rotate(place.a, p - at.place);
    path.at.across = normalized(path.at.across - dot(path.at.across, at.tangent) * at.tangent, perpendicular(at.tangent));
    const Vec3 n = rotate(place.a, path.at.across), b = cross(tangent, n);
    write.rigid(travelRow(n, place.gap), dot(off, n));
    write.rigid(travelRow(b, place.gap), dot(off, b));
    const PairVector along = travelRow(tangent, place.gap);
    if (path.align) {
        const Vec3 xB = rotate(place.b, {1, 0, 0}), error = axisError(tangent, xB);
        const Vec3 turning = rotate(place.a, cross(at.tangent, at.curvature));
        const Vec3 y = normalized(n - dot(n, xB) * xB, perpendicular(xB)), z = cross(xB, y);
        for (const Vec3& axis : {y, z}) {
            const float turn = dot(axis, turning);
            write.rigid({-turn * along.linear, axis - turn * along.angular}, dot(error, axis));
        }
    }
    write.free(along, travelAlong(path));
}

std::string whyInvalidCurve(const Curve& curve) {
    constexpr float kApart = 1e-4f;  // m, as the message says
    if (curve.closed && curve.count < 3)
        return "curve.count is " + std::to_string(curve.count) + ", must be at least 3 for a closed curve";
    for (int i = 0; i < curve.count; ++i) {
        const int next = i + 1 == curve.count ? 0 : i + 1;
        if (next == 0 && !curve.closed) break;
        const auto at = [&](int k) { return curve.points[static_cast<std::size_t>(k)]; };
        if (!(length(at(next) - at(i)) > kApart))
            return "curve.points[" + std::to_string(next) + "] is where point " + std::to_string(i) +
                   " is, must be more than 0.0001 m away";
    }
    return {};
}

}  // namespace ragtop
