#include <algorithm>
#include <map>

#include "solids/plane_cut.h"

namespace ragtop {
namespace {

/// Six times the volume of the tetrahedron from the origin.
double sixfold(const DVec3& a, const DVec3& b, const DVec3& c) { return dot(a, cross(b, c)); }

/// The point of both planes next to another; that one itself where they are parallel.
DVec3 meeting(const DPlane& a, const DPlane& b, const DVec3& near) {
    const double c = dot(a.normal, b.normal), rest = 1 - c * c;
    if (rest < 1e-12) return near;
    const double ha = a.height(near), hb = b.height(near);
    return near + ((c * hb - ha) / rest) * a.normal + ((c * ha - hb) / rest) * b.normal;
}

/// Sums the volume below a plane from an origin on it, so that the cut itself adds nothing; and the areas of all but
/// the cut, which they and it add up to nothing with.
class VolumeBelow {
public:
    VolumeBelow(const CutSolid& solid, const std::vector<double>& heights, const DPlane& plane)
        : solid_(solid), heights_(heights), plane_(plane), origin_(plane.offset * plane.normal) {}

    void sum() {
        for (const Triangle& t : solid_.triangles) add(t);
        for (const Cap& cap : solid_.caps)
            if (!isFlush(cap, heights_)) add(cap);
    }
    double volume() const { return sum_ / 6; }
    double cutArea() const { return -dot(areas_, plane_.normal) / 2; }

private:
    DVec3 at(std::uint32_t i) const { return solid_.vertices[i]; }
    DVec3 cut(std::uint32_t a, std::uint32_t b) const { return crossing(at(a), heights_[a], at(b), heights_[b]); }

    void add(const Triangle& t) {
        const std::array<std::uint32_t, 3> v{t.a, t.b, t.c};
        if (heights_[t.a] >= 0 && heights_[t.b] >= 0 && heights_[t.c] >= 0) return;
        std::array<DVec3, 4> loop;
        std::size_t count = 0;
        for (std::size_t i = 0; i < 3; ++i) {
            const std::uint32_t a = v[i], b = v[(i + 1) % 3];
            if (heights_[a] <= 0) loop[count++] = at(a) - origin_;
            if (heights_[a] * heights_[b] < 0) loop[count++] = cut(a, b) - origin_;
        }
        for (std::size_t i = 2; i < count; ++i) {
            sum_ += sixfold(loop[0], loop[i - 1], loop[i]);
            areas_ = areas_ + cross(loop[i - 1] - loop[0], loop[i] - loop[0]);
        }
    }
    /// Edges along the line of both planes add nothing to the area about a point of it.
    void add(const Cap& cap) {
        const DVec3 middle = meeting(cap.plane, plane_, at(cap.edges[0][0]));
        DVec3 area;
        for (const auto& [a, b] : cap.edges) {
            if (heights_[a] >= 0 && heights_[b] >= 0) continue;
            const DVec3 from = heights_[a] > 0 ? cut(a, b) : at(a), to = heights_[b] > 0 ? cut(a, b) : at(b);
            area = area + cross(from - middle, to - middle);
        }
        sum_ -= dot(area, cap.plane.normal) * cap.plane.height(origin_);
        areas_ = areas_ + area;
    }

    const CutSolid& solid_;
    const std::vector<double>& heights_;
    const DPlane& plane_;
    DVec3 origin_;
    double sum_ = 0;
    DVec3 areas_;
};

/// Collects the corners below a plane by what hangs together.
class CornersBelow {
public:
    CornersBelow(const CutSolid& solid, const std::vector<double>& heights, const DPlane& plane)
        : solid_(solid), heights_(heights), groups_(solid.vertices.size()), used_(solid.vertices.size(), false) {
        for (const Triangle& t : solid.triangles) {
            if (!isBelow(solid, t, heights, plane)) continue;
            add(t.a, t.b), add(t.b, t.c), add(t.c, t.a);
        }
        for (const Cap& cap : solid.caps) {
            const bool whole = isFlush(cap, heights) && dot(cap.plane.normal, plane.normal) > 0;
            for (const auto& [a, b] : cap.edges)
                if (whole || heights[a] < 0 || heights[b] < 0) add(a, b);
        }
    }

    std::vector<std::vector<DVec3>> byGroup() {
        for (std::uint32_t i = 0; i < used_.size(); ++i)
            if (used_[i]) groups_.add(i, solid_.vertices[i]);
        for (const auto& [owner, place] : cuts_) groups_.add(owner, place);
        groups_.joinOverlapping();
        std::map<std::uint32_t, std::vector<DVec3>> found;
        for (std::uint32_t i = 0; i < used_.size(); ++i)
            if (used_[i]) found[groups_.of(i)].push_back(solid_.vertices[i]);
        for (const auto& [owner, place] : cuts_) found[groups_.of(owner)].push_back(place);
        std::vector<std::vector<DVec3>> result;
        for (auto& [root, points] : found) result.push_back(std::move(points));
        return result;
    }

private:
    void add(std::uint32_t a, std::uint32_t b) {
        const double ha = heights_[a], hb = heights_[b];
        if (ha <= 0) used_[a] = true;
        if (hb <= 0) used_[b] = true;
        if (ha <= 0 && hb <= 0) groups_.join(a, b);
        if (ha * hb < 0) cuts_.push_back({ha < 0 ? a : b, crossing(solid_.vertices[a], ha, solid_.vertices[b], hb)});
    }

    const CutSolid& solid_;
    const std::vector<double>& heights_;
    Groups groups_;
    std::vector<bool> used_;
    std::vector<std::pair<std::uint32_t, DVec3>> cuts_;
};

}  // namespace

double volumeOf(const CutSolid& solid) {
    if (solid.vertices.empty()) return 0;
    const DVec3 origin = solid.vertices[0];
    double sum = 0;
    for (const Triangle& t : solid.triangles)
        sum += sixfold(solid.vertices[t.a] - origin, solid.vertices[t.b] - origin, solid.vertices[t.c] - origin);
    for (const Cap& cap : solid.caps) {
        DVec3 area;
        for (const auto& [a, b] : cap.edges)
            area = area + cross(solid.vertices[a] - origin, solid.vertices[b] - origin);
        sum -= dot(area, cap.plane.normal) * cap.plane.height(origin);
    }
    return sum / 6;
}

Remainder remainderBelow(const CutSolid& solid, const DPlane& plane) {
    const std::vector<double> heights = heightsAbove(solid.vertices, plane);
    VolumeBelow below(solid, heights, plane);
    below.sum();
    return {below.volume(), below.cutArea(), CornersBelow(solid, heights, plane).byGroup()};
}

}  // namespace ragtop
