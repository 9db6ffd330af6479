#include <algorithm>
#include <tuple>

#include "solids/cut_search.h"

namespace ragtop {
namespace {

constexpr double kBend = 0.01;          // sine of the least concave angle that counts
constexpr double kSameNormal = 0.9995;  // cosine
constexpr double kSameOffset = 2e-3;
constexpr std::size_t kMostConcave = 12, kMostPairs = 8, kAcross = 5;

struct WeighedPlane {
    DPlane plane;
    double weight = 0;
};

struct Side {
    std::uint32_t low, high, triangle;
    bool reversed;
};

DVec3 normalOf(const CutSolid& solid, std::uint32_t triangle) {
    const Triangle& t = solid.triangles[triangle];
    const DVec3 n = cross(solid.vertices[t.b] - solid.vertices[t.a], solid.vertices[t.c] - solid.vertices[t.a]);
    const double area = length(n);
    return area > 0 ? (1 / area) * n : DVec3{};
}

std::vector<Side> sidesOf(const CutSolid& solid) {
    std::vector<Side> sides;
    for (std::uint32_t i = 0; i < solid.triangles.size(); ++i) {
        const Triangle& t = solid.triangles[i];
        for (const auto& [a, b] : {std::pair{t.a, t.b}, {t.b, t.c}, {t.c, t.a}})
            sides.push_back({std::min(a, b), std::max(a, b), i, a > b});
    }
    std::sort(sides.begin(), sides.end(), [](const Side& a, const Side& b) {
        return std::tie(a.low, a.high, a.reversed, a.triangle) < std::tie(b.low, b.high, b.reversed, b.triangle);
    });
    return sides;
}

void add(std::vector<WeighedPlane>& planes, const DVec3& normal, const DVec3& at, double weight) {
    for (WeighedPlane& known : planes) {
        const double c = dot(known.plane.normal, normal);
        if (std::abs(c) < kSameNormal || std::abs(known.plane.height(at)) > kSameOffset) continue;
        known.weight += weight;
        return;
    }
    planes.push_back({{normal, dot(normal, at)}, weight});
}

std::vector<DPlane> heaviest(std::vector<WeighedPlane> planes, std::size_t most) {
    std::sort(planes.begin(), planes.end(), [](const WeighedPlane& a, const WeighedPlane& b) {
        const auto key = [](const WeighedPlane& p) {
            return std::tuple{-p.weight, p.plane.normal.x, p.plane.normal.y, p.plane.normal.z, p.plane.offset};
        };
        return key(a) < key(b);
    });
    std::vector<DPlane> best;
    for (const WeighedPlane& p : planes)
        if (best.size() < most) best.push_back(p.plane);
    return best;
}

/// Along the faces beside concave edges, and between them. What bends most along the longest edges is worth most.
std::vector<DPlane> concavePlanes(const CutSolid& solid, const std::vector<ConcaveEdge>& concave) {
    constexpr std::size_t kMost = 2000;  // of a rough surface any edges will do
    constexpr double kBetween = 0.5;     // faces come first: of cuts that are as good, the first is taken
    std::vector<WeighedPlane> planes;
    for (const ConcaveEdge& edge : concave) {
        const DVec3 at = solid.vertices[edge.a];
        add(planes, edge.left, at, edge.weight);
        add(planes, edge.right, at, edge.weight);
        const DVec3 between = edge.left - edge.right;
        if (const double size = length(between); size > kBend)
            add(planes, (1 / size) * between, at, kBetween * edge.weight);
        if (planes.size() > kMost) break;
    }
    return heaviest(std::move(planes), kMostConcave);
}

/// Does a way from a concave edge lead into the solid?
bool leadsIn(const ConcaveEdge& edge, const DVec3& way) {
    return dot(way, edge.left) < -kBend || dot(way, edge.right) < -kBend;
}

using Rows = std::array<std::array<double, 3>, 3>;

/// Directions in which a symmetric matrix only stretches, by Jacobi's rotations.
std::array<DVec3, 3> principalAxes(Rows m) {
    Rows v{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
    constexpr int kSweeps = 8;  // to rounding
    for (int sweep = 0; sweep < kSweeps; ++sweep) {
        for (const auto& [p, q] : {std::pair<std::size_t, std::size_t>{0, 1}, {0, 2}, {1, 2}}) {
            if (m[p][q] == 0) continue;
            const double theta = (m[q][q] - m[p][p]) / (2 * m[p][q]);
            const double t = (theta < 0 ? -1 : 1) / (std::abs(theta) + std::sqrt(theta * theta + 1));
            const double c = 1 / std::sqrt(t * t + 1), s = t * c;
            for (std::size_t k = 0; k < 3; ++k) {
                const double a = m[k][p], b = m[k][q];
                m[k][p] = c * a - s * b, m[k][q] = s * a + c * b;
            }
            for (std::size_t k = 0; k < 3; ++k) {
                const double a = m[p][k], b = m[q][k];
                m[p][k] = c * a - s * b, m[q][k] = s * a + c * b;
                const double x = v[k][p], y = v[k][q];
                v[k][p] = c * x - s * y, v[k][q] = s * x + c * y;
            }
        }
    }
    const auto column = [&](std::size_t k) { return DVec3{v[0][k], v[1][k], v[2][k]}; };
    return {column(0), column(1), column(2)};
}

/// Of the surface, by area.
std::array<DVec3, 3> ownAxes(const CutSolid& solid) {
    double total = 0;
    DVec3 sum;
    Rows second{};
    for (std::uint32_t i = 0; i < solid.triangles.size(); ++i) {
        const Triangle& t = solid.triangles[i];
        const DVec3 a = solid.vertices[t.a], b = solid.vertices[t.b], c = solid.vertices[t.c];
        const double area = length(cross(b - a, c - a));
        const DVec3 middle = (1.0 / 3) * (a + b + c);
        total += area;
        sum = sum + area * middle;
        const std::array<double, 3> m{middle.x, middle.y, middle.z};
        for (std::size_t r = 0; r < 3; ++r)
            for (std::size_t k = 0; k < 3; ++k) second[r][k] += area * m[r] * m[k];
    }
    if (!(total > 0)) return principalAxes({});
    const std::array<double, 3> mean{sum.x / total, sum.y / total, sum.z / total};
    for (std::size_t r = 0; r < 3; ++r)
        for (std::size_t k = 0; k < 3; ++k) second[r][k] = second[r][k] / total - mean[r] * mean[k];
    return principalAxes(second);
}

}  // namespace

std::vector<ConcaveEdge> concaveEdges(const CutSolid& solid) {
    std::vector<ConcaveEdge> concave;
    const std::vector<Side> sides = sidesOf(solid);
    for (std::size_t i = 0; i + 1 < sides.size(); ++i) {
        const Side &l = sides[i], &r = sides[i + 1];
        if (l.low != r.low || l.high != r.high || l.reversed == r.reversed) continue;
        const DVec3 along = solid.vertices[l.high] - solid.vertices[l.low];
        const DVec3 left = normalOf(solid, l.triangle), right = normalOf(solid, r.triangle);
        const double reach = length(along);
        if (!(reach > 0)) continue;
        const double bend = -dot(cross(left, right), along) / reach;
        if (bend > kBend || (bend > 0 && dot(left, right) < 0))
            concave.push_back({l.low, l.high, left, right, reach * length(left - right)});
    }
    return concave;
}

std::vector<DPlane> pairPlanes(const CutSolid& solid, std::vector<ConcaveEdge> concave) {
    constexpr std::size_t kMost = 64;  // edges, of which each meets each
    constexpr double kNear = 1e-3;
    std::sort(concave.begin(), concave.end(), [](const ConcaveEdge& a, const ConcaveEdge& b) {
        return std::tuple{-a.weight, a.a, a.b} < std::tuple{-b.weight, b.a, b.b};
    });
    concave.resize(std::min(concave.size(), kMost));
    std::vector<WeighedPlane> planes;
    for (const ConcaveEdge& one : concave)
        for (const ConcaveEdge& other : concave) {
            if (std::pair{other.a, other.b} <= std::pair{one.a, one.b}) continue;
            const DVec3 at = solid.vertices[one.a], there = solid.vertices[other.a];
            const DVec3 along = solid.vertices[one.b] - at, alike = solid.vertices[other.b] - there;
            const double reach = length(along);
            if (std::abs(dot(along, alike)) < kSameNormal * reach * length(alike)) continue;
            const DVec3 unit = (1 / reach) * along, way = (there - at) - dot(there - at, unit) * unit;
            const double far = length(way);
            if (far < kNear || !leadsIn(one, (1 / far) * way) || !leadsIn(other, (-1 / far) * way)) continue;
            add(planes, (1 / far) * cross(unit, way), at, (one.weight + other.weight) / far);
        }
    return heaviest(std::move(planes), kMostPairs);
}

std::vector<DPlane> planesToTry(const CutSolid& solid, const std::vector<ConcaveEdge>& concave) {
    std::vector<DPlane> planes = concavePlanes(solid, concave);
    for (const DPlane& plane : pairPlanes(solid, concave)) planes.push_back(plane);
    std::vector<DVec3> axes{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    for (const DVec3& own : ownAxes(solid)) {
        const bool known = std::any_of(axes.begin(), axes.end(),
                                       [&](const DVec3& axis) { return std::abs(dot(axis, own)) > kSameNormal; });
        if (!known) axes.push_back(own);
    }
    for (const DVec3& axis : axes) {
        double low = dot(axis, solid.vertices[0]), high = low;
        for (const DVec3& p : solid.vertices) low = std::min(low, dot(axis, p)), high = std::max(high, dot(axis, p));
        for (std::size_t i = 1; i <= kAcross; ++i)
            planes.push_back({axis, low + (high - low) * static_cast<double>(i) / (kAcross + 1)});
    }
    return planes;
}

}  // namespace ragtop
