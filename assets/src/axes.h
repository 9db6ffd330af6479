#pragma once

#include "ragtop/math.h"
#include "ragtop/mesh_file.h"

namespace ragtop {

/// Turns the axis that points up in a file into y by a quarter turn about a coordinate axis; exact.
inline Quat uprightRotation(UpAxis up) {
    constexpr float kHalfRoot = 0.70710678118654752f;
    if (up == UpAxis::z) return {-kHalfRoot, 0, 0, kHalfRoot};
    if (up == UpAxis::x) return {0, 0, kHalfRoot, kHalfRoot};
    return {};
}

/// The same for a point, without rounding.
constexpr Vec3 upright(UpAxis up, const Vec3& p) {
    if (up == UpAxis::z) return {p.x, p.z, -p.y};
    if (up == UpAxis::x) return {-p.y, p.x, p.z};
    return p;
}

}  // namespace ragtop
