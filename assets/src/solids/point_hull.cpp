#include "solids/point_hull.h"

#include <algorithm>
#include <limits>
#include <stdexcept>
#include <tuple>

#include "solids/quick_hull.h"

namespace ragtop {
namespace {

/// How far points reach off the plane through three of them that are far apart.
double thicknessOf(const std::vector<DVec3>& points) {
    const auto farthest = [&](auto&& measure) {
        return *std::max_element(points.begin(), points.end(),
                                 [&](const DVec3& p, const DVec3& q) { return measure(p) < measure(q); });
    };
    const DVec3 a = farthest([&](const DVec3& p) { return dot(p - points[0], p - points[0]); });
    const DVec3 b = farthest([&](const DVec3& p) { return dot(p - a, p - a); });
    const auto off = [&](const DVec3& p) {
        const DVec3 n = cross(b - a, p - a);
        return dot(n, n);
    };
    const DVec3 n = cross(b - a, farthest(off) - a);
    const double area = length(n);
    if (!(area > 0)) return 0;
    return std::abs(dot(n, farthest([&](const DVec3& p) { return std::abs(dot(n, p - a)); }) - a)) / area;
}

/// Of points by rising x those that are apart: triangles between others would face anywhere.
std::vector<DVec3> withoutTwins(const std::vector<DVec3>& points) {
    constexpr double kApart = 1e-7;
    std::vector<DVec3> apart;
    for (const DVec3& p : points) {
        bool twin = false;
        for (auto q = apart.rbegin(); q != apart.rend() && p.x - q->x < kApart && !twin; ++q)
            twin = std::abs(p.y - q->y) < kApart && std::abs(p.z - q->z) < kApart;
        if (!twin) apart.push_back(p);
    }
    return apart;
}

void keepCorners(PointHull& hull) {
    std::vector<int> place(hull.points.size(), -1);
    std::vector<DVec3> corners;
    for (HullTriangle& t : hull.triangles) {
        for (int& i : t) {
            int& at = place[static_cast<std::size_t>(i)];
            if (at < 0)
                at = static_cast<int>(corners.size()), corners.push_back(hull.points[static_cast<std::size_t>(i)]);
            i = at;
        }
    }
    hull.points = std::move(corners);
}

double volumeWithin(const std::vector<DVec3>& points, const std::vector<HullTriangle>& triangles) {
    const auto from = [&](int i) { return points[static_cast<std::size_t>(i)] - points[0]; };
    double sixfold = 0;
    for (const HullTriangle& t : triangles) sixfold += dot(from(t[0]), cross(from(t[1]), from(t[2])));
    return sixfold / 6;
}

/// Through three corners; a triangle so thin that rounding turns it gets a plane that all points are behind.
DPlane planeOver(const std::vector<DVec3>& points, const DVec3& a, const DVec3& b, const DVec3& c) {
    constexpr double kNarrow = 1e-3;  // corners are up to 1e-8 off the planes of their neighbours
    const DVec3 n = cross(b - a, c - a);
    const double area = length(n),
                 longest = std::sqrt(std::max({dot(b - a, b - a), dot(c - a, c - a), dot(c - b, c - b)}));
    const DVec3 normal = area > 0 ? (1 / area) * n : DVec3{1, 0, 0};
    double offset = std::max({dot(normal, a), dot(normal, b), dot(normal, c)});
    if (area < kNarrow * longest)
        for (const DVec3& p : points) offset = std::max(offset, dot(normal, p));
    return {normal, offset};
}

void addPlanes(PointHull& hull) {
    hull.volume = volumeWithin(hull.points, hull.triangles);
    for (const HullTriangle& t : hull.triangles) {
        const DVec3 a = hull.points[static_cast<std::size_t>(t[0])], b = hull.points[static_cast<std::size_t>(t[1])],
                    c = hull.points[static_cast<std::size_t>(t[2])];
        hull.planes.push_back(planeOver(hull.points, a, b, c));
    }
}

}  // namespace

PointHull hullOf(std::vector<DVec3> points) {
    constexpr double kFlat = 1e-6;  // half of kOnPlane: flatter parts are what a cut along a face leaves
    const auto place = [](const DVec3& p) { return std::tie(p.x, p.y, p.z); };
    std::sort(points.begin(), points.end(), [&](const DVec3& p, const DVec3& q) { return place(p) < place(q); });
    PointHull hull;
    hull.points = withoutTwins(points);
    if (hull.points.size() < 4 || !(thicknessOf(hull.points) > kFlat)) return hull;
    hull.triangles = quickHull(hull.points);
    if (hull.triangles.empty()) {
        try {
            hull.triangles = convexTriangles(hull.points);
        } catch (const std::invalid_argument&) {
            return hull;  // too thin for Qhull
        }
    }
    keepCorners(hull);
    addPlanes(hull);
    return hull;
}

HullSize hullSize(const std::vector<DVec3>& points) {
    const std::vector<HullTriangle> triangles = quickHull(points);
    if (!triangles.empty()) return {volumeWithin(points, triangles), triangles.size() / 2 + 2};  // Euler's formula
    const PointHull hull = hullOf(points);
    return {hull.volume, hull.points.size()};
}

double heightOver(const PointHull& hull, const DVec3& p, double enough) {
    double highest = -std::numeric_limits<double>::infinity();
    for (auto plane = hull.planes.begin(); plane != hull.planes.end() && highest < enough; ++plane)
        highest = std::max(highest, plane->height(p));
    return highest;
}

}  // namespace ragtop
