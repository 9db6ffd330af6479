#pragma once

#include <array>
#include <span>
#include <vector>

#include "ragtop/body_pose.h"

namespace ragtop {

/// Corners of the underside of a foot, in its bone: of a box four, of a capsule two.
std::vector<Vec3> soleOf(const BodyAxes& axes, int foot);

/// A point on the ground.
struct Spot {
    float x = 0, z = 0;
};
/// m, from a point to the nearest edge of the convex hull of others, negative outside of it; of fewer than three others
/// to the nearest of them, negative. Reorders them.
float marginWithin(std::span<Spot> corners, const Spot& point);

}  // namespace ragtop
