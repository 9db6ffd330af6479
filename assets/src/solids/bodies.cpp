#include <algorithm>

#include "solids/cut_solid.h"
#include "solids/plane_cut.h"

namespace ragtop {
namespace {

/// One group of a solid.
class Extraction {
public:
    Extraction(const CutSolid& solid, Groups& groups, std::uint32_t group)
        : solid_(solid), groups_(groups), group_(group), kept_(solid) {}

    CutSolid make() {
        for (const Triangle& t : solid_.triangles)
            if (groups_.of(t.a) == group_) part_.triangles.push_back({kept(t.a), kept(t.b), kept(t.c)});
        for (const Cap& cap : solid_.caps) {
            Cap own{cap.plane, {}};
            for (const auto& [a, b] : cap.edges)
                if (groups_.of(a) == group_) own.edges.push_back({kept(a), kept(b)});
            if (!own.edges.empty()) part_.caps.push_back(std::move(own));
        }
        return std::move(part_);
    }

private:
    std::uint32_t kept(std::uint32_t i) { return kept_.of(i, part_.vertices); }

    const CutSolid& solid_;
    Groups& groups_;
    std::uint32_t group_;
    KeptVertices kept_;
    CutSolid part_;
};

Groups groupsOf(const CutSolid& solid) {
    Groups groups(solid.vertices.size());
    for (const Triangle& t : solid.triangles) groups.join(t.a, t.b), groups.join(t.b, t.c);
    for (const Cap& cap : solid.caps)
        for (const auto& [a, b] : cap.edges) groups.join(a, b);
    for (std::uint32_t i = 0; i < solid.vertices.size(); ++i) groups.add(i, solid.vertices[i]);
    return groups;
}

std::vector<std::uint32_t> rootsOf(const CutSolid& solid, Groups& groups) {
    std::vector<std::uint32_t> roots;
    for (std::uint32_t i = 0; i < solid.vertices.size(); ++i)
        if (groups.of(i) == i) roots.push_back(i);
    return roots;
}

std::vector<CutSolid> partsOf(CutSolid solid, Groups& groups) {
    const std::vector<std::uint32_t> roots = rootsOf(solid, groups);
    std::vector<CutSolid> parts;
    if (roots.size() < 2) {
        parts.push_back(std::move(solid));
        return parts;
    }
    for (const std::uint32_t root : roots) parts.push_back(Extraction(solid, groups, root).make());
    return parts;
}

/// Surfaces that face inwards go with the least of those that face outwards whose bounds hold them, or else with the
/// first.
void joinHollows(const CutSolid& solid, Groups& groups) {
    std::vector<double> sixfold(solid.vertices.size(), 0);
    for (const Triangle& t : solid.triangles)
        sixfold[groups.of(t.a)] += dot(solid.vertices[t.a], cross(solid.vertices[t.b], solid.vertices[t.c]));
    std::vector<std::uint32_t> outer, hollows;
    for (const std::uint32_t root : rootsOf(solid, groups)) (sixfold[root] < 0 ? hollows : outer).push_back(root);
    std::sort(outer.begin(), outer.end(), [&](std::uint32_t a, std::uint32_t b) {
        return std::pair{sixfold[a], a} < std::pair{sixfold[b], b};
    });
    std::vector<std::uint32_t> holders;
    for (const std::uint32_t hollow : hollows) {
        const auto holder = std::find_if(outer.begin(), outer.end(), [&](std::uint32_t root) {
            return groups.boxOf(root).holds(groups.boxOf(hollow));
        });
        holders.push_back(holder != outer.end() ? *holder : outer.empty() ? hollows[0] : outer.back());
    }
    for (std::size_t i = 0; i < hollows.size(); ++i) groups.join(holders[i], hollows[i]);
}

/// Halves a range of groups across where their middles reach farthest, down to so many ranges, each of which is joined.
void joinNear(Groups& groups, std::span<std::uint32_t> roots, std::size_t most) {
    if (most < 2 || roots.size() < 2) {
        for (const std::uint32_t root : roots) groups.join(roots[0], root);
        return;
    }
    DVec3 lower = groups.boxOf(roots[0]).middle(), upper = lower;
    for (const std::uint32_t root : roots) {
        const DVec3 middle = groups.boxOf(root).middle();
        lower = lowest(lower, middle), upper = highest(upper, middle);
    }
    const DVec3 reach = upper - lower;
    const double longest = std::max({reach.x, reach.y, reach.z});
    double DVec3::*axis = reach.x == longest ? &DVec3::x : reach.y == longest ? &DVec3::y : &DVec3::z;
    std::sort(roots.begin(), roots.end(), [&](std::uint32_t a, std::uint32_t b) {
        return std::pair{groups.boxOf(a).middle().*axis, a} < std::pair{groups.boxOf(b).middle().*axis, b};
    });
    const std::size_t half = roots.size() / 2;
    joinNear(groups, roots.first(half), most / 2);
    joinNear(groups, roots.subspan(half), most - most / 2);
}

}  // namespace

std::vector<CutSolid> separated(CutSolid solid) {
    Groups groups = groupsOf(solid);
    groups.joinOverlapping();
    return partsOf(std::move(solid), groups);
}

std::vector<CutSolid> bodiesOf(CutSolid solid, std::size_t most) {
    Groups groups = groupsOf(solid);
    joinHollows(solid, groups);
    if (std::vector<std::uint32_t> roots = rootsOf(solid, groups); roots.size() > most) joinNear(groups, roots, most);
    return partsOf(std::move(solid), groups);
}

}  // namespace ragtop
