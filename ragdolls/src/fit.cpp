#include "fit.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

#include "fit_hull.h"

namespace ragtop {
namespace {

constexpr float kRounding = 1e-5f;         ///< of the size of a shape
constexpr std::size_t kManyPoints = 1024;  ///< from which a radius is sought on

float volumeOf(const Capsule& capsule) {
    return kPi * capsule.radius * capsule.radius * (2.0f * capsule.halfHeight + 4.0f / 3.0f * capsule.radius);
}

float volumeOf(const Box& box) { return 8.0f * box.halfExtents.x * box.halfExtents.y * box.halfExtents.z; }

bool holds(const Capsule& capsule, const Vec3& local) {
    const float y = local.y - std::clamp(local.y, -capsule.halfHeight, capsule.halfHeight);
    const float radius = capsule.radius + kRounding * (capsule.radius + capsule.halfHeight);
    return local.x * local.x + y * y + local.z * local.z <= radius * radius;
}

bool holds(const Box& box, const Vec3& local) {
    const Vec3 size = abs(local) - box.halfExtents;
    const float slack = kRounding * length(box.halfExtents);
    return size.x <= slack && size.y <= slack && size.z <= slack;
}

/// A capsule along y.
struct UprightCapsule {
    Capsule capsule;
    Vec3 center;
};

/// The value that `rank` of the others are below; reorders.
float ranked(std::vector<float>& values, std::size_t rank) {
    const auto at = values.begin() + static_cast<std::ptrdiff_t>(std::min(rank, values.size() - 1));
    std::nth_element(values.begin(), at, values.end());
    return *at;
}

Quat alongY(const Vec3& axis) { return rotationBetween({0, 1, 0}, axis); }

/// A point holds when it is within the radius of the segment. At distance d from the line it allows the segment's
/// ends to stop √(r² − d²) short of it; the ends leave out the farthest points evenly.
std::optional<UprightCapsule> capsuleOfRadius(std::span<const Vec3> local, const Vec3& center, float radius,
                                              std::size_t spare) {
    std::vector<float> lower, upper;
    lower.reserve(local.size());
    upper.reserve(local.size());
    for (const Vec3& point : local) {
        const float x = point.x - center.x, z = point.z - center.z;
        const float left = radius * radius - x * x - z * z;
        if (left < 0) continue;
        const float slack = std::sqrt(left);
        lower.push_back(point.y + slack);
        upper.push_back(point.y - slack);
    }
    const std::size_t outside = local.size() - lower.size();
    if (outside > spare) return {};
    const std::size_t each = (spare - outside) / 2;
    float bottom = ranked(lower, each), top = ranked(upper, upper.size() - 1 - each);
    if (bottom > top) bottom = top = 0.5f * (bottom + top);
    return UprightCapsule{{radius, 0.5f * (top - bottom)}, {center.x, 0.5f * (top + bottom), center.z}};
}

/// The least capsule of a few radii about a line.
struct CapsuleSearch {
    std::span<const Vec3> local;
    Vec3 center;  ///< of the line along y
    std::size_t spare;
    UprightCapsule best{};
    float least = std::numeric_limits<float>::infinity();  ///< m³

    bool found() const { return least < std::numeric_limits<float>::infinity(); }

    void consider(float radius) {
        if (!(radius > 0)) return;
        const auto fitted = capsuleOfRadius(local, center, radius, spare);
        if (!fitted) return;
        const float volume = volumeOf(fitted->capsule);
        if (volume >= least) return;
        const auto inside = std::count_if(local.begin(), local.end(), [&](const Vec3& point) {
            return holds(fitted->capsule, point - fitted->center);
        });
        if (local.size() - static_cast<std::size_t>(inside) > spare) return;
        least = volume;
        best = *fitted;
    }

