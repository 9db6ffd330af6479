#include "solids/cut_solid.h"

#include <algorithm>
#include <map>
#include <tuple>

#include "solids/plane_cut.h"

namespace ragtop {
namespace {

/// Where edges of a cap go below the plane and come back, in the order of their places along the line of both.
struct CapCrossing {
    double along = 0;
    int starts = 0;  ///< edges along the line that begin there: 1 where the cap's own edge ends, else −1
    std::uint32_t vertex = 0;
};

/// Without edges of no length, and without pairs that run both ways.
void tidy(std::vector<std::array<std::uint32_t, 2>>& edges) {
    const auto key = [](const auto& e) { return std::tuple{std::min(e[0], e[1]), std::max(e[0], e[1]), e[0] > e[1]}; };
    std::sort(edges.begin(), edges.end(), [&](const auto& a, const auto& b) { return key(a) < key(b); });
    std::vector<std::array<std::uint32_t, 2>> rest;
    for (std::size_t first = 0, last = 0; first < edges.size(); first = last) {
        const auto [low, high, turned] = key(edges[first]);
        int sum = 0;
        for (; last < edges.size() && std::min(edges[last][0], edges[last][1]) == low &&
               std::max(edges[last][0], edges[last][1]) == high;
             ++last)
            sum += edges[last][0] > edges[last][1] ? -1 : 1;
        if (low == high) continue;
        for (int i = 0; i < std::abs(sum); ++i) rest.push_back(sum > 0 ? std::array{low, high} : std::array{high, low});
    }
    edges = std::move(rest);
}

/// Builds the part below a plane.
class Below {
public:
    Below(const CutSolid& solid, const DPlane& plane)
        : solid_(solid), plane_(plane), heights_(heightsAbove(solid.vertices, plane)), kept_(solid) {
        cap_.plane = plane;
    }

    CutSolid make() {
        for (const Triangle& t : solid_.triangles)
            if (isBelow(solid_, t, heights_, plane_)) add(t);
        for (const Cap& cap : solid_.caps) add(cap);
        tidy(cap_.edges);
        if (!cap_.edges.empty()) part_.caps.push_back(std::move(cap_));
        return std::move(part_);
    }

private:
    std::uint32_t kept(std::uint32_t i) { return kept_.of(i, part_.vertices); }
    std::uint32_t cut(std::uint32_t i, std::uint32_t j) {
        const auto [at, fresh] = cuts_.try_emplace({std::min(i, j), std::max(i, j)}, 0u);
        if (fresh) {
            at->second = static_cast<std::uint32_t>(part_.vertices.size());
            part_.vertices.push_back(crossing(solid_.vertices[i], heights_[i], solid_.vertices[j], heights_[j]));
        }
        return at->second;
    }
    void add(const Triangle& t) {
        const std::array<std::uint32_t, 3> v{t.a, t.b, t.c};
        std::array<std::uint32_t, 4> loop{};
        std::array<bool, 4> on{};
        std::size_t count = 0;
        for (std::size_t i = 0; i < 3; ++i) {
            const std::uint32_t a = v[i], b = v[(i + 1) % 3];
            if (heights_[a] <= 0) on[count] = heights_[a] == 0, loop[count++] = kept(a);
            if (heights_[a] * heights_[b] < 0) on[count] = true, loop[count++] = cut(a, b);
        }
        for (std::size_t i = 2; i < count; ++i) part_.triangles.push_back({loop[0], loop[i - 1], loop[i]});
        for (std::size_t i = 0; i < count; ++i) {
            const std::size_t j = (i + 1) % count;
            if (on[i] && on[j]) cap_.edges.push_back({loop[j], loop[i]});
        }
    }
    void add(const Cap& cap) {
        if (isFlush(cap, heights_)) {
            if (dot(cap.plane.normal, plane_.normal) < 0) return;
            Cap whole{cap.plane, {}};
            for (const auto& [a, b] : cap.edges) {
                whole.edges.push_back({kept(a), kept(b)});
                cap_.edges.push_back({kept(b), kept(a)});
            }
            part_.caps.push_back(std::move(whole));
            return;
        }
        addClipped(cap);
    }
    /// A part of a cap ends along the line of both planes, where the new cap ends too.
    void addClipped(const Cap& cap) {
        Cap rest{cap.plane, {}};
        std::vector<CapCrossing> crossings;
        const DVec3 line = cross(cap.plane.normal, plane_.normal);
        const auto place = [&](std::uint32_t i) { return dot(line, part_.vertices[i]); };
        for (const auto& [a, b] : cap.edges) {
            if (heights_[a] >= 0 && heights_[b] >= 0) continue;
            const std::uint32_t from = heights_[a] > 0 ? cut(a, b) : kept(a);
            const std::uint32_t to = heights_[b] > 0 ? cut(a, b) : kept(b);
            rest.edges.push_back({from, to});
            if (heights_[a] >= 0) crossings.push_back({place(from), -1, from});
            if (heights_[b] >= 0) crossings.push_back({place(to), 1, to});
        }
        std::sort(crossings.begin(), crossings.end(), [](const CapCrossing& a, const CapCrossing& b) {
            return std::tie(a.along, a.vertex, a.starts) < std::tie(b.along, b.vertex, b.starts);
        });
        int running = 0;
        for (std::size_t i = 0; i + 1 < crossings.size(); ++i) {
            running += crossings[i].starts;
            std::uint32_t from = crossings[i].vertex, to = crossings[i + 1].vertex;
            if (running < 0) std::swap(from, to);
            for (int k = 0; k < std::abs(running); ++k)
                rest.edges.push_back({from, to}), cap_.edges.push_back({to, from});
        }
        tidy(rest.edges);
        if (!rest.edges.empty()) part_.caps.push_back(std::move(rest));
    }

    const CutSolid& solid_;
    DPlane plane_;
    std::vector<double> heights_;
    KeptVertices kept_;
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> cuts_;
    CutSolid part_;
    Cap cap_;
};

}  // namespace

CutSolid partBelow(const CutSolid& solid, const DPlane& plane) { return Below(solid, plane).make(); }

}  // namespace ragtop
