#include "solids/surface_tree.h"

#include <algorithm>
#include <numeric>

namespace ragtop {
namespace {

double squaredDistance(const DVec3& p, const DVec3& lower, const DVec3& upper) {
    const DVec3 d = p - highest(lower, lowest(p, upper));
    return dot(d, d);
}

/// Of the nearest point of a triangle [Ericson, Real-Time Collision Detection, 2005, 5.1.5].
double squaredDistance(const DVec3& p, const std::array<DVec3, 3>& t) {
    const auto& [a, b, c] = t;
    const auto from = [&](const DVec3& q) { return dot(p - q, p - q); };
    const DVec3 ab = b - a, ac = c - a;
    const double d1 = dot(ab, p - a), d2 = dot(ac, p - a);
    if (d1 <= 0 && d2 <= 0) return from(a);
    const double d3 = dot(ab, p - b), d4 = dot(ac, p - b);
    if (d3 >= 0 && d4 <= d3) return from(b);
    const double vc = d1 * d4 - d3 * d2;
    if (vc <= 0 && d1 >= 0 && d3 <= 0) return from(a + (d1 / (d1 - d3)) * ab);
    const double d5 = dot(ab, p - c), d6 = dot(ac, p - c);
    if (d6 >= 0 && d5 <= d6) return from(c);
    const double vb = d5 * d2 - d1 * d6;
    if (vb <= 0 && d2 >= 0 && d6 <= 0) return from(a + (d2 / (d2 - d6)) * ac);
    const double va = d3 * d6 - d5 * d4;
    if (va <= 0 && d4 >= d3 && d5 >= d6) return from(b + ((d4 - d3) / (d4 - d3 + d5 - d6)) * (c - b));
    const double sum = va + vb + vc;
    return from(a + (vb / sum) * ab + (vc / sum) * ac);
}

/// Where a ray meets a triangle, either side [Möller, Trumbore, Fast, Minimum Storage Ray-Triangle Intersection, 1997].
double meeting(const DVec3& from, const DVec3& direction, const std::array<DVec3, 3>& t, double skip, double limit) {
    const DVec3 u = t[1] - t[0], v = t[2] - t[0], h = cross(direction, v);
    const double det = dot(u, h);
    if (det == 0) return limit;
    const DVec3 s = from - t[0], q = cross(s, u);
    const double a = dot(s, h) / det, b = dot(direction, q) / det, at = dot(v, q) / det;
    return a >= 0 && b >= 0 && a + b <= 1 && at > skip && at < limit ? at : limit;
}

bool meets(const DVec3& from, const DVec3& direction, const DVec3& lower, const DVec3& upper, double limit) {
    double enter = 0, leave = limit;
    const auto clip = [&](double o, double d, double l, double u) {
        if (d == 0) return o >= l && o <= u;
        const double s = (l - o) / d, e = (u - o) / d;
        enter = std::max(enter, std::min(s, e));
        leave = std::min(leave, std::max(s, e));
        return enter <= leave;
    };
    return clip(from.x, direction.x, lower.x, upper.x) && clip(from.y, direction.y, lower.y, upper.y) &&
           clip(from.z, direction.z, lower.z, upper.z);
}

constexpr std::uint32_t kLeaf = 4;  // triangles
constexpr std::size_t kDeep = 64;   // more than halving 2³² triangles makes

}  // namespace

SurfaceTree::SurfaceTree(std::vector<DVec3> vertices, std::span<const Triangle> triangles) {
    std::vector<DVec3> centers;
    centers.reserve(triangles.size());
    for (const Triangle& t : triangles) centers.push_back((1.0 / 3) * (vertices[t.a] + vertices[t.b] + vertices[t.c]));
    std::vector<std::uint32_t> order(triangles.size());
    std::iota(order.begin(), order.end(), 0u);
    triangles_.resize(triangles.size());
    for (std::size_t i = 0; i < triangles.size(); ++i)
        triangles_[i] = {vertices[triangles[i].a], vertices[triangles[i].b], vertices[triangles[i].c]};
    if (!order.empty()) build(order, centers, 0);
    std::vector<std::array<DVec3, 3>> sorted;
    sorted.reserve(order.size());
    for (const std::uint32_t i : order) sorted.push_back(triangles_[i]);
    triangles_ = std::move(sorted);
}

void SurfaceTree::build(std::span<std::uint32_t> order, std::span<const DVec3> centers, std::uint32_t first) {
    Node node{triangles_[order[0]][0], triangles_[order[0]][0], first, static_cast<std::uint32_t>(order.size())};
    for (const std::uint32_t i : order) {
        for (const DVec3& p : triangles_[i]) node.lower = lowest(node.lower, p), node.upper = highest(node.upper, p);
    }
    const std::size_t self = nodes_.size();
    nodes_.push_back(node);
    if (order.size() <= kLeaf) return;
    const DVec3 size = node.upper - node.lower;
    const auto along = [&](std::uint32_t i) {
        const DVec3& c = centers[i];
        return size.x >= size.y && size.x >= size.z ? c.x : size.y >= size.z ? c.y : c.z;
    };
    const std::size_t half = order.size() / 2;
    std::nth_element(order.begin(), order.begin() + static_cast<std::ptrdiff_t>(half), order.end(),
                     [&](std::uint32_t i, std::uint32_t j) {
                         const double a = along(i), b = along(j);
                         return a < b || (a == b && i < j);
                     });
    nodes_[self].count = 0;
    build(order.first(half), centers, first);
    nodes_[self].first = static_cast<std::uint32_t>(nodes_.size());
    build(order.subspan(half), centers, first + static_cast<std::uint32_t>(half));
}

double SurfaceTree::distance(const DVec3& p, double limit) const {
    double best = limit * limit;
    std::array<std::pair<std::uint32_t, double>, kDeep> stack;
    std::size_t depth = 0;
    if (!nodes_.empty()) stack[depth++] = {0, squaredDistance(p, nodes_[0].lower, nodes_[0].upper)};
    while (depth > 0) {
        const auto [at, nearest] = stack[--depth];
        if (nearest >= best) continue;
        const Node& node = nodes_[at];
        for (std::uint32_t i = 0; i < node.count; ++i)
            best = std::min(best, squaredDistance(p, triangles_[node.first + i]));
        if (node.count > 0) continue;
        std::pair<std::uint32_t, double> left{at + 1, 0}, right{node.first, 0};
        for (auto* child : {&left, &right})
            child->second = squaredDistance(p, nodes_[child->first].lower, nodes_[child->first].upper);
        if (left.second < right.second) std::swap(left, right);
        stack[depth++] = left;
        stack[depth++] = right;
    }
    return std::sqrt(best);
}

template <class Visit>
void SurfaceTree::along(const DVec3& from, const DVec3& direction, const double& reach, Visit&& visit) const {
    std::array<std::uint32_t, kDeep> stack;
    std::size_t depth = 0;
    if (!nodes_.empty()) stack[depth++] = 0;
    while (depth > 0) {
        const std::uint32_t at = stack[--depth];
        const Node& node = nodes_[at];
        if (!meets(from, direction, node.lower, node.upper, reach)) continue;
        for (std::uint32_t i = 0; i < node.count; ++i) visit(triangles_[node.first + i]);
        if (node.count > 0) continue;
        stack[depth++] = node.first;
        stack[depth++] = at + 1;
    }
}

double SurfaceTree::freePath(const DVec3& from, const DVec3& direction, double skip, double limit) const {
    double best = limit;
    along(from, direction, best, [&](const auto& triangle) { best = meeting(from, direction, triangle, skip, best); });
    return best;
}

int SurfaceTree::winding(const DVec3& from, const DVec3& direction, double skip) const {
    constexpr double kFar = std::numeric_limits<double>::infinity();
    int count = 0;
    along(from, direction, kFar, [&](const auto& triangle) {
        const auto& [a, b, c] = triangle;
        if (meeting(from, direction, triangle, skip, kFar) < kFar)
            count += dot(direction, cross(b - a, c - a)) > 0 ? 1 : -1;
    });
    return count;
}

}  // namespace ragtop
