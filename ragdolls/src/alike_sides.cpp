#include "alike_sides.h"

#include <algorithm>
#include <utility>

namespace ragtop {
namespace {

constexpr float kAsLarge = 1.3f;  ///< fits of one shape to alike skins differ by less in volume

float volumeOf(const Shape& shape) { return massOf(shape, 1.0f).mass; }

/// Across x of the axes. Capsules and boxes are their own mirror images, so turning them is enough; hulls turn inside
/// out along x.
FittedShape mirrored(const FittedShape& fitted, const Frame& from, const Frame& to) {
    Frame local = inverse(from) * fitted.frame;
    local.position.x = -local.position.x;
    local.rotation = {local.rotation.x, -local.rotation.y, -local.rotation.z, local.rotation.w};
    Frame frame = to * local;
    frame.rotation = normalized(frame.rotation);
    const auto* hull = std::get_if<ConvexHull>(&fitted.shape);
    if (!hull) return {fitted.shape, frame};
    std::vector<Vec3> corners(hull->vertices().begin(), hull->vertices().end());
    for (Vec3& corner : corners) corner.x = -corner.x;
    return {ConvexHull(corners), frame};
}

bool doesFor(const FittedShape& fitted, const SidePart& part, float share) {
    return static_cast<float>(countInside(fitted, part.skin)) >= share * static_cast<float>(part.skin.size());
}

}  // namespace

bool makeAlike(SidePart& left, SidePart& right, float share) {
    const float ofLeft = volumeOf(left.fitted.shape), ofRight = volumeOf(right.fitted.shape);
    if (std::max(ofLeft, ofRight) > kAsLarge * std::min(ofLeft, ofRight)) return false;
    for (const bool smaller : {true, false}) {
        const bool byLeft = (ofLeft <= ofRight) == smaller;
        const FittedShape one = byLeft ? left.fitted : mirrored(right.fitted, right.axes, left.axes);
        if (!doesFor(one, left, share)) continue;
        const FittedShape other = byLeft ? mirrored(left.fitted, left.axes, right.axes) : right.fitted;
        if (!doesFor(other, right, share)) continue;
        left.fitted = one;
        right.fitted = other;
        return true;
    }
    return false;
}

bool makeAlike(SidePart& left, SidePart& right, const FittedShape& fitted, float share) {
    const float most = kAsLarge * std::min(volumeOf(left.fitted.shape), volumeOf(right.fitted.shape));
    const FittedShape other = mirrored(fitted, left.axes, right.axes);
    if (volumeOf(fitted.shape) > most || !doesFor(fitted, left, share) || !doesFor(other, right, share)) return false;
    left.fitted = fitted;
    right.fitted = other;
    return true;
}

std::vector<Vec3> mirrored(std::span<const Vec3> points, const Frame& from, const Frame& to) {
    std::vector<Vec3> result;
    result.reserve(points.size());
    for (const Vec3& point : points) {
        Vec3 local = inverseTransformPoint(from, point);
        local.x = -local.x;
        result.push_back(transformPoint(to, local));
    }
    return result;
}

}  // namespace ragtop
