#include "solids/point_hull.h"

#include <algorithm>
#include <limits>
#include <stdexcept>
#include <tuple>

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

void addPlanes(PointHull& hull) {
    const DVec3 origin = hull.points[0];
    for (const HullTriangle& t : hull.triangles) {
        const DVec3 a = hull.points[static_cast<std::size_t>(t[0])], b = hull.points[static_cast<std::size_t>(t[1])],
                    c = hull.points[static_cast<std::size_t>(t[2])];
        hull.volume += dot(a - origin, cross(b - origin, c - origin)) / 6;
        const DVec3 n = cross(b - a, c - a);
        const double area = length(n);
        if (!(area > 0)) continue;
        const DVec3 normal = (1 / area) * n;
        hull.planes.push_back({normal, std::max({dot(normal, a), dot(normal, b), dot(normal, c)})});
    }
}

}  // namespace

PointHull hullOf(std::vector<DVec3> points) {
    constexpr double kFlat = 1e-6;  // half of kOnPlane: flatter parts are what a cut along a face leaves
    const auto place = [](const DVec3& p) { return std::tie(p.x, p.y, p.z); };
    std::sort(points.begin(), points.end(), [&](const DVec3& p, const DVec3& q) { return place(p) < place(q); });
    points.erase(std::unique(points.begin(), points.end()), points.end());
    PointHull hull;
    hull.points = std::move(points);
    if (hull.points.size() < 4 || !(thicknessOf(hull.points) > kFlat)) return hull;
    try {
        hull.triangles = convexTriangles(hull.points);
    } catch (const std::invalid_argument&) {
        return hull;  // too thin for Qhull
    }
    keepCorners(hull);
    addPlanes(hull);
    return hull;
}

double heightOver(const PointHull& hull, const DVec3& p) {
    double highest = -std::numeric_limits<double>::infinity();
    for (const DPlane& plane : hull.planes) highest = std::max(highest, plane.height(p));
    return highest;
}

}  // namespace ragtop
