#pragma once

#include <cmath>

#include "base/double_vectors.h"
#include "ragtop/math.h"
#include "solve/body_state.h"

/// Double precision for the direct solver: heavy on light and long chains ask for more digits than floats have. Scalar
/// code in a fixed order, so that every compiler gives the same bits.
namespace ragtop::direct {

inline double length(const DVec3& a) { return std::sqrt(dot(a, a)); }
constexpr DVec3 load(const double* a) { return {a[0], a[1], a[2]}; }
constexpr void store(const DVec3& a, double* to) { to[0] = a.x, to[1] = a.y, to[2] = a.z; }
constexpr void add(const DVec3& a, double* to) { to[0] += a.x, to[1] += a.y, to[2] += a.z; }

/// A symmetric 3×3 matrix.
struct DSym3 {
    double xx = 0, xy = 0, xz = 0, yy = 0, yz = 0, zz = 0;
};
constexpr DVec3 operator*(const DSym3& m, const DVec3& a) {
    return {m.xx * a.x + m.xy * a.y + m.xz * a.z, m.xy * a.x + m.yy * a.y + m.yz * a.z,
            m.xz * a.x + m.yz * a.y + m.zz * a.z};
}
constexpr DSym3 operator+(const DSym3& a, const DSym3& b) {
    return {a.xx + b.xx, a.xy + b.xy, a.xz + b.xz, a.yy + b.yy, a.yz + b.yz, a.zz + b.zz};
}
constexpr DSym3 scaled(const DSym3& m, double s) {
    return {s * m.xx, s * m.xy, s * m.xz, s * m.yy, s * m.yz, s * m.zz};
}
constexpr DVec3 toDouble(const Vec3& a) { return DVec3(a); }
constexpr DSym3 toDouble(const BodyInertia& m) { return {m.xx, m.xy, m.xz, m.yy, m.yz, m.zz}; }
/// s a aᵀ
constexpr DSym3 outer(double s, const DVec3& a) {
    return {s * a.x * a.x, s * a.x * a.y, s * a.x * a.z, s * a.y * a.y, s * a.y * a.z, s * a.z * a.z};
}
/// Zero where m is singular.
constexpr DSym3 inverse(const DSym3& m) {
    const double xx = m.yy * m.zz - m.yz * m.yz, xy = m.xz * m.yz - m.xy * m.zz, xz = m.xy * m.yz - m.xz * m.yy;
    const double determinant = m.xx * xx + m.xy * xy + m.xz * xz;
    if (!(determinant > 0)) return {};
    const double s = 1 / determinant;
    return {s * xx,
            s * xy,
            s * xz,
            s * (m.xx * m.zz - m.xz * m.xz),
            s * (m.xy * m.xz - m.xx * m.yz),
            s * (m.xx * m.yy - m.xy * m.xy)};
}

/// A rotation in double, for arms that turn by less than single precision tells apart.
constexpr DVec3 rotate(const Quat& q, const DVec3& v) {
    const DVec3 u{q.x, q.y, q.z};
    const DVec3 t = 2.0 * cross(u, v);
    return v + static_cast<double>(q.w) * t + cross(u, t);
}

}  // namespace ragtop::direct
