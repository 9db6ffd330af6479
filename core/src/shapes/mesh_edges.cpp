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
/// Triangles at one edge from which on their angles are sorted: comparing each with each takes longer.
constexpr std::size_t kManyAtEdge = 16;

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

EdgeFan::EdgeFan(const MeshTables& mesh, std::span<const HalfEdge> halves)
    : mesh_(mesh), halves_(halves), along_(mesh.vertices[halves[0].high] - mesh.vertices[halves[0].low]) {
    if (halves.size() <= kManyAtEdge) return;
    for (const HalfEdge& half : halves) {
        const float angle = angleOf(half.triangle);
        sides_[half.reversed].push_back({half.reversed ? angle : -angle, half.triangle});
    }
    for (std::vector<Side>& sides : sides_)
        std::sort(sides.begin(), sides.end(), [](const Side& a, const Side& b) {
            return std::tie(a.angle, a.triangle) < std::tie(b.angle, b.triangle);
        });
}

float EdgeFan::angleOf(std::uint32_t triangle) const {
    const Vec3 &first = mesh_.normals[halves_[0].triangle], &normal = mesh_.normals[triangle];
    return arcTan2(dot(cross(first, normal), normalized(along_)), dot(first, normal));
}

EdgeFan::Next EdgeFan::next(const HalfEdge& own) const {
    if (halves_.size() > kManyAtEdge) return nextOfMany(own);
    Next best{2 * kPi};
    for (const HalfEdge& half : halves_) {
        if (half.reversed == own.reversed) continue;
        const float bend =
            bendAt(mesh_.normals[own.triangle], mesh_.normals[half.triangle], own.reversed ? -along_ : along_);
        if (bend < best.bend) best = {bend, half.triangle};
    }
    return {std::min(best.bend, kPi), best.triangle};
}

EdgeFan::Next EdgeFan::nextOfMany(const HalfEdge& own) const {
    const std::vector<Side>& others = sides_[!own.reversed];
    if (others.empty()) return {};
    const float angle = angleOf(own.triangle), at = own.reversed ? -angle : angle;
    const auto firstFrom = [&](float least) {
        return std::lower_bound(others.begin(), others.end(), least,
                                [](const Side& side, float from) { return side.angle < from; });
    };
    const float least = at - kPi + kFold;
    auto met = firstFrom(least);
    float turns = 0;
    if (met == others.end()) met = others.begin(), turns = 2 * kPi;
    // From below −π on they come once round.
    if (const auto behind = firstFrom(least + 2 * kPi); least < -kPi && behind != others.end())
        met = behind, turns = -2 * kPi;
    return {std::min(met->angle + turns - at, kPi), met->triangle};
}

void findActiveEdges(MeshTables& mesh) {
    const std::vector<HalfEdge> halves = sortedHalfEdges(mesh.triangles, weld(mesh.vertices));
    mesh.activeEdges.assign(mesh.triangles.size(), 0);
    for (std::size_t first = 0, last = 0; first < halves.size(); first = last) {
        while (last < halves.size() && halves[last].low == halves[first].low &&
               halves[last].high == halves[first].high) {
            ++last;
        }
        const EdgeFan fan(mesh, std::span(halves).subspan(first, last - first));
        for (std::size_t i = first; i < last; ++i) {
            if (isActiveBend(fan.next(halves[i]).bend)) {
                std::uint8_t& active = mesh.activeEdges[halves[i].triangle];
                active = static_cast<std::uint8_t>(active | (1u << halves[i].edge));
            }
        }
    }
}

}  // namespace ragtop
