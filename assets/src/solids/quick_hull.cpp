#include "solids/quick_hull.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>

namespace ragtop {
namespace {

constexpr double kVisible = 1e-11;  // above rounding
constexpr double kConvex = 1e-8;    // farthest that a corner may stand over a face beside its own
constexpr double kThin = 1e-6;

using Corners = std::array<std::uint32_t, 3>;

struct Face {
    Corners corner{}, beyond{};  ///< the face beyond the edge from each corner to the next
    DPlane plane;
    std::vector<std::uint32_t> outside;
    bool gone = false;
};

struct HorizonEdge {
    std::uint32_t from, to, beyond;
};

class Quick {
public:
    explicit Quick(const std::vector<DVec3>& points) : points_(points), startsAt_(points.size(), {0, 0}) {}

    std::vector<HullTriangle> make() {
        if (points_.size() < 4 || !begin()) return {};
        while (!pending_.empty()) {
            const std::uint32_t at = pending_.back();
            pending_.pop_back();
            if (!faces_[at].gone && !faces_[at].outside.empty() && !addFarthestOver(at)) return {};
        }
        const DVec3 inside = middle();
        std::vector<HullTriangle> triangles;
        for (const Face& face : faces_) {
            if (face.gone) continue;
            if (!isConvex(face) || face.plane.height(inside) >= 0) return {};  // folded, among points in one plane
            const auto& [a, b, c] = face.corner;
            triangles.push_back({static_cast<int>(a), static_cast<int>(b), static_cast<int>(c)});
        }
        return triangles;
    }

private:
    template <class Measure>
    std::uint32_t farthest(Measure&& measure) const {
        std::uint32_t best = 0;
        double most = measure(points_[0]);
        for (std::uint32_t i = 1; i < points_.size(); ++i)
            if (const double m = measure(points_[i]); m > most) best = i, most = m;
        return best;
    }

    /// A tetrahedron of points that are far apart.
    bool begin() {
        const std::uint32_t a = farthest([&](const DVec3& p) { return dot(p - points_[0], p - points_[0]); });
        const std::uint32_t b = farthest([&](const DVec3& p) { return dot(p - points_[a], p - points_[a]); });
        std::uint32_t c = farthest([&](const DVec3& p) {
            const DVec3 n = cross(points_[b] - points_[a], p - points_[a]);
            return dot(n, n);
        });
        const std::optional<DPlane> base = planeOf({a, b, c});
        if (!base) return false;
        const std::uint32_t d = farthest([&](const DVec3& p) { return std::abs(base->height(p)); });
        const double height = base->height(points_[d]);
        if (std::abs(height) < kThin) return false;
        std::uint32_t e = b;
        if (height > 0) std::swap(e, c);
        const std::array<Corners, 4> corners{{{a, e, c}, {a, d, e}, {e, d, c}, {c, d, a}}};
        const std::array<Corners, 4> beyond{{{1, 2, 3}, {3, 2, 0}, {1, 3, 0}, {2, 1, 0}}};
        std::vector<std::uint32_t> all(points_.size());
        for (std::uint32_t i = 0; i < all.size(); ++i) all[i] = i;
        for (std::size_t i = 0; i < 4; ++i)
            if (!add(corners[i], beyond[i])) return false;
        share(all, 0);
        return true;
    }

    std::optional<DPlane> planeOf(const Corners& corner) const {
        const DVec3 &a = points_[corner[0]], &b = points_[corner[1]], &c = points_[corner[2]];
        const DVec3 n = cross(b - a, c - a);
        const double area = length(n);
        constexpr double kNoArea = 1e-13;
        if (!(area > kNoArea)) return {};
        const DVec3 normal = (1 / area) * n;
        return DPlane{normal, dot(normal, a)};
    }
    bool add(const Corners& corner, const Corners& beyond) {
        const std::optional<DPlane> plane = planeOf(corner);
        if (plane) faces_.push_back({corner, beyond, *plane, {}});
        return plane.has_value();
    }

    /// Points to the first face from a number on that they are outside of.
    void share(const std::vector<std::uint32_t>& points, std::size_t first) {
        for (const std::uint32_t i : points)
            for (std::size_t f = first; f < faces_.size(); ++f)
                if (faces_[f].plane.height(points_[i]) > kVisible) {
                    faces_[f].outside.push_back(i);
                    break;
                }
        for (std::size_t f = first; f < faces_.size(); ++f)
            if (!faces_[f].outside.empty()) pending_.push_back(static_cast<std::uint32_t>(f));
    }

