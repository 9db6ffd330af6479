#include "difference_polytope.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>

#include "double_math.h"

namespace ragtop::demos {
namespace {

constexpr double kExact = 1e-9;     ///< m; solids are metres in size, and double precision leaves 1e-15 of that
constexpr double kOutside = 1e-12;  ///< m beyond a face: roundings of what lies in it are less
constexpr int kMostPoints = 2000;   ///< round solids, which have no last point, take about a hundred

const DVec3& extreme(const ConvexSolid& s, const DVec3& n) {
    return *std::max_element(s.points.begin(), s.points.end(),
                             [&](const DVec3& p, const DVec3& q) { return dot(p, n) < dot(q, n); });
}

/// The axis that a direction is least along.
DVec3 leastAlong(const DVec3& n) {
    const double x = std::abs(n.x), y = std::abs(n.y), z = std::abs(n.z);
    if (x <= y && x <= z) return {1, 0, 0};
    return y <= z ? DVec3{0, 1, 0} : DVec3{0, 0, 1};
}

}  // namespace

DifferencePolytope::DifferencePolytope(const ConvexSolid& a, const ConvexSolid& b) : a_(a), b_(b) { begin(); }

DVec3 DifferencePolytope::farthest(const DVec3& n) const {
    return extreme(a_, n) - extreme(b_, -1.0 * n) + (a_.radius + b_.radius) * n;
}

/// Two points far apart, one off their line, one off the plane of the three.
void DifferencePolytope::begin() {
    const auto unit = [](const DVec3& v) { return (1 / length(v)) * v; };
    const auto farOff = [&](const DVec3& n, const DVec3& from) {
        const DVec3 ahead = farthest(n), back = farthest(-1.0 * n);
        return dot(ahead - from, n) >= dot(from - back, n) ? ahead : back;
    };
    const DVec3 p = farthest({1, 0, 0}), q = farthest({-1, 0, 0});
    const DVec3 line = unit(q - p), across = unit(cross(line, leastAlong(line)));
    const DVec3 r = farOff(across, p);
    const DVec3 normal = unit(cross(q - p, r - p));
    const DVec3 s = farOff(normal, p);
    points_ = {p, q, r, s};
    const bool above = dot(s - p, normal) > 0;
    const int b = above ? 2 : 1, c = above ? 1 : 2;
    for (const auto& [i, j, k] : {std::array{0, b, c}, std::array{0, c, 3}, std::array{c, b, 3}, std::array{b, 0, 3}})
        addFace(i, j, k);
}

void DifferencePolytope::addFace(int a, int b, int c) {
    const auto at = [&](int i) -> const DVec3& { return points_[static_cast<std::size_t>(i)]; };
    const DVec3 product = cross(at(b) - at(a), at(c) - at(a));
    const double area = length(product);
    // Without area it has no side, and nothing sees it or is nearest to it.
    const DVec3 normal = area > 0 ? (1 / area) * product : DVec3{};
    faces_.push_back({a, b, c, normal, area > 0 ? dot(normal, at(a)) : std::numeric_limits<double>::infinity()});
}

void DifferencePolytope::expand(const DVec3& p) {
    const int added = static_cast<int>(points_.size());
    points_.push_back(p);
    seen_.clear();
    std::size_t hidden = 0;
    for (const Face& face : faces_) {
        if (dot(face.normal, p) > face.offset + kOutside)
            seen_.push_back(face);
        else
            faces_[hidden++] = face;
    }
    faces_.resize(hidden);
    const auto isSeen = [&](int from, int to) {
        return std::any_of(seen_.begin(), seen_.end(), [&](const Face& f) {
            return (f.a == from && f.b == to) || (f.b == from && f.c == to) || (f.c == from && f.a == to);
        });
    };
    for (const Face& f : seen_) {
        for (const auto& [from, to] : {std::array{f.a, f.b}, std::array{f.b, f.c}, std::array{f.c, f.a}}) {
            if (!isSeen(to, from)) addFace(from, to, added);
        }
    }
}

double DifferencePolytope::leastOverlap() {
    double least = std::numeric_limits<double>::infinity();
    while (static_cast<int>(points_.size()) < kMostPoints) {
        const Face nearest = *std::min_element(faces_.begin(), faces_.end(),
                                               [](const Face& f, const Face& g) { return f.offset < g.offset; });
        const DVec3 p = farthest(nearest.normal);
        const double overlap = dot(p, nearest.normal);
        least = std::min(least, overlap);
        if (least <= 0 || least - nearest.offset < kExact || overlap - nearest.offset < kOutside) break;
        expand(p);
    }
    return least;
}

}  // namespace ragtop::demos
