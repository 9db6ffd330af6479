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

bool holdsShare(const FittedShape& fitted, std::span<const Vec3> skin, float share) {
    return static_cast<float>(countInside(fitted, skin)) >= share * static_cast<float>(skin.size());
}

/// Of a shape of one side. The skin of the other is mirrored, not the shape: building a hull takes longer.
bool doesForBoth(const FittedShape& fitted, const SidePart& own, const SidePart& other, float share) {
    return holdsShare(fitted, own.skin, share) && holdsShare(fitted, mirrored(other.skin, other.axes, own.axes), share);
}

void giveBoth(const FittedShape& fitted, SidePart& own, SidePart& other) {
    own.fitted = fitted;
    other.fitted = mirrored(fitted, own.axes, other.axes);
}

}  // namespace

bool makeAlike(SidePart& left, SidePart& right, float share) {
    const float ofLeft = volumeOf(left.fitted.shape), ofRight = volumeOf(right.fitted.shape);
    if (std::max(ofLeft, ofRight) > kAsLarge * std::min(ofLeft, ofRight)) return false;
    for (const bool smaller : {true, false}) {
        const bool byLeft = (ofLeft <= ofRight) == smaller;
        SidePart &own = byLeft ? left : right, &other = byLeft ? right : left;
        if (!doesForBoth(own.fitted, own, other, share)) continue;
        giveBoth(own.fitted, own, other);
        return true;
    }
    return false;
}

bool makeAlike(SidePart& left, SidePart& right, const FittedShape& fitted, float share) {
    const float most = kAsLarge * std::min(volumeOf(left.fitted.shape), volumeOf(right.fitted.shape));
    if (volumeOf(fitted.shape) > most || !doesForBoth(fitted, left, right, share)) return false;
    giveBoth(fitted, left, right);
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
