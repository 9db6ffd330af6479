#pragma once

#include <cstdint>

#include "ragtop/math.h"

/// Four floats side by side, as every processor that Ragtop runs on has them: for tests of many candidates by code that
/// is compiled once. Each lane computes what scalar code would.
namespace ragtop {

typedef float FourFloats __attribute__((vector_size(16)));
typedef std::int32_t FourInts __attribute__((vector_size(16)));

/// Memory of any alignment.
inline FourFloats loadFour(const float* from) {
    typedef float Unaligned __attribute__((vector_size(16), aligned(4)));
    return *reinterpret_cast<const Unaligned*>(from);
}

inline void storeFour(float* to, FourFloats v) {
    typedef float Unaligned __attribute__((vector_size(16), aligned(4)));
    *reinterpret_cast<Unaligned*>(to) = v;
}

/// Bit i for each lane i of a comparison that holds.
inline unsigned lanesWhere(FourInts holds) {
#if defined(__SSE__)
    return static_cast<unsigned>(__builtin_ia32_movmskps(reinterpret_cast<FourFloats>(holds)));
#else
    typedef std::int64_t Halves __attribute__((vector_size(16)));
    const Halves halves = reinterpret_cast<Halves>(holds & FourInts{1, 2, 4, 8});
    const auto both = static_cast<std::uint64_t>(halves[0] | halves[1]);
    return static_cast<unsigned>((both | both >> 32) & 15u);
#endif
}

/// Does a comparison hold in all lanes?
inline bool holdsInAll(FourInts holds) { return lanesWhere(holds) == 15; }

inline FourFloats absolute(FourFloats v) { return v < 0.0f ? -v : v; }
inline FourFloats lesser(FourFloats a, FourFloats b) { return a < b ? a : b; }
inline FourFloats greater(FourFloats a, FourFloats b) { return a > b ? a : b; }

inline FourInts spread(int v) { return FourInts{v, v, v, v}; }

/// rows[i][k] to rows[k][i].
inline void transposeFour(FourFloats (&rows)[4]) {
    const FourFloats ab0 = __builtin_shufflevector(rows[0], rows[1], 0, 4, 1, 5);
    const FourFloats ab1 = __builtin_shufflevector(rows[0], rows[1], 2, 6, 3, 7);
    const FourFloats cd0 = __builtin_shufflevector(rows[2], rows[3], 0, 4, 1, 5);
    const FourFloats cd1 = __builtin_shufflevector(rows[2], rows[3], 2, 6, 3, 7);
    rows[0] = __builtin_shufflevector(ab0, cd0, 0, 1, 4, 5);
    rows[1] = __builtin_shufflevector(ab0, cd0, 2, 3, 6, 7);
    rows[2] = __builtin_shufflevector(ab1, cd1, 0, 1, 4, 5);
    rows[3] = __builtin_shufflevector(ab1, cd1, 2, 3, 6, 7);
}

/// Four vectors.
struct FourVectors {
    FourFloats x, y, z;
};
inline FourVectors spread(const Vec3& v) {
    return {FourFloats{v.x, v.x, v.x, v.x}, FourFloats{v.y, v.y, v.y, v.y}, FourFloats{v.z, v.z, v.z, v.z}};
}
inline FourVectors operator+(const FourVectors& a, const FourVectors& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
inline FourVectors operator-(const FourVectors& a, const FourVectors& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
inline FourVectors operator-(const FourVectors& a) { return {-a.x, -a.y, -a.z}; }
inline FourVectors operator*(float s, const FourVectors& a) { return {s * a.x, s * a.y, s * a.z}; }
inline FourVectors operator*(FourFloats s, const FourVectors& a) { return {s * a.x, s * a.y, s * a.z}; }
inline FourFloats dot(const FourVectors& a, const FourVectors& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
inline FourVectors cross(const FourVectors& a, const FourVectors& b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
inline FourFloats squareRoot(FourFloats v) {
    FourFloats root;
    for (int i = 0; i < 4; ++i) root[i] = __builtin_sqrtf(v[i]);
    return root;
}
inline FourFloats length(const FourVectors& a) { return squareRoot(dot(a, a)); }
inline FourVectors select(FourInts where, const FourVectors& a, const FourVectors& b) {
    return {where ? a.x : b.x, where ? a.y : b.y, where ? a.z : b.z};
}

/// Four rotations, as Quat.
struct FourQuats {
    FourFloats x, y, z, w;
};
inline FourQuats conjugate(const FourQuats& q) { return {-q.x, -q.y, -q.z, q.w}; }
inline FourQuats operator*(const FourQuats& a, const FourQuats& b) {
    return {a.w * b.x + a.x * b.w + a.y * b.z - a.z * b.y, a.w * b.y - a.x * b.z + a.y * b.w + a.z * b.x,
            a.w * b.z + a.x * b.y - a.y * b.x + a.z * b.w, a.w * b.w - a.x * b.x - a.y * b.y - a.z * b.z};
}
inline FourVectors rotate(const FourQuats& q, const FourVectors& v) {
    const FourVectors u{q.x, q.y, q.z}, t = 2.0f * cross(u, v);
    return v + q.w * t + cross(u, t);
}
inline FourVectors inverseRotate(const FourQuats& q, const FourVectors& v) { return rotate(conjugate(q), v); }
inline FourQuats normalized(const FourQuats& q) {
    const FourFloats size = squareRoot(q.x * q.x + q.y * q.y + q.z * q.z + q.w * q.w), s = 1.0f / size, none = {};
    const FourInts valid = size > 0.0f;
    return {valid ? s * q.x : none, valid ? s * q.y : none, valid ? s * q.z : none, valid ? s * q.w : none + 1.0f};
}

}  // namespace ragtop
