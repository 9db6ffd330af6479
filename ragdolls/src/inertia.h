#pragma once

#include "ragtop/math.h"

namespace ragtop {

inline constexpr float kGravity = 9.81f;  ///< m/s²

/// m (r² E − r rᵀ), kg m²: what a point mass at r adds to the inertia about the origin.
inline Mat3 steiner(float mass, const Vec3& r) {
    const float square = lengthSquared(r);
    return {mass * (square * Vec3{1, 0, 0} - r.x * r), mass * (square * Vec3{0, 1, 0} - r.y * r),
            mass * (square * Vec3{0, 0, 1} - r.z * r)};
}

}  // namespace ragtop
