#include "support.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>
#include <utility>

#include "shape_corners.h"

namespace ragtop {
namespace {

constexpr std::size_t kMostCorners = 16;

/// Twice the area of the triangle a b c, positive when they turn from x to z.
float turning(const Spot& a, const Spot& b, const Spot& c) {
    return (b.x - a.x) * (c.z - a.z) - (b.z - a.z) * (c.x - a.x);
}

/// The convex hull in the order of its turning [Andrew, Another Efficient Algorithm for Convex Hulls in Two Dimensions,
/// 1979].
std::size_t hullOf(std::span<Spot> corners, std::array<Spot, kMostCorners + 1>& hull) {
    std::sort(corners.begin(), corners.end(),
              [](const Spot& a, const Spot& b) { return a.x < b.x || (a.x == b.x && a.z < b.z); });
    std::size_t count = 0;
    const auto add = [&](const Spot& spot, std::size_t least) {
        while (count >= least + 2 && turning(hull[count - 2], hull[count - 1], spot) <= 0) --count;
        hull[count++] = spot;
    };
    for (const Spot& spot : corners) add(spot, 0);
    const std::size_t lower = count - 1;
    for (std::size_t i = corners.size() - 1; i-- > 0;) add(corners[i], lower);
    return count - 1;
}

float distance(const Spot& a, const Spot& b) {
    return std::sqrt((a.x - b.x) * (a.x - b.x) + (a.z - b.z) * (a.z - b.z));
}

float distanceToEdge(const Spot& a, const Spot& b, const Spot& p) {
    const float dx = b.x - a.x, dz = b.z - a.z, square = dx * dx + dz * dz;
    const float share = square > 0 ? std::clamp(((p.x - a.x) * dx + (p.z - a.z) * dz) / square, 0.0f, 1.0f) : 0.0f;
    return distance({a.x + share * dx, a.z + share * dz}, p);
}

std::vector<Vec3> cornersUnder(const BodyAxes& axes, int foot) {
    const RagdollPart& part = axes.def().parts[static_cast<std::size_t>(foot)];
    const Vec3 down = inverseRotate(axes.zero(foot), {0, -1, 0});
    std::vector<Vec3> corners = soleCorners(part, down);
    // Those of a level sole tie, and are told apart by their places.
    std::sort(corners.begin(), corners.end(), [&](const Vec3& a, const Vec3& b) {
        const float depth = dot(a, down) - dot(b, down);
        return depth != 0 ? depth > 0 : std::tie(a.x, a.y, a.z) < std::tie(b.x, b.y, b.z);
    });
    if (const auto* capsule = std::get_if<Capsule>(&part.shape)) {
        for (const float end : {-1.0f, 1.0f})
            corners.push_back(transformPoint(part.frame, {0, end * capsule->halfHeight, 0}) + capsule->radius * down);
    }
    return corners;
}

}  // namespace

Sole soleOf(const BodyAxes& axes, int foot) {
    Sole sole{.corners = cornersUnder(axes, foot)};
    const std::vector<Vec3>& c = sole.corners;
    for (const Vec3& corner : c) sole.middle += (1.0f / static_cast<float>(c.size())) * corner;
    const Vec3 up = inverseRotate(axes.zero(foot), {0, 1, 0});
    sole.up = up;
    if (c.size() == 2) sole.halves[0] = 0.5f * (c[1] - c[0]);
    if (c.size() == 4) {
        // The longest way from one corner is across.
        std::array<Vec3, 3> ways{c[1] - c[0], c[2] - c[0], c[3] - c[0]};
        std::sort(ways.begin(), ways.end(), [](const Vec3& a, const Vec3& b) { return length(a) < length(b); });
        sole.halves = {0.5f * ways[0], 0.5f * ways[1]};
        sole.up = normalized(cross(ways[0], ways[1]), up);
        if (dot(sole.up, up) < 0) sole.up = -sole.up;
    }
    return sole;
}

Vec3 Sole::within(const Vec3& way, float share) const {
    Vec3 kept;
    for (const Vec3& half : halves) {
        const float square = lengthSquared(half);
        if (square > 0) kept += std::clamp(dot(way, half) / square, -share, share) * half;
    }
    return kept;
}

float marginWithin(std::span<Spot> corners, const Spot& point) {
    float nearest = std::numeric_limits<float>::infinity();
    if (corners.size() < 3 || corners.size() > kMostCorners) {
        for (const Spot& corner : corners) nearest = std::min(nearest, distance(corner, point));
        return -nearest;
    }
    std::array<Spot, kMostCorners + 1> hull{};
    const std::size_t count = hullOf(corners, hull);
    bool inside = true;
    for (std::size_t i = 0; i < count; ++i) {
        const Spot &a = hull[i], &b = hull[(i + 1) % count];
        inside = inside && turning(a, b, point) >= 0;
        nearest = std::min(nearest, distanceToEdge(a, b, point));
    }
    return inside ? nearest : -nearest;
}

}  // namespace ragtop
