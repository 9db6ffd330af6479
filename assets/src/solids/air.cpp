#include "solids/air.h"

#include <algorithm>

namespace ragtop {
namespace {

constexpr double kFar = 4;      // solids are about 1 large
constexpr double kSkip = 1e-6;  // a ray begins on its own triangle
constexpr double kRays = 3000;  // about that many: of a solid of size 1 one every 3 cm or less

/// Points evenly over a triangle in barycentric coordinates: an additive sequence, folded [Roberts, The Unreasonable
/// Effectiveness of Quasirandom Sequences, 2018].
DVec3 pointOf(const std::array<DVec3, 3>& t, int i) {
    double u = 0.7548776662466927 * (i + 0.5), v = 0.5698402909980532 * (i + 0.5);
    u -= std::floor(u), v -= std::floor(v);
    if (u + v > 1) u = 1 - u, v = 1 - v;
    return t[0] + u * (t[1] - t[0]) + v * (t[2] - t[0]);
}

}  // namespace

Air::Air(const CutSolid& solid) : surface_(solid.vertices, solid.triangles) {
    const auto corners = [&](const Triangle& t) {
        return std::array<DVec3, 3>{solid.vertices[t.a], solid.vertices[t.b], solid.vertices[t.c]};
    };
    const auto areaVector = [](const std::array<DVec3, 3>& t) { return 0.5 * cross(t[1] - t[0], t[2] - t[0]); };
    double total = 0;
    for (const Triangle& t : solid.triangles) total += length(areaVector(corners(t)));
    double owed = 0;
    for (const Triangle& t : solid.triangles) {
        const std::array<DVec3, 3> c = corners(t);
        const DVec3 n = areaVector(c);
        const double area = length(n);
        if (!(area > 0)) continue;
        owed += kRays * area / total;
        const int count = static_cast<int>(owed);
        owed -= count;
        for (int i = 0; i < count; ++i) add(i == 0 ? (1.0 / 3) * (c[0] + c[1] + c[2]) : pointOf(c, i), (1 / area) * n);
    }
}

void Air::add(const DVec3& from, const DVec3& direction) {
    Ray ray{from, direction};
    ray.length = surface_.freePath(from, direction, kSkip, kFar);
    ray.open = ray.length >= kFar;
    rays_.push_back(ray);
}

double Air::depthIn(const PointHull& hull, double enough) const {
    double deepest = 0;
    if (hull.points.empty()) return 0;
    DVec3 lower = hull.points[0], upper = lower;
    for (const DVec3& p : hull.points) lower = lowest(lower, p), upper = highest(upper, p);
    for (const Ray& ray : rays_) {
        const DVec3& p = ray.from;
        if (p.x < lower.x || p.y < lower.y || p.z < lower.z || p.x > upper.x || p.y > upper.y || p.z > upper.z)
            continue;
        double exit = ray.open ? ray.length : ray.length / 2;
        for (const DPlane& plane : hull.planes) {
            const double height = plane.height(ray.from), speed = dot(plane.normal, ray.direction);
            if (height > 0) exit = 0;
            if (speed > 0) exit = std::min(exit, -height / speed);
            if (exit <= deepest) break;
        }
        if (exit > deepest) deepest = std::max(deepest, surface_.distance(ray.from + exit * ray.direction, exit));
        if (deepest > enough) break;
    }
    return deepest;
}

}  // namespace ragtop
