#include "solids/few_corners.h"

#include <algorithm>
#include <limits>
#include <tuple>

namespace ragtop {
namespace {

/// Squared distance to the nearest of some points.
double nearest(const std::vector<DVec3>& points, const DVec3& p) {
    double least = std::numeric_limits<double>::infinity();
    for (const DVec3& q : points) least = std::min(least, dot(p - q, p - q));
    return least;
}

/// Of each face the point that is farthest over it, the farthest of all first.
std::vector<DVec3> farthestOver(const PointHull& inner, const std::vector<DVec3>& points) {
    std::vector<std::tuple<double, std::size_t>> over(inner.planes.size(), {0.0, 0});
    for (std::size_t i = 0; i < points.size(); ++i) {
        double height = 0;
        std::size_t face = 0;
        for (std::size_t f = 0; f < inner.planes.size(); ++f)
            if (const double h = inner.planes[f].height(points[i]); h > height) height = h, face = f;
        if (height > 0) over[face] = std::min(over[face], std::tuple{-height, i});
    }
    std::sort(over.begin(), over.end());
    std::vector<DVec3> found;
    for (const auto& [height, i] : over)
        if (height < 0) found.push_back(points[i]);
    return found;
}

/// Corners that reach far: those along the axes, and then again and again those farthest from the hull of the ones
/// before.
std::vector<DVec3> outermost(const PointHull& hull, std::size_t most) {
    std::vector<DVec3> kept;
    const auto add = [&](const DVec3& p) {
        if (kept.size() < most && std::find(kept.begin(), kept.end(), p) == kept.end()) kept.push_back(p);
    };
    for (const DVec3& axis : {DVec3{1, 0, 0}, DVec3{0, 1, 0}, DVec3{0, 0, 1}}) {
        const auto [low, high] =
            std::minmax_element(hull.points.begin(), hull.points.end(),
                                [&](const DVec3& p, const DVec3& q) { return dot(axis, p) < dot(axis, q); });
        add(*low), add(*high);
    }
    PointHull inner = hullOf(kept);
    while (kept.size() < most && inner.planes.empty()) {
        const std::size_t before = kept.size();
        add(*std::max_element(hull.points.begin(), hull.points.end(),
                              [&](const DVec3& p, const DVec3& q) { return nearest(kept, p) < nearest(kept, q); }));
        if (kept.size() == before) break;
        inner = hullOf(kept);
    }
    while (kept.size() < most) {
        const std::vector<DVec3> next = farthestOver(inner, hull.points);
        if (next.empty()) break;
        constexpr std::size_t kShare = 4;  // of those that are still to come, at a time
        const std::size_t until = kept.size() + 1 + (most - kept.size()) / kShare;
        const std::size_t before = kept.size();
        for (std::size_t i = 0; i < next.size() && kept.size() < until; ++i) add(next[i]);
        if (kept.size() == before) break;
        inner = hullOf(kept);
    }
    return kept;
}

/// Corners moved outwards until their faces hold the points: each by the least way that takes it to where the faces
/// beside it have to go (Kaczmarz's projections). True when nothing was left out.
bool grow(PointHull& hull, const std::vector<DVec3>& points) {
    constexpr double kHeld = 1e-7;
    std::vector<double> over(hull.triangles.size(), 0);
    bool held = true;
    for (std::size_t f = 0; f < hull.planes.size(); ++f) {
        for (const DVec3& p : points) over[f] = std::max(over[f], hull.planes[f].height(p));
        held = held && over[f] <= kHeld;
    }
    if (held) return true;
    std::vector<DVec3> moves(hull.points.size());
    constexpr int kSweeps = 8;
    for (int sweep = 0; sweep < kSweeps; ++sweep) {
        for (std::size_t f = 0; f < hull.planes.size(); ++f) {
            for (const int corner : hull.triangles[f]) {
                DVec3& move = moves[static_cast<std::size_t>(corner)];
                const double lacks = over[f] - dot(hull.planes[f].normal, move);
                if (lacks > 0) move = move + lacks * hull.planes[f].normal;
            }
        }
    }
    for (std::size_t i = 0; i < moves.size(); ++i) hull.points[i] = hull.points[i] + moves[i];
    hull = hullOf(std::move(hull.points));
    return false;
}

/// About the middle of the corners, by as much as the farthest point needs.
void inflate(PointHull& hull, const std::vector<DVec3>& points) {
    DVec3 middle;
    for (const DVec3& p : hull.points) middle = middle + p;
    middle = (1.0 / static_cast<double>(hull.points.size())) * middle;
    double scale = 1;
    for (const DPlane& plane : hull.planes)
        for (const DVec3& p : points) scale = std::max(scale, dot(plane.normal, p - middle) / -plane.height(middle));
    for (DVec3& p : hull.points) p = middle + scale * (p - middle);
    hull = hullOf(std::move(hull.points));
}

}  // namespace

double airOfFewCorners(double volume, std::size_t corners, std::size_t most) {
    constexpr double kOfBall =
        5;  // over the number of corners: by so much of its volume these hulls are larger than a ball
    if (corners <= most) return 0;
    return kOfBall * volume * (1 / static_cast<double>(most) - 1 / static_cast<double>(corners));
}

PointHull holding(PointHull hull, std::vector<DVec3> points) {
    constexpr double kHeld = 2e-5;
    std::erase_if(points, [&](const DVec3& p) { return heightOver(hull, p) <= kHeld; });
    if (points.empty()) return hull;
    points.insert(points.end(), hull.points.begin(), hull.points.end());
    return hullOf(std::move(points));
}

PointHull withFewCorners(const PointHull& hull, std::size_t most) {
    if (hull.points.size() <= most || hull.planes.empty()) return hull;
    PointHull few = hullOf(outermost(hull, most));
    constexpr int kRounds = 12;
    for (int round = 0; round < kRounds; ++round) {
        if (grow(few, hull.points)) return few;
    }
    inflate(few, hull.points);
    return few;
}

}  // namespace ragtop
