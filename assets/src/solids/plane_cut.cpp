#include "solids/plane_cut.h"

#include <algorithm>
#include <numeric>

namespace ragtop {

std::vector<double> heightsAbove(const std::vector<DVec3>& points, const DPlane& plane) {
    std::vector<double> heights;
    heights.reserve(points.size());
    for (const DVec3& p : points) {
        const double h = plane.height(p);
        heights.push_back(std::abs(h) < kOnPlane ? 0 : h);
    }
    return heights;
}

bool isBelow(const CutSolid& solid, const Triangle& t, const std::vector<double>& heights, const DPlane& plane) {
    const double a = heights[t.a], b = heights[t.b], c = heights[t.c];
    if (a < 0 || b < 0 || c < 0) return true;
    if (a > 0 || b > 0 || c > 0) return false;
    const DVec3 p = solid.vertices[t.a];
    return dot(cross(solid.vertices[t.b] - p, solid.vertices[t.c] - p), plane.normal) > 0;
}

bool isFlush(const Cap& cap, const std::vector<double>& heights) {
    return std::all_of(cap.edges.begin(), cap.edges.end(),
                       [&](const auto& e) { return heights[e[0]] == 0 && heights[e[1]] == 0; });
}

Groups::Groups(std::size_t count) : parent_(count), box_(count) { std::iota(parent_.begin(), parent_.end(), 0u); }

std::uint32_t Groups::of(std::uint32_t i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
}

void Groups::join(std::uint32_t a, std::uint32_t b) {
    a = of(a), b = of(b);
    if (a == b) return;
    if (b < a) std::swap(a, b);
    parent_[b] = a;
    Box &into = box_[a], &from = box_[b];
    into.lower = {std::min(into.lower.x, from.lower.x), std::min(into.lower.y, from.lower.y),
                  std::min(into.lower.z, from.lower.z)};
    into.upper = {std::max(into.upper.x, from.upper.x), std::max(into.upper.y, from.upper.y),
                  std::max(into.upper.z, from.upper.z)};
}

void Groups::add(std::uint32_t i, const DVec3& p) {
    Box& box = box_[of(i)];
    box.lower = {std::min(box.lower.x, p.x), std::min(box.lower.y, p.y), std::min(box.lower.z, p.z)};
    box.upper = {std::max(box.upper.x, p.x), std::max(box.upper.y, p.y), std::max(box.upper.z, p.z)};
}

void Groups::joinOverlapping() {
    std::vector<std::uint32_t> roots;
    for (std::uint32_t i = 0; i < parent_.size(); ++i)
        if (parent_[i] == i && box_[i].lower.x <= box_[i].upper.x) roots.push_back(i);
    const auto overlap = [](const Box& a, const Box& b) {
        return a.lower.x <= b.upper.x && b.lower.x <= a.upper.x && a.lower.y <= b.upper.y && b.lower.y <= a.upper.y &&
               a.lower.z <= b.upper.z && b.lower.z <= a.upper.z;
    };
    constexpr std::size_t kMany = 64;  // parts beyond which telling them apart is not worth its time
    if (roots.size() > kMany) {
        for (const std::uint32_t root : roots) join(roots[0], root);
        return;
    }
    for (bool joined = true; joined;) {
        joined = false;
        for (const std::uint32_t a : roots)
            for (const std::uint32_t b : roots)
                if (a < b && of(a) != of(b) && overlap(box_[of(a)], box_[of(b)])) join(a, b), joined = true;
    }
}

}  // namespace ragtop
