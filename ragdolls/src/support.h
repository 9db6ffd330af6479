#pragma once

#include <array>
#include <span>
#include <vector>

#include "ragtop/body_pose.h"

namespace ragtop {

/// The underside of a foot, in its bone.
struct Sole {
    std::vector<Vec3> corners{};   ///< of a box or hull four, of a capsule two
    Vec3 middle{}, up{0, 1, 0};    ///< up: unit vector across it, out of the ground
    std::array<Vec3, 2> halves{};  ///< from the middle to the middles of two edges that meet

    /// What of a way from the middle is over that share of the sole.
    Vec3 within(const Vec3& way, float share) const;
};
Sole soleOf(const BodyAxes& axes, int foot);

/// A point on the ground.
struct Spot {
    float x = 0, z = 0;
};
/// m, from a point to the nearest edge of the convex hull of others, negative outside of it; of fewer than three others
/// to the nearest of them, negative. Reorders them.
float marginWithin(std::span<Spot> corners, const Spot& point);

}  // namespace ragtop
