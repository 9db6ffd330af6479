#pragma once

#include <optional>
#include <span>
#include <vector>

#include "fit.h"
#include "growing_hull.h"

namespace ragtop {

inline constexpr std::size_t kSampledPoints = 512;  ///< that tell the form of many
/// At most so many of the points, evenly from all of them.
std::vector<Vec3> sampled(std::span<const Vec3> points);

/// A hull about points, and what their own has of volume.
struct FittedHull {
    FittedShape fitted;
    float pointsVolume = 0;  ///< m³, of the hull of all points, or little less
};

/// A hull of at most 38 corners that holds at least `share` of the points: of those farthest out, moved away from the
/// middle where that many corners do not suffice, and no more of them than make it snug. None where the points lie in a
/// plane.
std::optional<FittedHull> fitHull(std::span<const Vec3> points, const Quat& rotation, float share);

/// How far points are out of a hull.
struct Gauge {
    Vec3 middle{};                ///< within
    std::vector<Vec3> normals{};  ///< of the faces, over the way from the middle to their planes

    Gauge() = default;
    Gauge(std::span<const Vec3> corners, std::span<const FacePlane> planes);
    /// Of each point in the hull's frame, the size over that of the hull at which this has it on its surface.
    std::vector<float> sizes(std::span<const Vec3> points, const Frame& frame) const;
};
Gauge gaugeOf(const ConvexHull& hull);

/// The part of a hull that is above `floor` along `up` (unit); at least `least` thick along that.
FittedShape hullAbove(const FittedShape& hull, const Vec3& up, float floor, float least);

}  // namespace ragtop
