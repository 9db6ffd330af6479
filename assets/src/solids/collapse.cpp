#include "solids/collapse.h"

#include <meshoptimizer.h>

#include <algorithm>
#include <tuple>

namespace ragtop {

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
