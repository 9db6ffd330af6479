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
    // Tilted, since rays from middles of triangles meet edges of those that lie alike.
    const DVec3 tilted = direction + DVec3{0.0137, -0.0071, 0.0113};
    if (surface_.winding(from, tilted, kSkip) > 0) return;  // begins inside of another part
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

bool Air::leadsThroughAir(const Ray& from, const DVec3& to, double error, int& effort) const {
    const double far = length(to - from.from);
    if (!(far > 2 * error)) return false;
    const DVec3 way = (1 / far) * (to - from.from);
    constexpr double kOutwards = 1e-3;  // sine of the angle from the surface: what runs along it sees no air
    if (dot(way, from.direction) < kOutwards) return false;
    const double path = surface_.freePath(from.from, way, kSkip, far);
    constexpr double kStep = 0.3;  // of the error, where it is nearly reached
    for (double at = error; at < path && effort > 0; --effort) {
        const double distance = surface_.distance(from.from + at * way, 2 * error);
        if (distance > error) return true;
        at += std::max(error - distance, kStep * error);
    }
    --effort;
    return false;
}

/// Beginning with a point, and always next to the one before: so that many find room.
std::size_t Air::countApart(std::vector<const Ray*> rest, const Ray& first, double error, std::size_t most,
                            int& effort) const {
    const Ray* last = &first;
    std::size_t count = 1;
    for (; count <= most; ++count) {
        std::erase_if(rest, [&](const Ray* other) {
            return !leadsThroughAir(*last, other->from, error, effort) &&
                   !leadsThroughAir(*other, last->from, error, effort);
        });
        if (rest.empty()) break;
        const auto far = [&](const Ray* r) { return dot(r->from - last->from, r->from - last->from); };
        last = *std::min_element(rest.begin(), rest.end(), [&](const Ray* a, const Ray* b) { return far(a) < far(b); });
    }
    return count;
}

std::size_t Air::fewestPieces(double error, std::size_t most) const {
    constexpr std::size_t kPoints = 300, kStarts = 10;
    constexpr double kGolden = 0.6180339887498949;  // its multiples are spread evenly
    std::vector<const Ray*> all;
    for (std::size_t k = 0; k < std::min(kPoints, rays_.size()); ++k) {
        const double turns = kGolden * static_cast<double>(k);
        all.push_back(
            &rays_[static_cast<std::size_t>((turns - std::floor(turns)) * static_cast<double>(rays_.size()))]);
    }
    int effort = 20000;  // distances, of which each takes microseconds: afterwards no two points are apart
    std::size_t best = 1;
    for (std::size_t start = 0; start < std::min(kStarts, all.size()) && best <= most; ++start)
        best = std::max(best, countApart(all, *all[start], error, most, effort));
    return best;
}

}  // namespace ragtop
