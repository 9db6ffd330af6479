#include "cloth/cloth_plan.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <queue>
#include <utility>

namespace ragtop::cloth {
namespace {

std::size_t place(int index) { return static_cast<std::size_t>(index); }

float areaOf(const ClothDef& def, const ClothFace& face) {
    const auto at = [&](int i) { return def.points[place(i)]; };
    if (face.d < 0) return 0.5f * length(cross(at(face.b) - at(face.a), at(face.c) - at(face.a)));
    return 0.5f * length(cross(at(face.c) - at(face.a), at(face.d) - at(face.b)));
}

/// Links by their ends, with the stiffness of all faces and lines that share them.
class LinkTable {
public:
    explicit LinkTable(const ClothDef& def) : def_(def) {}

    /// `areaShare` is the area that the link stands for times the stiffness of the fabric, N m.
    void add(int a, int b, float areaShare) {
        const float rest = length(def_.points[place(b)] - def_.points[place(a)]);
        addStiffness(a, b, rest, areaShare / (rest * rest));
    }
    void addStiffness(int a, int b, float rest, float stiffness) {
        Link& link = links_[{std::min(a, b), std::max(a, b)}];
        link.a = std::min(a, b);
        link.b = std::max(a, b);
        link.rest = rest;
        link.stiffness += stiffness;
    }
    std::vector<Link> take() const {
        std::vector<Link> links;
        for (const auto& [ends, link] : links_) links.push_back(link);
        return links;
    }

private:
    const ClothDef& def_;
    std::map<std::pair<int, int>, Link> links_;
};

void addFace(const ClothDef& def, const ClothFace& face, LinkTable& links, Plan& plan) {
    const float area = areaOf(def, face);
    const std::array<int, 4> corners{face.a, face.b, face.c, face.d};
    const int count = face.d < 0 ? 3 : 4;
    for (int i = 0; i < count; ++i) {
        plan.areas[place(corners[place(i)])] += area / static_cast<float>(count);
        // Two sides of a quad share its area along each of its ways; a lattice of equilateral triangles with Young's
        // modulus Y has springs of Y area/l² for each of both triangles.
        links.add(corners[place(i)], corners[place((i + 1) % count)], def.stretch * (count == 4 ? 0.5f : 1.0f) * area);
    }
}

/// Covers links with layers of chains that go as straight on as they can.
class Layering {
public:
    Layering(const ClothDef& def, const std::vector<Link>& links)
        : def_(def),
          links_(links),
          around_(def.points.size()),
          covered_(links.size(), 0),
          open_(static_cast<int>(links.size())) {
        for (int i = 0; i < open_; ++i) {
            around_[place(links[place(i)].a)].push_back(i);
            around_[place(links[place(i)].b)].push_back(i);
        }
    }

    void appendTo(std::vector<Layer>& layers) {
        while (open_ > 0) layers.push_back(next());
    }

private:
    /// Chains begin along the first of them where they can, so that a woven layer is all warp or all weft.
    Layer next() {
        Layer layer;
        used_.assign(def_.points.size(), 0);
        Vec3 along;
        for (const bool anyWay : {false, true}) {
            for (int i = 0; i < static_cast<int>(links_.size()); ++i) {
                if (!isOpen(i)) continue;
                const Vec3 way = directionOf(i, links_[place(i)].a);
                if (layer.chains.empty()) along = way;
                if (anyWay || std::abs(dot(way, along)) > kAlong) layer.chains.push_back(chainFrom(i));
            }
        }
        std::sort(layer.chains.begin(), layer.chains.end(), [](const Chain& a, const Chain& b) {
            return std::pair(b.points.size(), a.points.front()) < std::pair(a.points.size(), b.points.front());
        });
        return layer;
    }

    bool isOpen(int i) const {
        const Link& link = links_[place(i)];
        return !covered_[place(i)] && !used_[place(link.a)] && !used_[place(link.b)];
    }
    int otherEnd(int i, int point) const { return links_[place(i)].a == point ? links_[place(i)].b : links_[place(i)].a; }
    Vec3 directionOf(int i, int from) const {
        return normalized(def_.points[place(otherEnd(i, from))] - def_.points[place(from)]);
    }

