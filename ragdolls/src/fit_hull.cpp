#include "fit_hull.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace ragtop {
namespace {

constexpr std::size_t kFewestOfHull = 20;  ///< of a fitted hull
constexpr std::size_t kMostOfHull = 38;    ///< of it
constexpr float kSnug = 1.15f;             ///< times the volume of the points, with which it has corners enough
constexpr float kRounding = 1e-5f;
constexpr std::size_t kVolumeCorners = 64;  ///< from which the volume of all points is known

Vec3 meanOf(std::span<const Vec3> points) {
    Vec3 sum;
    for (const Vec3& point : points) sum += point;
    return 1.0f / static_cast<float>(points.size()) * sum;
}

}  // namespace

std::vector<Vec3> sampled(std::span<const Vec3> points) {
    std::vector<Vec3> few;
    const std::size_t stride = (points.size() + kSampledPoints - 1) / kSampledPoints;
    for (std::size_t i = 0; i < points.size(); i += stride) few.push_back(points[i]);
    return few;
}

Gauge::Gauge(std::span<const Vec3> corners, std::span<const FacePlane> planes) : middle(meanOf(corners)) {
    for (const FacePlane& plane : planes)
        normals.push_back(1 / (plane.offset - dot(plane.normal, middle)) * plane.normal);
}

/// Face by face over a block of points, so that compilers make lanes of it.
std::vector<float> Gauge::sizes(std::span<const Vec3> points, const Frame& frame) const {
    constexpr std::size_t kBlock = 256;
    std::array<float, kBlock> x, y, z;
    std::vector<float> sizes(points.size(), 0.0f);
    for (std::size_t first = 0; first < points.size(); first += kBlock) {
        const std::size_t count = std::min(kBlock, points.size() - first);
        for (std::size_t i = 0; i < count; ++i) {
            const Vec3 local = inverseTransformPoint(frame, points[first + i]) - middle;
            x[i] = local.x, y[i] = local.y, z[i] = local.z;
        }
        float* const most = sizes.data() + first;
        for (const Vec3& normal : normals)
            for (std::size_t i = 0; i < count; ++i) {
                const float size = normal.x * x[i] + normal.y * y[i] + normal.z * z[i];
                most[i] = size > most[i] ? size : most[i];
            }
    }
    return sizes;
}

Gauge gaugeOf(const ConvexHull& hull) {
    GrowingHull grown(hull.vertices());
    grown.grow(hull.vertices().size());
    return {hull.vertices(), grown.planes()};
}

namespace {

/// The size over that of the hull that holds a share of the points.
float sizeFor(const Gauge& gauge, std::span<const Vec3> points, const Quat& rotation, float share) {
    std::vector<float> sizes = gauge.sizes(points, {{}, rotation});
    const auto wanted = static_cast<std::size_t>(std::ceil(share * static_cast<float>(sizes.size())));
    const auto last = sizes.begin() + static_cast<std::ptrdiff_t>(std::clamp<std::size_t>(wanted, 1, sizes.size()) - 1);
    std::nth_element(sizes.begin(), last, sizes.end());
    return *last;
}

}  // namespace

std::optional<FittedHull> fitHull(std::span<const Vec3> points, const Quat& rotation, float share) {
    std::vector<Vec3> few = sampled(points);
    for (Vec3& point : few) point = inverseRotate(rotation, point);
    GrowingHull whole(few);
    if (whole.isFlat()) return {};
    whole.grow(kVolumeCorners);
    const std::vector<Vec3> order = whole.corners();
    std::vector<Vec3> corners;
    Gauge gauge;
    float least = std::numeric_limits<float>::infinity();
    for (std::size_t most = kFewestOfHull; most <= kMostOfHull && least > kSnug * whole.volume(); most += 6) {
        const std::span<const Vec3> first = std::span<const Vec3>(order).first(std::min(most, order.size()));
        GrowingHull hull(first);
        hull.grow(most);
        const std::vector<Vec3> taken = hull.corners();
        const Gauge reach(taken, hull.planes());
        const float size = sizeFor(reach, few, {}, share), volume = size * size * size * hull.volume();
        if (hull.isFlat() || volume >= least) continue;
        least = volume, corners = taken, gauge = reach;
    }
    if (corners.empty()) return {};
    const float size = (1 + kRounding) * std::max(1.0f, sizeFor(gauge, points, rotation, share));
    for (Vec3& corner : corners) corner = size * (corner - gauge.middle);
    return FittedHull{{ConvexHull(corners), {rotate(rotation, gauge.middle), rotation}}, whole.volume()};
}

namespace {

/// Those of some points in a plane that are corners of them all [Andrew, Another Efficient Algorithm for Convex Hulls
/// in Two Dimensions, 1979].
std::vector<Vec3> cornersInPlane(std::vector<Vec3> points, const Vec3& normal) {
    const Vec3 u = perpendicular(normal), v = cross(normal, u);
    const auto before = [&](const Vec3& a, const Vec3& b) {
        const float x = dot(u, a) - dot(u, b);
        return x < 0 || (x == 0 && dot(v, a) < dot(v, b));
    };
    std::sort(points.begin(), points.end(), before);
    std::vector<Vec3> corners;
    const auto walk = [&](auto first, auto last) {
        const std::size_t start = corners.size();
        for (; first != last; ++first) {
            while (corners.size() > start + 1 &&
                   dot(normal, cross(corners.back() - corners[corners.size() - 2], *first - corners.back())) <= 0)
                corners.pop_back();
            corners.push_back(*first);
        }
    };
    walk(points.begin(), points.end());
    walk(points.rbegin(), points.rend());
    return corners;
}

}  // namespace

/// Ways between all corners cross the plane within the hull, those along its edges at the corners of the cut.
FittedShape hullAbove(const FittedShape& hull, const Vec3& up, float floor, float least) {
    const std::span<const Vec3> corners = std::get<ConvexHull>(hull.shape).vertices();
    const Vec3 along = inverseRotate(hull.frame.rotation, up);
    float top = -std::numeric_limits<float>::infinity(), bottom = -top;
    for (const Vec3& corner : corners) {
        top = std::max(top, dot(corner, along));
        bottom = std::min(bottom, dot(corner, along));
    }
    const float cut = std::min(floor - dot(hull.frame.position, up), top - least);
    if (cut <= bottom + kRounding * (top - bottom)) return hull;
    std::vector<Vec3> kept, crossing;
    for (const Vec3& corner : corners) {
        const float over = dot(corner, along) - cut;
        if (over < 0) continue;
        kept.push_back(corner);
        for (const Vec3& below : corners)
            if (const float under = cut - dot(below, along); over > 0 && under > 0)
                crossing.push_back(below + under / (over + under) * (corner - below));
    }
    const std::vector<Vec3> round = cornersInPlane(std::move(crossing), along);
    kept.insert(kept.end(), round.begin(), round.end());
    return {ConvexHull(kept), hull.frame};
}

}  // namespace ragtop
