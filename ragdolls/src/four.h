#pragma once

#include <cstdint>

#include "ragtop/math.h"

/// Four numbers side by side, as every processor that Ragtop runs on has them; each lane computes what scalar code
/// would.
namespace ragtop {

typedef float Four __attribute__((vector_size(16)));
typedef std::int32_t FourFlags __attribute__((vector_size(16)));

inline Four four(float v) { return Four{v, v, v, v}; }
inline Four lesser(Four a, Four b) { return a < b ? a : b; }
inline Four greater(Four a, Four b) { return a > b ? a : b; }
inline bool any(FourFlags f) { return (f[0] | f[1] | f[2] | f[3]) != 0; }
inline Four squareRoot(Four v) {
    Four root;
    for (int i = 0; i < 4; ++i) root[i] = __builtin_sqrtf(v[i]);
    return root;
}

struct FourVec3 {
    Four x, y, z;

    void set(int lane, const Vec3& v) {
        x[lane] = v.x;
        y[lane] = v.y;
        z[lane] = v.z;
    }
    Vec3 at(int lane) const { return {x[lane], y[lane], z[lane]}; }
};
inline FourVec3 four(const Vec3& v) { return {four(v.x), four(v.y), four(v.z)}; }
inline FourVec3 operator+(const FourVec3& a, const FourVec3& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
inline FourVec3 operator-(const FourVec3& a, const FourVec3& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
inline FourVec3 operator-(const FourVec3& a) { return {-a.x, -a.y, -a.z}; }
inline FourVec3 operator*(Four s, const FourVec3& a) { return {s * a.x, s * a.y, s * a.z}; }
inline FourVec3 operator*(float s, const FourVec3& a) { return four(s) * a; }
inline Four dot(const FourVec3& a, const FourVec3& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
inline FourVec3 cross(const FourVec3& a, const FourVec3& b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
/// A vector without direction stays zero.
inline FourVec3 normalized(const FourVec3& a) {
    const Four size = squareRoot(dot(a, a));
    return (size > 0.0f ? 1.0f / size : four(0.0f)) * a;
}
inline FourVec3 select(FourFlags where, const FourVec3& a, const FourVec3& b) {
    return {where ? a.x : b.x, where ? a.y : b.y, where ? a.z : b.z};
}

struct FourQuat {
    Four x, y, z, w;

    void set(int lane, const Quat& q) {
        x[lane] = q.x;
        y[lane] = q.y;
        z[lane] = q.z;
        w[lane] = q.w;
    }
    Quat at(int lane) const { return {x[lane], y[lane], z[lane], w[lane]}; }
};
inline FourQuat operator+(const FourQuat& a, const FourQuat& b) { return {a.x + b.x, a.y + b.y, a.z + b.z, a.w + b.w}; }
inline FourQuat operator-(const FourQuat& a, const FourQuat& b) { return {a.x - b.x, a.y - b.y, a.z - b.z, a.w - b.w}; }
inline FourQuat operator*(Four s, const FourQuat& a) { return {s * a.x, s * a.y, s * a.z, s * a.w}; }
inline FourQuat operator*(float s, const FourQuat& a) { return four(s) * a; }
inline FourQuat conjugate(const FourQuat& q) { return {-q.x, -q.y, -q.z, q.w}; }
inline FourQuat operator*(const FourQuat& a, const FourQuat& b) {
    return {a.w * b.x + a.x * b.w + a.y * b.z - a.z * b.y, a.w * b.y - a.x * b.z + a.y * b.w + a.z * b.x,
            a.w * b.z + a.x * b.y - a.y * b.x + a.z * b.w, a.w * b.w - a.x * b.x - a.y * b.y - a.z * b.z};
}
inline Four dot(const FourQuat& a, const FourQuat& b) { return a.x * b.x + a.y * b.y + a.z * b.z + a.w * b.w; }
inline FourQuat normalized(const FourQuat& q) { return (1.0f / squareRoot(dot(q, q))) * q; }
/// q or −q, whichever is nearer to `to`.
inline FourQuat nearer(const FourQuat& q, const FourQuat& to) {
    return (dot(q, to) < 0.0f ? four(-1.0f) : four(1.0f)) * q;
}
inline FourVec3 rotate(const FourQuat& q, const FourVec3& v) {
    const FourVec3 u{q.x, q.y, q.z}, t = 2.0f * cross(u, v);
    return v + q.w * t + cross(u, t);
}
/// The shortest rotation that takes unit vectors `from` onto unit vectors `to`, which must not point opposite ways.
inline FourQuat rotationBetween(const FourVec3& from, const FourVec3& to) {
    const FourVec3 axis = cross(from, to);
    return normalized(FourQuat{axis.x, axis.y, axis.z, 1.0f + dot(from, to)});
}

}  // namespace ragtop
