#include "growing_hull.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numeric>
#include <utility>

namespace ragtop {
namespace {

constexpr float kFlat = 1e-3f;   ///< of the longest way between points
constexpr float kSlack = 1e-5f;  ///< of that, above rounding
constexpr float kCoarse = 100;   ///< times that, at which rounding no longer turns a face

float heightOver(const FacePlane& plane, const Vec3& point) { return dot(plane.normal, point) - plane.offset; }

std::uint64_t edgeOf(std::uint32_t from, std::uint32_t to) { return std::uint64_t{from} << 32 | to; }

template <class Measure>
std::uint32_t farthestBy(std::span<const Vec3> points, Measure measure) {
    std::uint32_t best = 0;
    float most = measure(points[0]);
    for (std::uint32_t i = 1; i < points.size(); ++i)
        if (const float m = measure(points[i]); m > most) best = i, most = m;
    return best;
}

}  // namespace

GrowingHull::GrowingHull(std::span<const Vec3> points) : points_(points) {
    if (points.size() < 4) return;
    const std::uint32_t a = farthestBy(points, [&](const Vec3& p) { return lengthSquared(p - points[0]); });
    std::uint32_t b = farthestBy(points, [&](const Vec3& p) { return lengthSquared(p - points[a]); });
    const Vec3 along = points[b] - points[a];
    const float size = length(along);
    if (!(size > 0)) return;
    std::uint32_t c = farthestBy(points, [&](const Vec3& p) { return lengthSquared(cross(along, p - points[a])); });
    const Vec3 across = cross(along, points[c] - points[a]);
    if (!(length(across) > kFlat * size * size)) return;
    const Vec3 normal = normalized(across);
    const std::uint32_t d = farthestBy(points, [&](const Vec3& p) { return std::abs(dot(normal, p - points[a])); });
    const float height = dot(normal, points[d] - points[a]);
    if (!(std::abs(height) > kFlat * size)) return;
    if (height > 0) std::swap(b, c);
    slack_ = kSlack * size;
    corners_ = {a, b, c, d};
    middle_ = 0.25f * (points[a] + points[b] + points[c] + points[d]);
    const bool made = makeFace(a, b, c, faces_) && makeFace(a, d, b, faces_) && makeFace(b, d, c, faces_) &&
                      makeFace(c, d, a, faces_);
    if (!made) {
        faces_.clear();
        return;
    }
    std::vector<std::uint32_t> all(points.size());
    std::iota(all.begin(), all.end(), 0u);
    share(all, 0);
}

bool GrowingHull::makeFace(std::uint32_t a, std::uint32_t b, std::uint32_t c, std::vector<Face>& into) const {
    const Vec3 ab = points_[b] - points_[a], ac = points_[c] - points_[a], across = cross(ab, ac);
    // Of three points in line, rounding makes a plane of any direction.
    if (!(length(across) > kCoarse * slack_ * std::max({length(ab), length(ac), length(ac - ab)}))) return false;
    const Vec3 normal = normalized(across);
    const FacePlane plane{normal, dot(normal, points_[a])};
    if (heightOver(plane, middle_) >= 0) return false;
    into.push_back({{a, b, c}, plane});
    return true;
}

/// To the first face from a number on that they are over; what is over none is inside.
void GrowingHull::share(std::span<const std::uint32_t> points, std::size_t first) {
    for (const std::uint32_t i : points)
        for (std::size_t f = first; f < faces_.size(); ++f)
            if (put(i, faces_[f])) break;
}

bool GrowingHull::put(std::uint32_t point, Face& face) const {
    const float height = heightOver(face.plane, points_[point]);
    if (height <= slack_) return false;
    face.outside.push_back(point);
    if (height > face.height) face.height = height, face.farthest = point;
    return true;
}

/// The faces that the point sees give way to those between it and the edges round them: the sides of seen faces whose
/// other side is not seen.
bool GrowingHull::addSeeing(std::uint32_t point, float least) {
    seen_.clear();
    edges_.clear();
    for (const Face& face : faces_) {
        seen_.push_back(heightOver(face.plane, points_[point]) > least);
        for (std::size_t k = 0; k < 3 && seen_.back(); ++k)
            edges_.push_back(edgeOf(face.corner[k], face.corner[(k + 1) % 3]));
    }
    cone_.clear();
    for (const std::uint64_t edge : edges_) {
        const auto from = static_cast<std::uint32_t>(edge >> 32), to = static_cast<std::uint32_t>(edge);
        if (std::find(edges_.begin(), edges_.end(), edgeOf(to, from)) == edges_.end() &&
            !makeFace(from, to, point, cone_))
            return false;
    }
    orphans_.clear();
    std::size_t first = 0;
    for (std::size_t i = 0; i < faces_.size(); ++i) {
        if (seen_[i])
            orphans_.insert(orphans_.end(), faces_[i].outside.begin(), faces_[i].outside.end());
        else if (first++ != i)
            faces_[first - 1] = std::move(faces_[i]);
    }
    faces_.resize(first);
    faces_.insert(faces_.end(), std::make_move_iterator(cone_.begin()), std::make_move_iterator(cone_.end()));
    corners_.push_back(point);
    share(orphans_, first);
    return true;
}

/// A point in line with an edge is in one plane with a face beside it, which then gives way too.
bool GrowingHull::add(std::uint32_t point) {
    return addSeeing(point, slack_) || addSeeing(point, -slack_) || addSeeing(point, -kCoarse * slack_);
}

void GrowingHull::leaveOut(Face& face) {
    std::vector<std::uint32_t> others = std::exchange(face.outside, {});
    std::erase(others, face.farthest);
    face.height = 0;
    for (const std::uint32_t i : others) put(i, face);
}

void GrowingHull::grow(std::size_t most) {
    while (!isFlat() && corners_.size() < most) {
        const auto face = std::max_element(faces_.begin(), faces_.end(),
                                           [](const Face& a, const Face& b) { return a.height < b.height; });
        if (!(face->height > 0)) return;
        // What rounding leaves in doubt is no corner.
        if (!add(face->farthest)) leaveOut(*face);
    }
}

std::vector<Vec3> GrowingHull::corners() const {
    std::vector<Vec3> corners;
    for (const std::uint32_t i : corners_) corners.push_back(points_[i]);
    return corners;
}

std::vector<FacePlane> GrowingHull::planes() const {
    std::vector<FacePlane> planes;
    for (const Face& face : faces_) planes.push_back(face.plane);
    return planes;
}

float GrowingHull::volume() const {
    float six = 0;
    for (const Face& face : faces_) {
        const Vec3 a = points_[face.corner[0]] - middle_, b = points_[face.corner[1]] - middle_,
                   c = points_[face.corner[2]] - middle_;
        six += dot(a, cross(b, c));
    }
    return six / 6;
}

}  // namespace ragtop
