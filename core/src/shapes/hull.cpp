#include "shapes/hull.h"

#include <algorithm>
#include <stdexcept>
#include <string>
#include <tuple>

#include "base/check_tunables.h"
#include "base/double_vectors.h"
#include "shapes/hull_build.h"
#include "shapes/solid_mass.h"

namespace ragtop {
namespace {

[[noreturn]] void rejectHull(const std::string& why) { throw std::invalid_argument("ConvexHull: " + why); }

/// Without duplicates and in an order that is that of the places alone.
std::vector<Vec3> sortedPoints(std::span<const Vec3> points) {
    constexpr std::size_t kMost = 65535;  // points, whose numbers have 16 bits
    if (points.size() < 4 || points.size() > kMost) {
        rejectHull("points has " + std::to_string(points.size()) + " entries, must have 4 to 65535");
    }
    std::vector<Vec3> sorted;
    sorted.reserve(points.size());
    for (std::size_t i = 0; i < points.size(); ++i) {
        const std::string why = whyNotFinite("points[" + std::to_string(i) + "]", points[i]);
        if (!why.empty()) rejectHull(why);
        sorted.push_back(points[i] + Vec3{});  // −0 + 0 is 0
    }
    std::sort(sorted.begin(), sorted.end(),
              [](const Vec3& a, const Vec3& b) { return std::tie(a.x, a.y, a.z) < std::tie(b.x, b.y, b.z); });
    sorted.erase(std::unique(sorted.begin(), sorted.end()), sorted.end());
    return sorted;
}

/// About the middle of their bounds, times the power of two that makes the largest coordinate at most 1.
std::vector<DVec3> normalizedPoints(const std::vector<Vec3>& points) {
    Vec3 lower = points[0], upper = points[0];
    for (const Vec3& p : points) {
        lower = min(lower, p);
        upper = max(upper, p);
    }
    const DVec3 middle = 0.5 * (DVec3(lower) + DVec3(upper));
    const DVec3 half = DVec3(upper) - middle;
    const double size = std::max({half.x, half.y, half.z});
    if (!(size > 0)) rejectHull("points are all at one place, must span a volume");
    int exponent = 0;
    std::frexp(size, &exponent);
    const double scale = std::ldexp(1.0, -exponent);
    std::vector<DVec3> result;
    result.reserve(points.size());
    for (const Vec3& p : points) result.push_back(scale * (DVec3(p) - middle));
    return result;
}

/// How far the points reach to both sides of the plane through three of them that are far apart.
double thickness(const std::vector<DVec3>& points) {
    const auto farthest = [&](auto&& measure) {
        std::size_t best = 0;
        for (std::size_t i = 1; i < points.size(); ++i) {
            if (measure(points[i]) > measure(points[best])) best = i;
        }
        return points[best];
    };
    const DVec3 a = farthest([&](const DVec3& p) { return dot(p - points[0], p - points[0]); });
    const DVec3 b = farthest([&](const DVec3& p) { return dot(p - a, p - a); });
    const auto fromLine = [&](const DVec3& p) {
        const DVec3 n = cross(b - a, p - a);
        return dot(n, n);
    };
    const DVec3 c = farthest(fromLine);
    const DVec3 n = cross(b - a, c - a);
    const double area = std::sqrt(dot(n, n));
    if (!(area > 1e-5 * dot(b - a, b - a))) return 0;
    return std::abs(dot(n, farthest([&](const DVec3& p) { return std::abs(dot(n, p - a)); }) - a)) / area;
}

std::vector<int> usedIndices(const std::vector<HullTriangle>& triangles) {
    std::vector<int> used;
    for (const HullTriangle& t : triangles) used.insert(used.end(), t.begin(), t.end());
    std::sort(used.begin(), used.end());
    used.erase(std::unique(used.begin(), used.end()), used.end());
    return used;
}

/// The i-th direction of a sequence that covers the sphere evenly, the axes first [Roberts, The Unreasonable
/// Effectiveness of Quasirandom Sequences, 2018].
DVec3 directionOf(int i) {
    if (i < 6) {
        const double sign = i % 2 ? -1 : 1;
        return {i / 2 == 0 ? sign : 0, i / 2 == 1 ? sign : 0, i / 2 == 2 ? sign : 0};
    }
    const double u = 0.7548776662466927 * i, v = 0.5698402909980532 * i;
    const double z = 2 * (u - std::floor(u)) - 1;
    const double r = std::sqrt(1 - z * z);
    const SinCos turn = sinCos(static_cast<float>(2 * static_cast<double>(kPi) * (v - std::floor(v))));
    return {r * static_cast<double>(turn.cos), r * static_cast<double>(turn.sin), z};
}

/// At most kMaxHullVertices of the candidates, those farthest along the directions of the sequence.
std::vector<int> outermost(const std::vector<DVec3>& points, const std::vector<int>& candidates) {
    constexpr int kDirections = 4096;  // 32 for each corner that a hull may have
    std::vector<int> kept;
    for (int i = 0; i < kDirections && kept.size() < kMaxHullVertices; ++i) {
        const DVec3 direction = directionOf(i);
        const int best = *std::max_element(candidates.begin(), candidates.end(), [&](int a, int b) {
            return dot(direction, points[static_cast<std::size_t>(a)]) <
                   dot(direction, points[static_cast<std::size_t>(b)]);
        });
        if (std::find(kept.begin(), kept.end(), best) == kept.end()) kept.push_back(best);
    }
    std::sort(kept.begin(), kept.end());
    return kept;
}

template <class T>
std::vector<T> select(const std::vector<T>& values, const std::vector<int>& indices) {
    std::vector<T> result;
    result.reserve(indices.size());
    for (const int i : indices) result.push_back(values[static_cast<std::size_t>(i)]);
    return result;
}

/// Points of single precision that were coplanar are so to about 1e-7 of the coordinates; tools round more coarsely.
constexpr double kFlatness = 1.0 / 32768;

std::vector<std::vector<int>> facesOf(const std::vector<DVec3>& points, const std::vector<HullTriangle>& triangles,
                                      double thick) {
    for (double tolerance = std::min(kFlatness, 0.01 * thick); tolerance > 1e-12; tolerance *= 0.125) {
        std::vector<std::vector<int>> faces = mergeFaces(points, triangles, tolerance);
        if (!faces.empty()) return faces;
    }
    std::vector<std::vector<int>> faces;
    for (const HullTriangle& t : triangles) faces.push_back({t[0], t[1], t[2]});
    return faces;
}

/// Newell's normal of each loop; the offset holds all vertices.
void addPlanes(HullData& hull) {
    for (const HullData::Face& face : hull.faces) {
        const auto at = [&](int i) {
            return DVec3(hull.vertices[hull.faceIndices[static_cast<std::size_t>(face.firstIndex + i % face.count)]]);
        };
        DVec3 n;
        for (int i = 1; i + 1 < face.count; ++i) n = n + cross(at(i) - at(0), at(i + 1) - at(0));
        const Vec3 normal = toVec3((1 / std::sqrt(dot(n, n))) * n);
        double offset = -std::numeric_limits<double>::infinity();
        for (const Vec3& v : hull.vertices) offset = std::max(offset, dot(DVec3(normal), DVec3(v)));
        hull.planes.push_back({normal, static_cast<float>(offset)});
    }
}

void addEdges(HullData& hull) {
    struct Side {
        std::uint8_t from, to, face;
    };
    std::vector<Side> sides;
    for (std::size_t f = 0; f < hull.faces.size(); ++f) {
        const HullData::Face& face = hull.faces[f];
        for (int i = 0; i < face.count; ++i) {
            sides.push_back({hull.faceIndices[static_cast<std::size_t>(face.firstIndex + i)],
                             hull.faceIndices[static_cast<std::size_t>(face.firstIndex + (i + 1) % face.count)],
                             static_cast<std::uint8_t>(f)});
        }
    }
    // The two that run along one edge, from the lower to the upper vertex first.
    std::sort(sides.begin(), sides.end(), [](const Side& a, const Side& b) {
        const auto key = [](const Side& s) {
            return std::tuple(std::min(s.from, s.to), std::max(s.from, s.to), s.from);
        };
        return key(a) < key(b);
    });
    for (std::size_t i = 0; i + 1 < sides.size(); i += 2)
        hull.edges.push_back({sides[i].from, sides[i].to, sides[i].face, sides[i + 1].face});
}

void addMeasures(HullData& hull) {
    hull.center = toVec3(massOfHull(hull, 1).center);
    hull.bounds = {hull.vertices[0], hull.vertices[0]};
    for (const Vec3& v : hull.vertices) hull.bounds = merge(hull.bounds, {v, v});
    hull.innerRadius = std::numeric_limits<float>::infinity();
    for (const Plane& plane : hull.planes) {
        hull.innerRadius = std::min(hull.innerRadius, plane.offset - dot(plane.normal, hull.center));
    }
}

HullData assemble(const std::vector<Vec3>& points, const std::vector<std::vector<int>>& faces) {
    HullData hull;
    std::vector<int> used;
    for (const std::vector<int>& face : faces) used.insert(used.end(), face.begin(), face.end());
    std::sort(used.begin(), used.end());
    used.erase(std::unique(used.begin(), used.end()), used.end());
    hull.vertices = select(points, used);
    for (const std::vector<int>& face : faces) {
        hull.faces.push_back(
            {static_cast<std::uint16_t>(hull.faceIndices.size()), static_cast<std::uint16_t>(face.size())});
        for (const int v : face) {
            const auto at = std::lower_bound(used.begin(), used.end(), v) - used.begin();
            hull.faceIndices.push_back(static_cast<std::uint8_t>(at));
        }
    }
    addPlanes(hull);
    addEdges(hull);
    addMeasures(hull);
    return hull;
}

}  // namespace

HullData boxHull(const Vec3& halfExtents) {
    const BoxHull box(halfExtents);
    HullData hull;
    hull.vertices.assign(box.vertices.begin(), box.vertices.end());
    hull.planes.assign(box.planes.begin(), box.planes.end());
    hull.faces.assign(box_topology::kFaces.begin(), box_topology::kFaces.end());
    hull.faceIndices.assign(box_topology::kFaceIndices.begin(), box_topology::kFaceIndices.end());
    hull.edges.assign(box_topology::kEdges.begin(), box_topology::kEdges.end());
    hull.innerRadius = box.innerRadius;
    hull.bounds = {-halfExtents, halfExtents};
    return hull;
}

ConvexHull::ConvexHull(std::span<const Vec3> points) {
    std::vector<Vec3> places = sortedPoints(points);
    std::vector<DVec3> normalized = normalizedPoints(places);
    const double thick = thickness(normalized);
    constexpr double kFlat = 1e-5;  // of the size: eighty roundings of a float
    if (!(thick > kFlat)) {
        rejectHull("points all lie in a plane to within " + numberText(static_cast<float>(thick)) +
                   " of their size, must span a volume");
    }
    std::vector<HullTriangle> triangles = convexTriangles(normalized);
    if (const std::vector<int> used = usedIndices(triangles); used.size() > kMaxHullVertices) {
        const std::vector<int> kept = outermost(normalized, used);
        places = select(places, kept);
        normalized = select(normalized, kept);
        triangles = convexTriangles(normalized);
    }
    data_ = std::make_shared<const HullData>(assemble(places, facesOf(normalized, triangles, thick)));
}

std::span<const Vec3> ConvexHull::vertices() const { return data_->vertices; }

}  // namespace ragtop
