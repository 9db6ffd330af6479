#pragma once

#include <cmath>

#include "ragtop/math.h"

/// Vectors and turns in double precision, for what is solved once where a car is made. Without angles, so that it has
/// the same bits on every platform.
namespace ragtop {

constexpr double dot(const DVec3& a, const DVec3& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
constexpr DVec3 cross(const DVec3& a, const DVec3& b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
inline double length(const DVec3& a) { return std::sqrt(dot(a, a)); }
inline DVec3 unit(const DVec3& a) { return (1 / length(a)) * a; }

/// A unit quaternion.
struct DQuat {
    double x = 0, y = 0, z = 0, w = 1;
};

constexpr DVec3 rotate(const DQuat& q, const DVec3& v) {
    const DVec3 axis{q.x, q.y, q.z}, t = 2 * cross(axis, v);
    return v + q.w * t + cross(axis, t);
}

/// Turned further by a small vector of rotation, to second order.
inline DQuat turnedBy(const DQuat& q, const DVec3& by) {
    const DVec3 half = 0.5 * by, axis{q.x, q.y, q.z};
    const DVec3 turned = axis + q.w * half + cross(half, axis);
    const double w = q.w - dot(half, axis);
    const double size = 1 / std::sqrt(dot(turned, turned) + w * w);
    return {size * turned.x, size * turned.y, size * turned.z, size * w};
}

}  // namespace ragtop
