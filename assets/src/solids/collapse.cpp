#include "solids/collapse.h"

#include <meshoptimizer.h>

#include <algorithm>
#include <array>
#include <map>
#include <tuple>

#include "solids/vectors.h"

namespace ragtop {
namespace {

/// Two triangles without area back to back enclose nothing, and reach beyond the surface.
void dropSpikes(WeldedSurface& surface) {
    const auto isFlat = [&](const Triangle& t) {
        const DVec3 a(surface.vertices[t.a]), u = DVec3(surface.vertices[t.b]) - a,
                                              v = DVec3(surface.vertices[t.c]) - a;
        constexpr double kSine = 1e-9;
        return dot(cross(u, v), cross(u, v)) <= kSine * kSine * dot(u, u) * dot(v, v);
    };
    std::map<std::array<std::uint32_t, 3>, std::array<std::vector<std::size_t>, 2>> flat;  // by winding
    for (std::size_t i = 0; i < surface.triangles.size(); ++i) {
        const Triangle& t = surface.triangles[i];
        if (!isFlat(t)) continue;
        std::array<std::uint32_t, 3> corners{t.a, t.b, t.c};
        std::rotate(corners.begin(), std::min_element(corners.begin(), corners.end()), corners.end());
        const bool falls = corners[1] > corners[2];
        if (falls) std::swap(corners[1], corners[2]);
        flat[corners][falls].push_back(i);
    }
    std::vector<bool> gone(surface.triangles.size(), false);
    for (const auto& [corners, ways] : flat)
        for (std::size_t k = 0; k < std::min(ways[0].size(), ways[1].size()); ++k)
            gone[ways[0][k]] = gone[ways[1][k]] = true;
    std::size_t count = 0;
    for (std::size_t i = 0; i < gone.size(); ++i)
        if (!gone[i]) surface.triangles[count++] = surface.triangles[i];
    surface.triangles.resize(count);
}

/// A vertex of no triangle would be a body without volume.
void keepUsed(WeldedSurface& surface) {
    std::vector<std::uint32_t> name(surface.vertices.size(), 0);
    for (const Triangle& t : surface.triangles) name[t.a] = name[t.b] = name[t.c] = 1;
    std::uint32_t count = 0;
    for (std::size_t i = 0; i < name.size(); ++i) {
        if (name[i] == 0) continue;
        surface.vertices[count] = surface.vertices[i];
        name[i] = count++;
    }
    surface.vertices.resize(count);
    for (Triangle& t : surface.triangles) t = {name[t.a], name[t.b], name[t.c]};
}

}  // namespace

WeldedSurface welded(std::span<const Vec3> vertices, std::span<const Triangle> triangles) {
    const auto place = [](const Vec3& p) { return std::tuple{p.x, p.y, p.z}; };
    std::vector<std::uint32_t> order(vertices.size());
    for (std::uint32_t i = 0; i < order.size(); ++i) order[i] = i;
    std::sort(order.begin(), order.end(), [&](std::uint32_t i, std::uint32_t j) {
        return std::tuple{place(vertices[i]), i} < std::tuple{place(vertices[j]), j};
    });
    WeldedSurface surface;
    std::vector<std::uint32_t> name(vertices.size());
    for (std::size_t k = 0; k < order.size(); ++k) {
        if (k == 0 || vertices[order[k]] != vertices[order[k - 1]]) surface.vertices.push_back(vertices[order[k]]);
        name[order[k]] = static_cast<std::uint32_t>(surface.vertices.size() - 1);
    }
    for (const Triangle& t : triangles) {
        const Triangle n{name[t.a], name[t.b], name[t.c]};
        if (n.a != n.b && n.b != n.c && n.c != n.a) surface.triangles.push_back(n);
    }
    dropSpikes(surface);
    keepUsed(surface);
    return surface;
}

WeldedSurface collapsed(const WeldedSurface& surface, std::size_t target, float error) {
    static_assert(sizeof(Triangle) == 3 * sizeof(unsigned int) && sizeof(Vec3) == 3 * sizeof(float));
    const float* places = &surface.vertices[0].x;
    const float scale = meshopt_simplifyScale(places, surface.vertices.size(), sizeof(Vec3));
    std::vector<unsigned int> indices;
    for (const Triangle& t : surface.triangles) indices.insert(indices.end(), {t.a, t.b, t.c});
    const std::size_t count =
        meshopt_simplify(indices.data(), indices.data(), indices.size(), places, surface.vertices.size(), sizeof(Vec3),
                         3 * target, scale > 0 ? error / scale : 0, 0, nullptr);
    std::vector<std::uint32_t> name(surface.vertices.size(), 0xffffffffu);
    WeldedSurface result;
    const auto kept = [&](unsigned int i) {
        if (name[i] == 0xffffffffu) {
            name[i] = static_cast<std::uint32_t>(result.vertices.size());
            result.vertices.push_back(surface.vertices[i]);
        }
        return name[i];
    };
    for (std::size_t i = 0; i + 2 < count; i += 3)
        result.triangles.push_back({kept(indices[i]), kept(indices[i + 1]), kept(indices[i + 2])});
    return result;
}

}  // namespace ragtop
