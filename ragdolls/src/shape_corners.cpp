#include "shape_corners.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace ragtop {
namespace {

constexpr float kSoleShare = 0.05f;  ///< of the height of a hull, over its lowest corner, that its sole has

/// In the frame of the shape.
std::vector<Vec3> ownCorners(const Shape& shape) {
    if (const auto* hull = std::get_if<ConvexHull>(&shape)) return {hull->vertices().begin(), hull->vertices().end()};
    Vec3 half;
    if (const auto* box = std::get_if<Box>(&shape)) half = box->halfExtents;
    if (const auto* sphere = std::get_if<Sphere>(&shape)) half = {sphere->radius, sphere->radius, sphere->radius};
    if (const auto* capsule = std::get_if<Capsule>(&shape))
        half = {capsule->radius, capsule->radius + capsule->halfHeight, capsule->radius};
    std::vector<Vec3> corners;
    for (int i = 0; i < 8; ++i)
        corners.push_back(scale(half, {i & 1 ? 1.0f : -1.0f, i & 2 ? 1.0f : -1.0f, i & 4 ? 1.0f : -1.0f}));
    return corners;
}

}  // namespace

std::vector<Vec3> cornersOf(const RagdollPart& part) {
    std::vector<Vec3> corners = ownCorners(part.shape);
    for (Vec3& corner : corners) corner = transformPoint(part.frame, corner);
    return corners;
}

std::vector<Vec3> soleCorners(const RagdollPart& part, const Vec3& down) {
    if (!std::holds_alternative<Box>(part.shape) && !std::holds_alternative<ConvexHull>(part.shape)) return {};
    const Vec3 local = inverseRotate(part.frame.rotation, down), steep = abs(local);
    const int axis = steep.x > steep.y ? (steep.x > steep.z ? 0 : 2) : (steep.y > steep.z ? 1 : 2);
    const float sign = local[axis] < 0 ? -1.0f : 1.0f;
    const std::vector<Vec3> corners = ownCorners(part.shape);
    float lowest = -std::numeric_limits<float>::infinity(), highest = -lowest;
    for (const Vec3& corner : corners) {
        lowest = std::max(lowest, sign * corner[axis]);
        highest = std::min(highest, sign * corner[axis]);
    }
    const float infinite = std::numeric_limits<float>::infinity();
    Vec3 lower{infinite, infinite, infinite}, upper = -lower;
    for (const Vec3& corner : corners) {
        if (sign * corner[axis] < lowest - kSoleShare * (lowest - highest)) continue;
        lower = min(lower, corner);
        upper = max(upper, corner);
    }
    lower[axis] = upper[axis] = sign * lowest;
    std::vector<Vec3> sole;
    const int one = (axis + 1) % 3, other = (axis + 2) % 3;
    for (int i = 0; i < 4; ++i) {
        Vec3 corner = lower;
        if (i & 1) corner[one] = upper[one];
        if (i & 2) corner[other] = upper[other];
        sole.push_back(transformPoint(part.frame, corner));
    }
    return sole;
}

}  // namespace ragtop
