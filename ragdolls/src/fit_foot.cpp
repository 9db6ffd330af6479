#include "fit_foot.h"

#include <algorithm>
#include <limits>
#include <optional>
#include <vector>

#include "fit_hull.h"

namespace ragtop {
namespace {

constexpr float kSoleHeight = 0.3f;        ///< of the height of a foot, up to which its skin tells its sole
constexpr float kClearance = 0.05f;        ///< of it, that what is not the sole is above the ground
constexpr float kRoundSole = 0.886f;       ///< of the sides of the rectangle about an ellipse, those of one as large
constexpr std::size_t kFewestOfFoot = 16;  ///< corners of the hull
constexpr std::size_t kMostOfFoot = 52;
constexpr float kSurface = 1 + 1e-5f;  ///< size of a hull that holds what is on its surface
constexpr float kMostAir = 1.2f;       ///< times the volume of the hull, that a box in its stead may have

std::vector<Vec3> within(const FittedShape& room, std::span<const Vec3> points) {
    const Vec3 half = std::get<Box>(room.shape).halfExtents;
    std::vector<Vec3> inside;
    for (const Vec3& point : points) {
        const Vec3 local = inverseTransformPoint(room.frame, point), size = abs(local) - half;
        if (size.x <= 0 && size.y <= 0 && size.z <= 0) inside.push_back(local);
    }
    return inside;
}

/// On the underside of the box, of a size relative to the rectangle about the lowest points.
std::vector<Vec3> soleUnder(const Vec3& half, std::span<const Vec3> inside, float size) {
    Vec3 lower = half, upper = -half;
    for (const Vec3& point : inside)
        if (point.z <= (2 * kSoleHeight - 1) * half.z) {
            lower = min(lower, point);
            upper = max(upper, point);
        }
    const Vec3 middle = 0.5f * (lower + upper), reach = 0.5f * size * (upper - lower);
    std::vector<Vec3> sole;
    for (const float x : {-1.0f, 1.0f})
        for (const float y : {-1.0f, 1.0f}) sole.push_back({middle.x + x * reach.x, middle.y + y * reach.y, -half.z});
    return sole;
}

struct FootHull {
    std::vector<Vec3> corners;  ///< in the frame of the room
    FittedShape room;
    float volume;  ///< m³
};

/// Points that a hull is to hold a share of. What one holds, those about it hold too.
struct Wanted {
    std::vector<Vec3> left;
    float most;  ///< that may be left

    Wanted(std::span<const Vec3> points, float share)
        : left(points.begin(), points.end()), most((1 - share) * static_cast<float>(points.size())) {}
    bool canHold(const Gauge& gauge, const Frame& frame) const {
        const std::vector<float> sizes = gauge.sizes(left, frame);
        return static_cast<float>(
                   std::count_if(sizes.begin(), sizes.end(), [](float size) { return size > kSurface; })) <= most;
    }
    bool isHeld(const Gauge& gauge, const Frame& frame) {
        const std::vector<float> sizes = gauge.sizes(left, frame);
        std::size_t count = 0;
        for (std::size_t i = 0; i < sizes.size(); ++i)
            if (sizes[i] > kSurface) left[count++] = left[i];
        left.resize(count);
        return static_cast<float>(count) <= most;
    }
};

/// Of fewest corners on a sole, about most of what is in a box; `few` are some of the points. None of `most` m³ or
/// more.
std::optional<FootHull> hullIn(const FittedShape& room, float soleSize, std::span<const Vec3> few,
                               std::span<const Vec3> points, float share, float most) {
    const std::vector<Vec3> inside = within(room, few),
                            sole = soleUnder(std::get<Box>(room.shape).halfExtents, inside, soleSize);
    const float bottom = sole[0].z;
    std::vector<Vec3> upper = sole;
    for (const Vec3& point : inside)
        if (point.z > (1 - 2 * kClearance) * bottom) upper.push_back(point);
    GrowingHull grown(upper);
    if (grown.isFlat()) return {};
    grown.grow(kMostOfFoot);
    const std::vector<Vec3> order = grown.corners();
    Wanted ofFew(few, share), ofAll(points, share);
    // Where all corners allowed are too few, fewer are.
    const Gauge widest(order, grown.planes());
    if (!ofFew.canHold(widest, room.frame) || !ofAll.canHold(widest, room.frame)) return {};
    for (std::size_t count = kFewestOfFoot; count <= kMostOfFoot; count += 12) {
        std::vector<Vec3> corners = sole;
        for (const Vec3& corner : order)
            if (corner.z > bottom && corners.size() < count) corners.push_back(corner);
        GrowingHull hull(corners);
        hull.grow(corners.size());
        if (hull.volume() >= most) return {};
        const Gauge gauge(corners, hull.planes());
        if (ofFew.isHeld(gauge, room.frame) && ofAll.isHeld(gauge, room.frame))
            return FootHull{std::move(corners), room, hull.volume()};
    }
    return {};
}

}  // namespace

/// The corners of the sole are the only ones on the ground, so that a foot stands on the same four points in each step.
/// A hull leaves out some of what is in its box, so the box is that of more points, of as few more as do.
FittedShape fitFoot(std::span<const Vec3> points, const Quat& rotation, float share) {
    const std::vector<Vec3> few = sampled(points);
    const FittedShape box = fitBox(points, rotation, share);
    std::optional<FootHull> least;
    for (const float size : {kRoundSole, 1.0f})
        for (const float more : {0.25f, 0.5f, 1.0f}) {
            const float most = least ? least->volume : std::numeric_limits<float>::infinity();
            auto hull = hullIn(fitBox(few, rotation, share + more * (1 - share)), size, few, points, share, most);
            if (!hull) continue;
            least = std::move(hull);
            break;
        }
    if (!least || massOf(box.shape, 1.0f).mass <= kMostAir * least->volume) return box;
    return {ConvexHull(least->corners), least->room.frame};
}

FittedShape fitBoth(std::span<const Vec3> points, std::size_t own, const LeftOut& allowed, const FitShape& fit) {
    const auto leftOut = [](const FittedShape& shape, std::span<const Vec3> some) {
        return some.size() - static_cast<std::size_t>(countInside(shape, some));
    };
    const auto share = [](float part, std::size_t of) { return part / static_cast<float>(of); };
    const float all = share(allowed.own + allowed.rest, points.size());
    float most = 0;  // of either, over what it may leave out, in proportion to what both do
    for (const float less : {1.0f, 0.875f, 0.75f, 0.5f}) {
        if (less * most > 1) continue;
        FittedShape shape = fit(points, 1 - less * all);
        const auto over = [](std::size_t left, float may) {
            return left == 0 ? 0 : static_cast<float>(left) / std::max(may, 1e-6f);
        };
        const float beyond = std::max(over(leftOut(shape, points.first(own)), allowed.own),
                                      over(leftOut(shape, points.subspan(own)), allowed.rest));
        if (beyond <= 1) return shape;
        most = beyond / less;
    }
    return fit(points, 1);
}

}  // namespace ragtop
