#pragma once

#include <cmath>

#include "direct/linear.h"

/// Rotations in double precision. Sine and cosine are series of their own, so that every library gives the same bits.
namespace ragtop::direct {

struct DQuat {
    double x = 0, y = 0, z = 0, w = 1;
};

constexpr DQuat operator*(const DQuat& a, const DQuat& b) {
    return {a.w * b.x + a.x * b.w + a.y * b.z - a.z * b.y, a.w * b.y - a.x * b.z + a.y * b.w + a.z * b.x,
            a.w * b.z + a.x * b.y - a.y * b.x + a.z * b.w, a.w * b.w - a.x * b.x - a.y * b.y - a.z * b.z};
}
constexpr DQuat conjugate(const DQuat& q) { return {-q.x, -q.y, -q.z, q.w}; }
inline DQuat normalized(const DQuat& q) {
    const double s = 1 / std::sqrt(q.x * q.x + q.y * q.y + q.z * q.z + q.w * q.w);
    return {s * q.x, s * q.y, s * q.z, s * q.w};
}
inline DQuat toDouble(const Quat& q) { return normalized({q.x, q.y, q.z, q.w}); }
constexpr Quat toFloat(const DQuat& q) {
    return {static_cast<float>(q.x), static_cast<float>(q.y), static_cast<float>(q.z), static_cast<float>(q.w)};
}
constexpr DVec3 rotate(const DQuat& q, const DVec3& v) {
    const DVec3 u{q.x, q.y, q.z};
    const DVec3 t = 2.0 * cross(u, v);
    return v + q.w * t + cross(u, t);
}
constexpr DVec3 inverseRotate(const DQuat& q, const DVec3& v) { return rotate(conjugate(q), v); }
constexpr DVec3 axisX(const DQuat& q) { return rotate(q, DVec3{1, 0, 0}); }
constexpr DVec3 axisY(const DQuat& q) { return rotate(q, DVec3{0, 1, 0}); }
constexpr DVec3 axisZ(const DQuat& q) { return rotate(q, DVec3{0, 0, 1}); }

/// R diag(d) Rᵀ
constexpr DSym3 inWorld(const DQuat& q, const DVec3& d) {
    return outer(d.x, axisX(q)) + outer(d.y, axisY(q)) + outer(d.z, axisZ(q));
}

inline constexpr double kLargestTurn = 2;  ///< rad, up to which the series below are exact to 1e-15

/// sin x / x and cos x from x², |x| ≤ kLargestTurn / 2
constexpr double sineRatio(double x2) {
    return 1 -
           x2 / 6 * (1 - x2 / 20 * (1 - x2 / 42 * (1 - x2 / 72 * (1 - x2 / 110 * (1 - x2 / 156 * (1 - x2 / 210))))));
}
constexpr double cosine(double x2) {
    return 1 - x2 / 2 * (1 - x2 / 12 * (1 - x2 / 30 * (1 - x2 / 56 * (1 - x2 / 90 * (1 - x2 / 132 * (1 - x2 / 182))))));
}

/// The turn by a rotation vector of up to kLargestTurn.
constexpr DQuat turnBy(const DVec3& turn) {
    const DVec3 half = 0.5 * turn;
    const double x2 = dot(half, half), s = sineRatio(x2);
    return {s * half.x, s * half.y, s * half.z, cosine(x2)};
}

/// Free rotation over h of a body with the angular momentum `momentum` (world axes) and inverse principal moments: the
/// symmetric splitting of solve/wide_rotation.inl, in one step. Exact where two moments are equal; else the error of
/// its energy stays bounded by h² times what makes them differ. No angle may exceed kLargestTurn.
DQuat turnFreely(const DQuat& q, const DVec3& momentum, const DVec3& inverse, double h);

}  // namespace ragtop::direct
