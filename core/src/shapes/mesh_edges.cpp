#include <algorithm>
#include <array>
#include <numeric>
#include <tuple>

#include "shapes/mesh_build.h"

namespace ragtop {
namespace {

/// rad. Flatter edges count as part of a smooth surface, which must not catch what slides over it.
constexpr float kFlatBend = 0.0174533f;
/// rad. Closer to −π than this, two faces lie back to back: a blade, not a slit of no width.
constexpr float kFold = 1e-3f;

}  // namespace

std::vector<std::uint32_t> weld(const std::vector<Vec3>& vertices) {
    std::vector<std::uint32_t> order(vertices.size());
    std::iota(order.begin(), order.end(), 0u);
    const auto place = [&](std::uint32_t i) { return std::tie(vertices[i].x, vertices[i].y, vertices[i].z); };
    std::sort(order.begin(), order.end(),
              [&](std::uint32_t i, std::uint32_t j) { return place(i) < place(j) || (place(i) == place(j) && i < j); });
    std::vector<std::uint32_t> name(vertices.size());
    for (std::size_t k = 0; k < order.size(); ++k) {
        const bool same = k > 0 && vertices[order[k]] == vertices[order[k - 1]];
        name[order[k]] = same ? name[order[k - 1]] : order[k];
    }
    return name;
}

std::vector<HalfEdge> sortedHalfEdges(std::span<const Triangle> triangles, std::span<const std::uint32_t> name) {
    std::vector<HalfEdge> halves;
    halves.reserve(3 * triangles.size());
    for (std::uint32_t t = 0; t < triangles.size(); ++t) {
        const Triangle& triangle = triangles[t];
        const std::array<std::uint32_t, 3> corner{name[triangle.a], name[triangle.b], name[triangle.c]};
        for (std::uint8_t e = 0; e < 3; ++e) {
            const std::uint32_t from = corner[e], to = corner[(e + 1) % 3];
            halves.push_back({std::min(from, to), std::max(from, to), from > to, t, e});
        }
    }
    std::sort(halves.begin(), halves.end(), [](const HalfEdge& a, const HalfEdge& b) {
        return std::tie(a.low, a.high, a.triangle, a.edge) < std::tie(b.low, b.high, b.triangle, b.edge);
    });
    return halves;
}

float bendAt(const Vec3& own, const Vec3& other, const Vec3& direction) {
    const float bend = arcTan2(dot(cross(own, other), normalized(direction)), dot(own, other));
    return bend < kFold - kPi ? kPi : bend;
}

bool isActiveBend(float bend) { return bend > kFlatBend; }

Vec3 triangleNormal(const Vec3& a, const Vec3& b, const Vec3& c) {
    const DVec3 u = DVec3(b) - DVec3(a), v = DVec3(c) - DVec3(a), w = DVec3(c) - DVec3(b);
    const DVec3 n(u.y * v.z - u.z * v.y, u.z * v.x - u.x * v.z, u.x * v.y - u.y * v.x);
    const auto square = [](const DVec3& d) { return d.x * d.x + d.y * d.y + d.z * d.z; };
    const double area = std::sqrt(square(n));
    constexpr double kNoArea = 1e-7;  // of the longest edge's square: a rounding of a float
    if (!(area > kNoArea * std::max({square(u), square(v), square(w)}))) return {};
    return toVec3((1 / area) * n);
}

void findActiveEdges(MeshTables& mesh) {
    const std::vector<HalfEdge> halves = sortedHalfEdges(mesh.triangles, weld(mesh.vertices));
    mesh.activeEdges.assign(mesh.triangles.size(), 0);
    for (std::size_t first = 0, last = 0; first < halves.size(); first = last) {
        while (last < halves.size() && halves[last].low == halves[first].low &&
               halves[last].high == halves[first].high) {
            ++last;
        }
        const Vec3 along = mesh.vertices[halves[first].high] - mesh.vertices[halves[first].low];
        for (std::size_t i = first; i < last; ++i) {
            // Of several neighbours the surface goes on into the one met first in front of the face.
            float bend = kPi;
            for (std::size_t j = first; j < last; ++j) {
                if (halves[j].reversed == halves[i].reversed) continue;
                bend = std::min(bend, bendAt(mesh.normals[halves[i].triangle], mesh.normals[halves[j].triangle],
                                             halves[i].reversed ? -along : along));
            }
            if (isActiveBend(bend)) {
                std::uint8_t& active = mesh.activeEdges[halves[i].triangle];
                active = static_cast<std::uint8_t>(active | (1u << halves[i].edge));
            }
        }
    }
}

}  // namespace ragtop
