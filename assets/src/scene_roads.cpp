#include <cmath>

#include "scene_generators.h"

namespace ragtop {
namespace {

constexpr double kSpacing = 2;  ///< m, of the points of a centre line

/// Between b and c [Catmull, Rom, A Class of Local Interpolating Splines, 1974].
DVec3 between(const DVec3& a, const DVec3& b, const DVec3& c, const DVec3& d, double t) {
    const DVec3 linear = c - a, square = 2 * a - 5 * b + 4 * c - d, cube = 3 * (b - c) + (d - a);
    return b + 0.5 * (t * linear + (t * t) * square + (t * t * t) * cube);
}

std::vector<DVec3> centerLine(const RoadInFile& road) {
    const auto count = static_cast<int>(road.points.size());
    const auto point = [&](int i) {
        const int inside = road.closed ? (i + count) % count : std::min(std::max(i, 0), count - 1);
        return road.points[static_cast<std::size_t>(inside)];
    };
    std::vector<DVec3> line;
    const int spans = road.closed ? count : count - 1;
    for (int i = 0; i < spans; ++i) {
        const DVec3 chord = point(i + 1) - point(i);
        const double length = std::sqrt(chord.x * chord.x + chord.y * chord.y + chord.z * chord.z);
        const int steps = std::max(1, static_cast<int>(std::ceil(length / kSpacing)));
        for (int k = 0; k < steps; ++k) {
            line.push_back(between(point(i - 1), point(i), point(i + 1), point(i + 2), static_cast<double>(k) / steps));
        }
    }
    if (!road.closed) line.push_back(point(count - 1));
    return line;
}

}  // namespace

SceneBody roadBody(const RoadInFile& road, const Material& material, SceneRoad& line) {
    line = {road.name, road.closed, road.width, centerLine(road)};
    const std::size_t count = line.line.size();
    const DVec3 origin = line.line[0];
    std::vector<Vec3> vertices;
    for (std::size_t i = 0; i < count; ++i) {
        const DVec3& before = line.line[i > 0 ? i - 1 : road.closed ? count - 1 : 0];
        const DVec3& after = line.line[i + 1 < count ? i + 1 : road.closed ? 0 : count - 1];
        const Vec3 along = relative(after, before), left = normalized(Vec3{along.z, 0, -along.x});
        const Vec3 middle = relative(line.line[i], origin);
        const float foot = static_cast<float>(static_cast<double>(road.foot) - origin.y);
        const float run = std::max(middle.y - foot, 0.0f) / road.slope;
        // Left foot, both edges, right foot.
        for (const float side : {1.0f, -1.0f}) {
            const Vec3 edge = middle + (0.5f * side * road.width) * left;
            const Vec3 toe{edge.x + side * run * left.x, foot, edge.z + side * run * left.z};
            vertices.push_back(side > 0 ? toe : edge);
            vertices.push_back(side > 0 ? edge : toe);
        }
    }
    std::vector<Triangle> triangles;
    const std::size_t spans = road.closed ? count : count - 1;
    for (std::size_t i = 0; i < spans; ++i) {
        for (std::size_t strip = 0; strip < 3; ++strip) {
            const auto left = static_cast<std::uint32_t>(4 * i + strip);
            const auto next = static_cast<std::uint32_t>(4 * ((i + 1) % count) + strip);
            triangles.push_back({left + 1, next + 1, left});
            triangles.push_back({left, next + 1, next});
        }
    }
    SceneBody body;
    body.name = road.name;
    body.def.type = BodyType::fixed;
    body.def.pose.position = origin;
    body.def.shapes.push_back({.geometry = TriangleMesh(vertices, triangles), .material = material});
    return body;
}

}  // namespace ragtop
