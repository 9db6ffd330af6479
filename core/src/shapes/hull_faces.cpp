#include <algorithm>
#include <array>

#include "base/double_vectors.h"
#include "shapes/hull_build.h"

namespace ragtop {
namespace {

using Loop = std::vector<int>;
using Side = std::array<int, 2>;  ///< from a vertex to the next

/// The patches of triangles that become faces.
class Merge {
public:
    Merge(const std::vector<DVec3>& points, const std::vector<HullTriangle>& triangles, double tolerance)
        : points_(points),
          triangles_(triangles),
          tolerance_(tolerance),
          across_(triangles.size()),
          patchOf_(triangles.size(), -1) {
        findNeighbours();
        std::vector<std::pair<double, std::size_t>> byArea;
        for (std::size_t t = 0; t < triangles.size(); ++t) {
            const DVec3 n = areaNormal(t);
            byArea.emplace_back(-dot(n, n), t);
        }
        std::sort(byArea.begin(), byArea.end());
        for (const auto& [area, t] : byArea) {
            if (patchOf_[t] < 0) grow(t);
        }
    }

    /// Empty when a patch is no simple loop of at least three vertices.
    std::vector<Loop> faces() const {
        std::vector<std::vector<Side>> outlines(static_cast<std::size_t>(patchCount_));
        for (std::size_t t = 0; t < triangles_.size(); ++t) {
            for (std::size_t e = 0; e < 3; ++e) {
                if (patchOf_[across_[t][e]] != patchOf_[t])
                    outlines[static_cast<std::size_t>(patchOf_[t])].push_back(
                        {triangles_[t][e], triangles_[t][(e + 1) % 3]});
            }
        }
        std::vector<Loop> loops;
        for (std::vector<Side>& sides : outlines) {
            loops.push_back(joined(sides));
            if (loops.back().empty()) return {};
        }
        dropPassedVertices(loops);
        for (Loop& loop : loops) {
            if (loop.size() < 3) return {};
            std::rotate(loop.begin(), std::min_element(loop.begin(), loop.end()), loop.end());
        }
        std::sort(loops.begin(), loops.end());
        return loops;
    }

private:
    const DVec3& point(int i) const { return points_[static_cast<std::size_t>(i)]; }
    DVec3 areaNormal(std::size_t t) const {
        const HullTriangle& v = triangles_[t];
        return cross(point(v[1]) - point(v[0]), point(v[2]) - point(v[0]));
    }
    /// The triangles are a closed surface: each side has one partner, which runs the other way.
    void findNeighbours() {
        struct Owned {
            Side side;
            std::size_t triangle;
        };
        std::vector<Owned> owned;
        for (std::size_t t = 0; t < triangles_.size(); ++t) {
            for (std::size_t e = 0; e < 3; ++e) owned.push_back({{triangles_[t][e], triangles_[t][(e + 1) % 3]}, t});
        }
        const auto before = [](const Owned& a, const Owned& b) { return a.side < b.side; };
        std::sort(owned.begin(), owned.end(), before);
        for (std::size_t t = 0; t < triangles_.size(); ++t) {
            for (std::size_t e = 0; e < 3; ++e) {
                const Owned partner{{triangles_[t][(e + 1) % 3], triangles_[t][e]}, 0};
                across_[t][e] = std::lower_bound(owned.begin(), owned.end(), partner, before)->triangle;
            }
        }
    }

    /// Takes in what lies in the plane of its largest triangle, so that a gentle curve does not become one face.
    void grow(std::size_t seed) {
        const DVec3 n = areaNormal(seed);
        const double size = std::sqrt(dot(n, n));
        const DVec3 corner = point(triangles_[seed][0]);
        const int patch = patchCount_++;
        std::vector<std::size_t> front{seed};
        patchOf_[seed] = patch;
        while (!front.empty()) {
            const std::size_t t = front.back();
            front.pop_back();
            for (std::size_t e = 0; e < 3; ++e) {
                const std::size_t next = across_[t][e];
                if (patchOf_[next] >= 0) continue;
                const auto inPlane = [&](int v) { return std::abs(dot(n, point(v) - corner)) <= tolerance_ * size; };
                const HullTriangle& v = triangles_[next];
                if (!inPlane(v[0]) || !inPlane(v[1]) || !inPlane(v[2])) continue;
                patchOf_[next] = patch;
                front.push_back(next);
            }
        }
    }