    void cover(int i, int point, Chain& chain) {
        covered_[place(i)] = 1;
        used_[place(point)] = 1;
        --open_;
        chain.points.push_back(point);
        chain.links.push_back(i);
    }

    Chain chainFrom(int first) {
        Chain chain;
        const Link& link = links_[place(first)];
        chain.points.push_back(link.a);
        used_[place(link.a)] = 1;
        cover(first, link.b, chain);
        extend(chain);
        std::reverse(chain.points.begin(), chain.points.end());
        std::reverse(chain.links.begin(), chain.links.end());
        extend(chain);
        return chain;
    }

    void extend(Chain& chain) {
        for (;;) {
            const int end = chain.points.back();
            const Vec3 way = -directionOf(chain.links.back(), end);
            int best = kNoPoint;
            float straightest = kStraight;
            for (const int i : around_[place(end)]) {
                if (covered_[place(i)] || used_[place(otherEnd(i, end))]) continue;
                const float straight = dot(way, directionOf(i, end));
                if (straight <= straightest) continue;
                straightest = straight;
                best = i;
            }
            if (best == kNoPoint) return;
            cover(best, otherEnd(best, end), chain);
        }
    }

    static constexpr float kAlong = 0.8f;     ///< cosine to the first chain with which others begin
    static constexpr float kStraight = 0.5f;  ///< cosine of the sharpest bend of a chain

    const ClothDef& def_;
    const std::vector<Link>& links_;
    std::vector<std::vector<int>> around_;
    std::vector<char> covered_, used_;
    int open_ = 0;
};

/// The nearest attached point of each, and the way to it along links [Dijkstra 1959; Kim et al. 2012].
void findTethers(const ClothDef& def, Plan& plan) {
    const auto count = def.points.size();
    std::vector<std::vector<std::pair<int, float>>> around(count);
    for (const Link& link : plan.links) {
        around[place(link.a)].push_back({link.b, link.rest});
        around[place(link.b)].push_back({link.a, link.rest});
    }
    plan.anchors.assign(count, kNoPoint);
    plan.tethers.assign(count, 0);
    using Entry = std::pair<float, int>;
    std::priority_queue<Entry, std::vector<Entry>, std::greater<>> front;
    for (const ClothAttachment& attachment : def.attachments) {
        plan.anchors[place(attachment.point)] = attachment.point;
        front.push({0, attachment.point});
    }
    std::vector<char> done(count, 0);
    while (!front.empty()) {
        const auto [distance, point] = front.top();
        front.pop();
        if (done[place(point)]) continue;
        done[place(point)] = 1;
        plan.tethers[place(point)] = distance;
        for (const auto& [next, rest] : around[place(point)]) {
            const float farther = distance + rest;
            if (done[place(next)] || (plan.anchors[place(next)] != kNoPoint && plan.tethers[place(next)] <= farther))
                continue;
            plan.anchors[place(next)] = plan.anchors[place(point)];
            plan.tethers[place(next)] = farther;
            front.push({farther, next});
        }
    }
}

}  // namespace

std::vector<int> attachmentOfPoints(const ClothDef& def) {
    std::vector<int> result(def.points.size(), kNoPoint);
    for (int i = 0; i < static_cast<int>(def.attachments.size()); ++i) result[place(def.attachments[place(i)].point)] = i;
    return result;
}

Plan makePlan(const ClothDef& def) {
    Plan plan;
    plan.areas.assign(def.points.size(), 0);
    LinkTable links(def);
    for (const ClothFace& face : def.faces) addFace(def, face, links, plan);
    for (const float area : plan.areas) plan.masses.push_back(def.density * area);
    for (const ClothLine& line : def.lines) {
        const float rest = length(def.points[place(line.b)] - def.points[place(line.a)]);
        links.addStiffness(line.a, line.b, rest, def.lineStretch / rest);
        plan.masses[place(line.a)] += 0.5f * def.lineDensity * rest;
        plan.masses[place(line.b)] += 0.5f * def.lineDensity * rest;
    }
    plan.links = links.take();
    Layering(def, plan.links).appendTo(plan.layers);
    if (def.shear > 0) plan.strips = makeStrips(def);
    findTethers(def, plan);
    return plan;
}

}  // namespace ragtop::cloth
