#pragma once

#include "ragtop/math.h"

namespace ragtop {

/// Velocity and inertia of a rigid body, copied out of the world for the implicit solve of one substep. Points are
/// given relative to the centre of mass, in world axes.
struct PointBody {
    Vec3 v, w;  ///< m/s, rad/s
    float inverseMass = 0;
    Mat3 inverseInertia{{0, 0, 0}, {0, 0, 0}, {0, 0, 0}};  ///< world axes
};

inline Vec3 velocityAt(const PointBody& body, const Vec3& arm) { return body.v + cross(body.w, arm); }

inline void push(PointBody& body, const Vec3& arm, const Vec3& impulse) {
    body.v += body.inverseMass * impulse;
    body.w += body.inverseInertia * cross(arm, impulse);
}

/// Speed along `d` that a unit impulse along `e` gives the point: dᵀ (m⁻¹ E − [r] I⁻¹ [r]) e.
inline float inverseMassBetween(const PointBody& body, const Vec3& arm, const Vec3& d, const Vec3& e) {
    return body.inverseMass * dot(d, e) + dot(cross(arm, d), body.inverseInertia * cross(arm, e));
}

/// The inverse of a symmetric positive matrix; zero when it has none. In doubles, whose range holds the products of
/// three numbers of single precision.
inline Mat3 inverseSymmetric(const Mat3& m) {
    const double xx = m.cx.x, yy = m.cy.y, zz = m.cz.z, xy = m.cy.x, xz = m.cz.x, yz = m.cz.y;
    const double a = yy * zz - yz * yz, b = xz * yz - xy * zz, c = xy * yz - xz * yy;
    const double determinant = xx * a + xy * b + xz * c;
    if (!(determinant > 0)) return {{0, 0, 0}, {0, 0, 0}, {0, 0, 0}};
    const double s = 1 / determinant;
    const auto part = [s](double minor) { return static_cast<float>(s * minor); };
    const float ixy = part(b), ixz = part(c), iyz = part(xy * xz - xx * yz);
    return {{part(a), ixy, ixz}, {ixy, part(xx * zz - xz * xz), iyz}, {ixz, iyz, part(xx * yy - xy * xy)}};
}

/// R m Rᵀ
inline Mat3 rotated(const Mat3& m, const Quat& q) {
    const Mat3 r = toMat3(q);
    return r * m * transpose(r);
}

constexpr float clampTo(float x, float lower, float upper) { return x < lower ? lower : x > upper ? upper : x; }

/// Adds `wanted` to an impulse that has to stay in [−bound, bound]; returns what was added.
inline float addBounded(float& impulse, float wanted, float lower, float upper) {
    const float before = impulse;
    impulse = clampTo(before + wanted, lower, upper);
    return impulse - before;
}

}  // namespace ragtop
