#pragma once

#include "ragtop/math.h"
#include "ragtop/symmetric.h"

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