    /// The loop that sides make, from the lowest vertex on; empty where they make none, or several.
    static Loop joined(std::vector<Side>& sides) {
        std::sort(sides.begin(), sides.end());
        const auto isFork = [](const Side& a, const Side& b) { return a[0] == b[0]; };
        if (sides.size() < 3 || std::adjacent_find(sides.begin(), sides.end(), isFork) != sides.end()) return {};
        Loop loop;
        int at = sides.front()[0];
        do {
            loop.push_back(at);
            const auto next = std::lower_bound(sides.begin(), sides.end(), Side{at, 0});
            at = (*next)[1];
        } while (at != loop.front() && loop.size() < sides.size());
        return at == loop.front() && loop.size() == sides.size() ? loop : Loop{};
    }

    /// A vertex of two faces only is no corner; it lies on the edge between them.
    void dropPassedVertices(std::vector<Loop>& loops) const {
        std::vector<int> faceCount(points_.size(), 0);
        for (const Loop& loop : loops) {
            for (const int v : loop) ++faceCount[static_cast<std::size_t>(v)];
        }
        for (Loop& loop : loops) {
            std::erase_if(loop, [&](int v) { return faceCount[static_cast<std::size_t>(v)] < 3; });
        }
    }

    const std::vector<DVec3>& points_;
    const std::vector<HullTriangle>& triangles_;
    double tolerance_;
    std::vector<std::array<std::size_t, 3>> across_;  ///< each side of each triangle, to the one beyond
    std::vector<int> patchOf_;
    int patchCount_ = 0;
};

/// A closed polyhedron: each side has its partner, V − E + F = 2, and all corners turn left.
bool isPolyhedron(const std::vector<DVec3>& points, const std::vector<Loop>& faces) {
    std::vector<std::array<int, 2>> sides, partners;
    std::vector<int> vertices;
    for (const Loop& loop : faces) {
        DVec3 normal;
        const auto at = [&](std::size_t i) { return points[static_cast<std::size_t>(loop[i % loop.size()])]; };
        for (std::size_t i = 0; i < loop.size(); ++i) {
            normal = normal + cross(at(i) - at(0), at(i + 1) - at(0));
            sides.push_back({loop[i], loop[(i + 1) % loop.size()]});
            partners.push_back({loop[(i + 1) % loop.size()], loop[i]});
            vertices.push_back(loop[i]);
        }
        for (std::size_t i = 0; i < loop.size(); ++i) {
            if (!(dot(normal, cross(at(i + 1) - at(i), at(i + 2) - at(i + 1))) > 0)) return false;
        }
    }
    std::sort(sides.begin(), sides.end());
    std::sort(partners.begin(), partners.end());
    std::sort(vertices.begin(), vertices.end());
    const auto end = std::unique(vertices.begin(), vertices.end());
    const std::size_t count = static_cast<std::size_t>(end - vertices.begin());
    return sides == partners && std::adjacent_find(sides.begin(), sides.end()) == sides.end() &&
           count + faces.size() == sides.size() / 2 + 2;
}

}  // namespace

std::vector<std::vector<int>> mergeFaces(const std::vector<DVec3>& points, const std::vector<HullTriangle>& triangles,
                                         double tolerance) {
    std::vector<Loop> faces = Merge(points, triangles, tolerance).faces();
    return isPolyhedron(points, faces) ? faces : std::vector<Loop>{};
}

}  // namespace ragtop
