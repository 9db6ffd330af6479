#pragma once

#include <cmath>
#include <cstdint>

/// Plain vector types. SI units, right-handed, Y up, angles in radians (docs/notation.md).
/// Positions in the world are double precision; everything relative to something near is single (docs/adr/0001).
namespace ragtop {

inline constexpr float kPi = 3.14159265358979f;

/// A vector relative to something near: a direction, a velocity, an offset within a body.
struct Vec3 {
    float x = 0, y = 0, z = 0;

    constexpr Vec3 operator-() const { return {-x, -y, -z}; }
    constexpr Vec3& operator+=(const Vec3& b) { x += b.x; y += b.y; z += b.z; return *this; }
    constexpr Vec3& operator-=(const Vec3& b) { x -= b.x; y -= b.y; z -= b.z; return *this; }
    constexpr Vec3& operator*=(float s) { x *= s; y *= s; z *= s; return *this; }
    constexpr bool operator==(const Vec3&) const = default;
    constexpr float& operator[](int i) { return i == 0 ? x : i == 1 ? y : z; }
    constexpr float operator[](int i) const { return i == 0 ? x : i == 1 ? y : z; }
};

constexpr Vec3 operator+(const Vec3& a, const Vec3& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
constexpr Vec3 operator-(const Vec3& a, const Vec3& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
constexpr Vec3 operator*(float s, const Vec3& a) { return {s * a.x, s * a.y, s * a.z}; }
constexpr Vec3 operator*(const Vec3& a, float s) { return {s * a.x, s * a.y, s * a.z}; }
constexpr float dot(const Vec3& a, const Vec3& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
constexpr Vec3 cross(const Vec3& a, const Vec3& b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
constexpr float lengthSquared(const Vec3& a) { return dot(a, a); }
inline float length(const Vec3& a) { return std::sqrt(dot(a, a)); }
constexpr Vec3 abs(const Vec3& a) { return {a.x < 0 ? -a.x : a.x, a.y < 0 ? -a.y : a.y, a.z < 0 ? -a.z : a.z}; }
constexpr Vec3 min(const Vec3& a, const Vec3& b) {
    return {a.x < b.x ? a.x : b.x, a.y < b.y ? a.y : b.y, a.z < b.z ? a.z : b.z};
}
constexpr Vec3 max(const Vec3& a, const Vec3& b) {
    return {a.x > b.x ? a.x : b.x, a.y > b.y ? a.y : b.y, a.z > b.z ? a.z : b.z};
}
/// Component-wise product.
constexpr Vec3 scale(const Vec3& a, const Vec3& b) { return {a.x * b.x, a.y * b.y, a.z * b.z}; }
inline bool isFinite(const Vec3& a) { return std::isfinite(a.x) && std::isfinite(a.y) && std::isfinite(a.z); }

/// The unit vector along a, or `fallback` where a has no direction.
inline Vec3 normalized(const Vec3& a, const Vec3& fallback = {1, 0, 0}) {
    const float l = length(a);
    return l > 0 ? (1.0f / l) * a : fallback;
}

/// A unit vector perpendicular to the unit vector n.
inline Vec3 perpendicular(const Vec3& n) {
    const Vec3 other = n.x * n.x < 0.5f ? Vec3{1, 0, 0} : Vec3{0, 1, 0};
    return normalized(cross(n, other));
}

/// A position in the world, double so that a scene far from the origin behaves like one at the origin.
struct DVec3 {
    double x = 0, y = 0, z = 0;

    constexpr DVec3() = default;
    constexpr DVec3(double px, double py, double pz) : x(px), y(py), z(pz) {}
    explicit constexpr DVec3(const Vec3& a) : x(a.x), y(a.y), z(a.z) {}
    constexpr bool operator==(const DVec3&) const = default;
};

constexpr DVec3 operator+(const DVec3& a, const DVec3& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
constexpr DVec3 operator-(const DVec3& a, const DVec3& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
constexpr DVec3 operator*(double s, const DVec3& a) { return {s * a.x, s * a.y, s * a.z}; }
constexpr DVec3 operator+(const DVec3& a, const Vec3& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
constexpr DVec3 operator-(const DVec3& a, const Vec3& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
constexpr Vec3 toVec3(const DVec3& a) { return {static_cast<float>(a.x), static_cast<float>(a.y), static_cast<float>(a.z)}; }
/// a − b, subtracted in double and rounded once.
constexpr Vec3 relative(const DVec3& a, const DVec3& b) { return toVec3(a - b); }
inline bool isFinite(const DVec3& a) { return std::isfinite(a.x) && std::isfinite(a.y) && std::isfinite(a.z); }

/// A rotation as a unit quaternion x i + y j + z k + w.
struct Quat {
    float x = 0, y = 0, z = 0, w = 1;
    constexpr bool operator==(const Quat&) const = default;
};

constexpr Quat operator*(const Quat& a, const Quat& b) {
    return {a.w * b.x + a.x * b.w + a.y * b.z - a.z * b.y, a.w * b.y - a.x * b.z + a.y * b.w + a.z * b.x,
            a.w * b.z + a.x * b.y - a.y * b.x + a.z * b.w, a.w * b.w - a.x * b.x - a.y * b.y - a.z * b.z};
}
constexpr Quat conjugate(const Quat& q) { return {-q.x, -q.y, -q.z, q.w}; }
inline bool isFinite(const Quat& q) {
    return std::isfinite(q.x) && std::isfinite(q.y) && std::isfinite(q.z) && std::isfinite(q.w);
}
inline Quat normalized(const Quat& q) {
    const float l = std::sqrt(q.x * q.x + q.y * q.y + q.z * q.z + q.w * q.w);
    if (!(l > 0)) return {};
    const float s = 1.0f / l;
    return {s * q.x, s * q.y, s * q.z, s * q.w};
}
constexpr Vec3 rotate(const Quat& q, const Vec3& v) {
    const Vec3 u{q.x, q.y, q.z};
    const Vec3 t = 2.0f * cross(u, v);
    return v + q.w * t + cross(u, t);
}
constexpr Vec3 inverseRotate(const Quat& q, const Vec3& v) { return rotate(conjugate(q), v); }

/// Sine and cosine that give the same bits on every platform (the C library's do not); any finite angle.
struct SinCos {
    float sin, cos;
};
SinCos sinCos(float angle);
/// Four-quadrant arc tangent in (−π, π], same bits on every platform.
float arcTan2(float y, float x);

/// The rotation by `angle` (rad) about `axis`, which need not have unit length.
Quat rotationAbout(const Vec3& axis, float angle);
/// The shortest rotation that takes unit vector `from` onto unit vector `to`.
Quat rotationBetween(const Vec3& from, const Vec3& to);
/// The rotation whose columns are the orthonormal right-handed axes x, y, z.
Quat rotationFromAxes(const Vec3& x, const Vec3& y, const Vec3& z);
/// The rotation vector (axis times angle in [0, π]) of q.
Vec3 rotationVector(const Quat& q);

/// A 3×3 matrix of columns.
struct Mat3 {
    Vec3 cx{1, 0, 0}, cy{0, 1, 0}, cz{0, 0, 1};
};
constexpr Vec3 operator*(const Mat3& m, const Vec3& v) { return v.x * m.cx + v.y * m.cy + v.z * m.cz; }
constexpr Vec3 transposeTimes(const Mat3& m, const Vec3& v) { return {dot(m.cx, v), dot(m.cy, v), dot(m.cz, v)}; }
constexpr Mat3 operator*(const Mat3& a, const Mat3& b) { return {a * b.cx, a * b.cy, a * b.cz}; }
constexpr Mat3 operator+(const Mat3& a, const Mat3& b) { return {a.cx + b.cx, a.cy + b.cy, a.cz + b.cz}; }
constexpr Mat3 transpose(const Mat3& m) {
    return {{m.cx.x, m.cy.x, m.cz.x}, {m.cx.y, m.cy.y, m.cz.y}, {m.cx.z, m.cy.z, m.cz.z}};
}
/// The rotation as a matrix: its columns are the rotated axes.
constexpr Mat3 toMat3(const Quat& q) {
    const float x2 = 2 * q.x, y2 = 2 * q.y, z2 = 2 * q.z;
    const float xx = q.x * x2, yy = q.y * y2, zz = q.z * z2, xy = q.x * y2, xz = q.x * z2, yz = q.y * z2;
    const float wx = q.w * x2, wy = q.w * y2, wz = q.w * z2;
    return {{1 - (yy + zz), xy + wz, xz - wy}, {xy - wz, 1 - (xx + zz), yz + wx}, {xz + wy, yz - wx, 1 - (xx + yy)}};
}

/// A frame relative to another one that is near.
struct Frame {
    Vec3 position;
    Quat rotation;
    constexpr bool operator==(const Frame&) const = default;
};
constexpr Vec3 transformPoint(const Frame& f, const Vec3& p) { return f.position + rotate(f.rotation, p); }
constexpr Vec3 inverseTransformPoint(const Frame& f, const Vec3& p) {
    return inverseRotate(f.rotation, p - f.position);
}
constexpr Frame operator*(const Frame& a, const Frame& b) {
    return {transformPoint(a, b.position), a.rotation * b.rotation};
}
constexpr Frame inverse(const Frame& f) {
    return {inverseRotate(f.rotation, -f.position), conjugate(f.rotation)};
}

/// Position and rotation of something in the world.
struct Pose {
    DVec3 position;
    Quat rotation;
    constexpr bool operator==(const Pose&) const = default;
};
constexpr DVec3 transformPoint(const Pose& f, const Vec3& p) { return f.position + rotate(f.rotation, p); }
constexpr Vec3 inverseTransformPoint(const Pose& f, const DVec3& p) {
    return inverseRotate(f.rotation, relative(p, f.position));
}
constexpr Pose operator*(const Pose& a, const Frame& b) {
    return {transformPoint(a, b.position), a.rotation * b.rotation};
}
/// b seen from a.
constexpr Frame relative(const Pose& a, const Pose& b) {
    return {inverseTransformPoint(a, b.position), conjugate(a.rotation) * b.rotation};
}
/// Position linear, rotation along the shorter arc, for drawing between two steps; blend in [0, 1].
Pose blend(const Pose& from, const Pose& to, double blend);

/// An axis-aligned box in the world, always rounded outwards.
struct Bounds {
    Vec3 lower, upper;
};
constexpr bool overlaps(const Bounds& a, const Bounds& b) {
    return a.lower.x <= b.upper.x && b.lower.x <= a.upper.x && a.lower.y <= b.upper.y && b.lower.y <= a.upper.y &&
           a.lower.z <= b.upper.z && b.lower.z <= a.upper.z;
}
constexpr bool contains(const Bounds& outer, const Bounds& inner) {
    return outer.lower.x <= inner.lower.x && outer.lower.y <= inner.lower.y && outer.lower.z <= inner.lower.z &&
           inner.upper.x <= outer.upper.x && inner.upper.y <= outer.upper.y && inner.upper.z <= outer.upper.z;
}
constexpr Bounds merge(const Bounds& a, const Bounds& b) { return {min(a.lower, b.lower), max(a.upper, b.upper)}; }

}  // namespace ragtop