    const UprightCapsule& run() {
        std::vector<float> distance;
        distance.reserve(local.size());
        for (const Vec3& point : local) {
            const float dx = point.x - center.x, dz = point.z - center.z;
            distance.push_back(std::sqrt(dx * dx + dz * dz));
        }
        constexpr std::size_t kTries = 12;
        for (std::size_t i = 0; i < kTries; ++i)
            consider(ranked(distance, distance.size() - 1 - spare + spare * i / kTries) * (1.0f + kRounding));
        consider(ranked(distance, distance.size() - 1) * (1.0f + kRounding));
        // A cloud flatter than it is wide may fit no tube's caps; a ball about all of it always does.
        for (float radius = ranked(distance, distance.size() - 1); !found();) {
            radius = std::max(1.2f * radius, std::numeric_limits<float>::min());
            consider(radius);
        }
        return best;
    }
};

struct Extent {
    float lower, upper;
};

Extent trimmed(std::vector<float> values, std::size_t each) {
    return {ranked(values, each), ranked(values, values.size() - 1 - each)};
}

/// The first and the last `each` + 1 values become those of a sorted list.
void sortEnds(std::vector<float>& values, std::size_t each) {
    const auto ends = static_cast<std::ptrdiff_t>(std::min(each + 1, values.size()));
    std::nth_element(values.begin(), values.begin() + (ends - 1), values.end());
    std::sort(values.begin(), values.begin() + ends);
    const auto rest = std::max(values.begin() + ends, values.end() - ends);
    if (rest == values.end()) return;
    std::nth_element(values.begin() + ends, rest, values.end());
    std::sort(rest, values.end());
}

std::vector<Vec3> inAxes(std::span<const Vec3> points, const Quat& rotation) {
    std::vector<Vec3> local;
    local.reserve(points.size());
    for (const Vec3& point : points) local.push_back(inverseRotate(rotation, point));
    return local;
}

std::size_t spareOf(std::size_t count, float share) {
    const auto kept = static_cast<std::size_t>(std::ceil(share * static_cast<float>(count)));
    return count - std::min(kept, count);
}

}  // namespace

FittedShape fitCapsule(std::span<const Vec3> points, const Vec3& axis, float share) {
    const Quat rotation = alongY(axis);
    const std::vector<Vec3> local = inAxes(points, rotation);
    const std::size_t spare = spareOf(local.size(), share);
    std::vector<float> x, z;
    for (const Vec3& point : local) {
        x.push_back(point.x);
        z.push_back(point.z);
    }
    const Extent alongX = trimmed(std::move(x), spare / 2), alongZ = trimmed(std::move(z), spare / 2);
    const Vec3 center{0.5f * (alongX.lower + alongX.upper), 0, 0.5f * (alongZ.lower + alongZ.upper)};
    CapsuleSearch search{local, center, spare};
    // Of many points every so manieth tells the radius.
    std::vector<Vec3> some;
    const std::size_t stride = (local.size() + kManyPoints - 1) / kManyPoints;
    for (std::size_t i = 0; stride > 1 && i < local.size(); i += stride) some.push_back(local[i]);
    if (stride > 1) search.consider(CapsuleSearch{some, center, spareOf(some.size(), share)}.run().capsule.radius);
    const UprightCapsule best = search.found() ? search.best : search.run();
    return {best.capsule, {rotate(rotation, best.center), rotation}};
}

/// The more of the outermost points are left out on each side, the less the box holds, so the most is found by halving.
FittedShape fitBox(std::span<const Vec3> points, const Quat& rotation, float share) {
    const std::vector<Vec3> local = inAxes(points, rotation);
    const std::size_t spare = spareOf(local.size(), share);
    std::array<std::vector<float>, 3> values;
    for (int axis = 0; axis < 3; ++axis) {
        std::vector<float>& along = values[static_cast<std::size_t>(axis)];
        along.reserve(local.size());
        for (const Vec3& point : local) along.push_back(point[axis]);
        sortEnds(along, spare / 2);
    }
    Box box;
    Vec3 center;
    std::span<const Vec3> doubtful = local;
    std::vector<Vec3> outermost;
    const auto leavingOut = [&](std::size_t each) {
        Vec3 lower, upper;
        for (int axis = 0; axis < 3; ++axis) {
            const std::vector<float>& along = values[static_cast<std::size_t>(axis)];
            lower[axis] = along[each];
            upper[axis] = along[along.size() - 1 - each];
        }
        box.halfExtents = 0.5f * (upper - lower);
        center = 0.5f * (upper + lower);
        const auto inside = std::count_if(doubtful.begin(), doubtful.end(),
                                          [&](const Vec3& point) { return holds(box, point - center); });
        return doubtful.size() - static_cast<std::size_t>(inside) <= spare;
    };
    // What the smallest of the boxes holds, all hold.
    leavingOut(spare / 2);
    for (const Vec3& point : local)
        if (!holds(box, point - center)) outermost.push_back(point);
    doubtful = outermost;
    std::size_t most = 0, tooMany = spare / 2 + 1;
    while (tooMany - most > 1) {
        const std::size_t middle = most + (tooMany - most) / 2;
        (leavingOut(middle) ? most : tooMany) = middle;
    }
    leavingOut(most);
    return {box, {rotate(rotation, center), rotation}};
}

FittedShape fitShape(std::span<const Vec3> points, const Quat& rotation, float share, float roundness) {
    const FittedShape capsule = fitCapsule(points, rotate(rotation, {0, 1, 0}), share);
    const FittedShape box = fitBox(points, rotation, share);
    const float boxVolume = volumeOf(std::get<Box>(box.shape));
    return roundness * boxVolume < volumeOf(std::get<Capsule>(capsule.shape)) ? box : capsule;
}

namespace {

FittedShape keptAbove(const Capsule& capsule, const Frame& frame, const Vec3& up, float floor, float least) {
    Vec3 axis = rotate(frame.rotation, {0, 1, 0});
    float slope = dot(axis, up);
    if (slope < 0) axis = -axis, slope = -slope;
    const Vec3 top = frame.position + capsule.halfHeight * axis;
    const float radius = std::clamp(dot(top, up) - floor, least, capsule.radius);
    float whole = 2 * capsule.halfHeight;
    if (slope > 0) whole = std::clamp((dot(top, up) - radius - floor) / slope, 0.0f, whole);
    return {Capsule{radius, 0.5f * whole}, {top - 0.5f * whole * axis, frame.rotation}};
}

FittedShape keptAbove(Box box, Frame frame, const Vec3& up, float missing, float least) {
    const Vec3 slopes = inverseRotate(frame.rotation, up);
    std::array<int, 3> order{0, 1, 2};
    std::sort(order.begin(), order.end(), [&](int a, int b) { return std::abs(slopes[a]) > std::abs(slopes[b]); });
    for (const int axis : order) {
        const float slope = slopes[axis], steep = std::abs(slope);
        if (!(missing > 0 && steep > 0)) break;
        const float cut = std::min(missing / steep, std::max(2 * (box.halfExtents[axis] - least), 0.0f));
        missing -= steep * cut;
        box.halfExtents[axis] -= 0.5f * cut;
        Vec3 shift;
        shift[axis] = slope > 0 ? 0.5f * cut : -0.5f * cut;
        frame.position += rotate(frame.rotation, shift);
    }
    return {box, frame};
}

}  // namespace

FittedShape keptAbove(FittedShape fitted, const Vec3& up, float floor, float least) {
    const float missing = floor - bottomOf(fitted, up);
    if (!(missing > 0)) return fitted;
    if (const auto* capsule = std::get_if<Capsule>(&fitted.shape))
        return keptAbove(*capsule, fitted.frame, up, floor, least);
    if (const auto* box = std::get_if<Box>(&fitted.shape)) return keptAbove(*box, fitted.frame, up, missing, least);
    return hullAbove(fitted, up, floor, least);
}

int countInside(const FittedShape& fitted, std::span<const Vec3> points) {
    if (const auto* hull = std::get_if<ConvexHull>(&fitted.shape)) {
        const std::vector<float> sizes = gaugeOf(*hull).sizes(points, fitted.frame);
        return static_cast<int>(
            std::count_if(sizes.begin(), sizes.end(), [](float size) { return size <= 1 + kRounding; }));
    }
    int count = 0;
    for (const Vec3& point : points) {
        const Vec3 local = inverseTransformPoint(fitted.frame, point);
        if (const auto* capsule = std::get_if<Capsule>(&fitted.shape)) count += holds(*capsule, local);
        if (const auto* box = std::get_if<Box>(&fitted.shape)) count += holds(*box, local);
    }
    return count;
}

/// π r² (L − 2r) + 4/3 π r³ = V, for the length L over all and r at most L/2; halving converges to the bit.
FittedShape capsuleBetween(const Vec3& start, const Vec3& end, float volume) {
    const float total = length(end - start);
    const auto volumeAt = [&](float r) { return kPi * r * r * (total - 2.0f * r) + 4.0f / 3.0f * kPi * r * r * r; };
    float lower = 0, upper = 0.5f * total;
    for (int i = 0; i < 24; ++i) {
        const float middle = 0.5f * (lower + upper);
        (volumeAt(middle) < volume ? lower : upper) = middle;
    }
    const Vec3 axis = normalized(end - start, {0, 1, 0});
    return {Capsule{upper, std::max(0.0f, 0.5f * total - upper)}, {0.5f * (start + end), alongY(axis)}};
}

}  // namespace ragtop
