#include <cmath>

#include "ragtop/driver.h"
#include "scene_generators.h"

namespace ragtop {
SceneBody roadBody(const RoadInFile& road, const Material& material, SceneRoad& line) {
    line = {road.name, road.closed, road.width, smoothLine(road.points, road.closed)};
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