    bool addFarthestOver(std::uint32_t at) {
        const Face& face = faces_[at];
        std::uint32_t point = face.outside[0];
        for (const std::uint32_t i : face.outside)
            if (face.plane.height(points_[i]) > face.plane.height(points_[point])) point = i;
        ++round_;
        std::vector<std::uint32_t> orphans;
        std::vector<HorizonEdge> horizon;
        collect(at, point, orphans, horizon);
        return close(point, horizon, orphans);
    }

    /// Removes the faces that a point sees.
    void collect(std::uint32_t at, std::uint32_t point, std::vector<std::uint32_t>& orphans,
                 std::vector<HorizonEdge>& horizon) {
        std::vector<std::uint32_t> stack{at};
        faces_[at].gone = true;
        while (!stack.empty()) {
            Face& face = faces_[stack.back()];
            stack.pop_back();
            for (const std::uint32_t i : face.outside)
                if (i != point) orphans.push_back(i);
            face.outside.clear();
            for (std::size_t k = 0; k < 3; ++k) {
                const std::uint32_t next = face.beyond[k];
                if (faces_[next].gone) continue;
                if (faces_[next].plane.height(points_[point]) > kVisible) {
                    faces_[next].gone = true;
                    stack.push_back(next);
                }
            }
            removed_.push_back(static_cast<std::uint32_t>(&face - faces_.data()));
        }
        for (const std::uint32_t f : removed_)
            for (std::size_t k = 0; k < 3; ++k) {
                const Face& face = faces_[f];
                if (!faces_[face.beyond[k]].gone)
                    horizon.push_back({face.corner[k], face.corner[(k + 1) % 3], face.beyond[k]});
            }
        removed_.clear();
    }

    /// A cone from the point to the horizon, where that is one loop.
    bool close(std::uint32_t point, const std::vector<HorizonEdge>& horizon,
               const std::vector<std::uint32_t>& orphans) {
        const auto first = static_cast<std::uint32_t>(faces_.size());
        for (std::uint32_t k = 0; k < horizon.size(); ++k) {
            auto& [round, face] = startsAt_[horizon[k].from];
            if (round == round_) return false;
            round = round_, face = first + k;
            if (!add({horizon[k].from, horizon[k].to, point}, {horizon[k].beyond, 0, 0})) return false;
        }
        std::size_t length = 0;
        for (std::uint32_t at = first; length < horizon.size(); ++length) {
            const auto& [round, next] = startsAt_[faces_[at].corner[1]];
            if (round != round_) return false;
            faces_[at].beyond[1] = next;
            faces_[next].beyond[2] = at;
            at = next;
            if (at == first && length + 1 != horizon.size()) return false;
        }
        for (const HorizonEdge& edge : horizon) {
            Face& outer = faces_[edge.beyond];
            for (std::size_t k = 0; k < 3; ++k)
                if (outer.corner[k] == edge.to && outer.corner[(k + 1) % 3] == edge.from)
                    outer.beyond[k] = startsAt_[edge.from].second;
        }
        share(orphans, first);
        return true;
    }

    DVec3 middle() const {
        DVec3 sum;
        double count = 0;
        for (const Face& face : faces_)
            if (!face.gone)
                sum = sum + points_[face.corner[0]] + points_[face.corner[1]] + points_[face.corner[2]], count += 3;
        return (1 / count) * sum;
    }

    bool isConvex(const Face& face) const {
        for (const std::uint32_t next : face.beyond)
            for (const std::uint32_t i : faces_[next].corner)
                if (face.plane.height(points_[i]) > kConvex) return false;
        return true;
    }

    const std::vector<DVec3>& points_;
    std::vector<Face> faces_;
    std::vector<std::uint32_t> pending_, removed_;
    std::vector<std::pair<std::uint32_t, std::uint32_t>> startsAt_;  ///< round, and the face whose edge begins there
    std::uint32_t round_ = 0;
};

}  // namespace

std::vector<HullTriangle> quickHull(const std::vector<DVec3>& points) { return Quick(points).make(); }

}  // namespace ragtop
