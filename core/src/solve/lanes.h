#pragma once

// The one header that depends on the compiler: N floats side by side. Another compiler needs this file only.
// Everything lives in an anonymous namespace, because each instruction set compiles its own copy and the linker must
// not merge them; for the same reason the kernels call nothing inline from elsewhere.

#include <cstdint>

namespace ragtop {
namespace {

#define RAGTOP_INLINE inline __attribute__((always_inline))

template <int N>
struct VectorTypes;
template <>
struct VectorTypes<4> {
    typedef float Float __attribute__((vector_size(16)));
    typedef int Int __attribute__((vector_size(16)));
    typedef unsigned char Bytes __attribute__((vector_size(4)));
};
template <>
struct VectorTypes<8> {
    typedef float Float __attribute__((vector_size(32)));
    typedef int Int __attribute__((vector_size(32)));
    typedef unsigned char Bytes __attribute__((vector_size(8)));
};
template <>
struct VectorTypes<16> {
    typedef float Float __attribute__((vector_size(64)));
    typedef int Int __attribute__((vector_size(64)));
    typedef unsigned char Bytes __attribute__((vector_size(16)));
};

template <int N>
struct Mask {
    using V = typename VectorTypes<N>::Int;
    V v;
};

/// N floats. Operators keep wide code readable as equations; every operation is exactly rounded per lane, so results do
/// not depend on N.
template <int N>
struct Lanes {
    using V = typename VectorTypes<N>::Float;
    V v;

    Lanes() = default;
    // Trivial copies of structures of lanes would be made in pieces of 16 bytes, which wider loads then wait for.
    RAGTOP_INLINE Lanes(const Lanes& a) : v(a.v) {}
    RAGTOP_INLINE Lanes& operator=(const Lanes& a) {
        v = a.v;
        return *this;
    }
    RAGTOP_INLINE Lanes(V a) : v(a) {}
    RAGTOP_INLINE Lanes(float a) : v(a - V{}) {}
    static RAGTOP_INLINE Lanes load(const float* p) { return *reinterpret_cast<const V*>(p); }
    RAGTOP_INLINE void store(float* p) const { *reinterpret_cast<V*>(p) = v; }
    RAGTOP_INLINE float operator[](int lane) const { return v[lane]; }
};

template <int N> RAGTOP_INLINE Lanes<N> operator+(Lanes<N> a, Lanes<N> b) { return a.v + b.v; }
template <int N> RAGTOP_INLINE Lanes<N> operator-(Lanes<N> a, Lanes<N> b) { return a.v - b.v; }
template <int N> RAGTOP_INLINE Lanes<N> operator*(Lanes<N> a, Lanes<N> b) { return a.v * b.v; }
template <int N> RAGTOP_INLINE Lanes<N> operator/(Lanes<N> a, Lanes<N> b) { return a.v / b.v; }
template <int N> RAGTOP_INLINE Lanes<N> operator*(float a, Lanes<N> b) { return a * b.v; }
template <int N> RAGTOP_INLINE Lanes<N> operator+(float a, Lanes<N> b) { return a + b.v; }
template <int N> RAGTOP_INLINE Lanes<N> operator-(float a, Lanes<N> b) { return a - b.v; }
template <int N> RAGTOP_INLINE Lanes<N> operator/(float a, Lanes<N> b) { return a / b.v; }
template <int N> RAGTOP_INLINE Lanes<N> operator-(Lanes<N> a) { return -a.v; }
template <int N> RAGTOP_INLINE Mask<N> operator>(Lanes<N> a, Lanes<N> b) { return {a.v > b.v}; }
template <int N> RAGTOP_INLINE Mask<N> operator<(Lanes<N> a, Lanes<N> b) { return {a.v < b.v}; }
template <int N> RAGTOP_INLINE Mask<N> operator<=(Lanes<N> a, Lanes<N> b) { return {a.v <= b.v}; }
template <int N> RAGTOP_INLINE Mask<N> operator>=(Lanes<N> a, Lanes<N> b) { return {a.v >= b.v}; }
template <int N> RAGTOP_INLINE Mask<N> operator>(Lanes<N> a, float b) { return {a.v > b}; }
template <int N> RAGTOP_INLINE Mask<N> operator<(Lanes<N> a, float b) { return {a.v < b}; }
template <int N> RAGTOP_INLINE Mask<N> operator!=(Lanes<N> a, float b) { return {a.v != b}; }
template <int N> RAGTOP_INLINE Mask<N> operator&(Mask<N> a, Mask<N> b) { return {a.v & b.v}; }
template <int N> RAGTOP_INLINE Mask<N> operator|(Mask<N> a, Mask<N> b) { return {a.v | b.v}; }
template <int N> RAGTOP_INLINE Mask<N> operator!(Mask<N> a) { return {~a.v}; }
template <int N>
RAGTOP_INLINE Lanes<N> select(Mask<N> m, Lanes<N> a, Lanes<N> b) { return m.v ? a.v : b.v; }
template <int N> RAGTOP_INLINE Lanes<N> max(Lanes<N> a, Lanes<N> b) { return a.v > b.v ? a.v : b.v; }
template <int N> RAGTOP_INLINE Lanes<N> min(Lanes<N> a, Lanes<N> b) { return a.v < b.v ? a.v : b.v; }
/// Of masks. Without the instruction that asks for it, folded in halves: lanes taken out one by one would cost as much as
/// a row.
RAGTOP_INLINE bool anySet(VectorTypes<4>::Int v) {
    typedef long long Pair __attribute__((vector_size(16)));
    const Pair pair = reinterpret_cast<Pair>(v);
    return (pair[0] | pair[1]) != 0;
}
RAGTOP_INLINE bool anySet(VectorTypes<8>::Int v) {
#if defined(__AVX__)
    return __builtin_ia32_movmskps256(reinterpret_cast<VectorTypes<8>::Float>(v)) != 0;
#else
    return anySet(__builtin_shufflevector(v, v, 0, 1, 2, 3) | __builtin_shufflevector(v, v, 4, 5, 6, 7));
#endif
}
RAGTOP_INLINE bool anySet(VectorTypes<16>::Int v) {
    return anySet(__builtin_shufflevector(v, v, 0, 1, 2, 3, 4, 5, 6, 7) |
                  __builtin_shufflevector(v, v, 8, 9, 10, 11, 12, 13, 14, 15));
}
template <int N>
RAGTOP_INLINE bool any(Mask<N> m) {
    return anySet(m.v);
}
/// The lowest byte of each lane.
template <int N>
RAGTOP_INLINE void storeBytes(typename VectorTypes<N>::Int v, std::uint8_t* to) {
    const typename VectorTypes<N>::Bytes bytes = __builtin_convertvector(v, typename VectorTypes<N>::Bytes);
    __builtin_memcpy(to, &bytes, N);
}
template <int N>
RAGTOP_INLINE Lanes<N> sqrt(Lanes<N> a) {
    Lanes<N> r;
    for (int i = 0; i < N; ++i) r.v[i] = __builtin_sqrtf(a.v[i]);
    return r;
}
/// The lanes' bits as integers.
template <int N>
RAGTOP_INLINE typename VectorTypes<N>::Int bits(Lanes<N> a) {
    return reinterpret_cast<typename VectorTypes<N>::Int>(a.v);
}
/// a / b where b is above zero, else zero.
template <int N>
RAGTOP_INLINE Lanes<N> divideOrZero(Lanes<N> a, Lanes<N> b) {
    const Mask<N> valid = b > 0.0f;
    return select(valid, a / select(valid, b, Lanes<N>(1.0f)), Lanes<N>(0.0f));
}

typedef float Float4 __attribute__((vector_size(16)));
typedef float Float8 __attribute__((vector_size(32)));

/// The same in memory, anywhere.
typedef float Float4Row __attribute__((vector_size(16), aligned(4)));
typedef float Float8Row __attribute__((vector_size(32), aligned(4)));

/// Rows of eight floats, one per lane, to eight Lanes and back: out[i][lane] = rows[lane][i].
RAGTOP_INLINE void transpose4(Float4& a, Float4& b, Float4& c, Float4& d) {
    const Float4 ab0 = __builtin_shufflevector(a, b, 0, 4, 1, 5), ab1 = __builtin_shufflevector(a, b, 2, 6, 3, 7);
    const Float4 cd0 = __builtin_shufflevector(c, d, 0, 4, 1, 5), cd1 = __builtin_shufflevector(c, d, 2, 6, 3, 7);
    a = __builtin_shufflevector(ab0, cd0, 0, 1, 4, 5);
    b = __builtin_shufflevector(ab0, cd0, 2, 3, 6, 7);
    c = __builtin_shufflevector(ab1, cd1, 0, 1, 4, 5);
    d = __builtin_shufflevector(ab1, cd1, 2, 3, 6, 7);
}

RAGTOP_INLINE void transpose8(Float8 r[8]) {
    Float8 t[8], u[8];
    for (int i = 0; i < 8; i += 2) {
        t[i] = __builtin_shufflevector(r[i], r[i + 1], 0, 8, 1, 9, 4, 12, 5, 13);
        t[i + 1] = __builtin_shufflevector(r[i], r[i + 1], 2, 10, 3, 11, 6, 14, 7, 15);
    }
    for (int i = 0; i < 8; i += 4) {
        u[i] = __builtin_shufflevector(t[i], t[i + 2], 0, 1, 8, 9, 4, 5, 12, 13);
        u[i + 1] = __builtin_shufflevector(t[i], t[i + 2], 2, 3, 10, 11, 6, 7, 14, 15);
        u[i + 2] = __builtin_shufflevector(t[i + 1], t[i + 3], 0, 1, 8, 9, 4, 5, 12, 13);
        u[i + 3] = __builtin_shufflevector(t[i + 1], t[i + 3], 2, 3, 10, 11, 6, 7, 14, 15);
    }
    for (int i = 0; i < 4; ++i) {
        r[i] = __builtin_shufflevector(u[i], u[i + 4], 0, 1, 2, 3, 8, 9, 10, 11);
        r[i + 4] = __builtin_shufflevector(u[i], u[i + 4], 4, 5, 6, 7, 12, 13, 14, 15);
    }
}

/// In each group of four lanes: the columns of a 4 × 4 block become its rows.
RAGTOP_INLINE void transposeFours(Float8& a, Float8& b, Float8& c, Float8& d) {
    const Float8 ab0 = __builtin_shufflevector(a, b, 0, 8, 1, 9, 4, 12, 5, 13);
    const Float8 ab1 = __builtin_shufflevector(a, b, 2, 10, 3, 11, 6, 14, 7, 15);
    const Float8 cd0 = __builtin_shufflevector(c, d, 0, 8, 1, 9, 4, 12, 5, 13);
    const Float8 cd1 = __builtin_shufflevector(c, d, 2, 10, 3, 11, 6, 14, 7, 15);
    a = __builtin_shufflevector(ab0, cd0, 0, 1, 8, 9, 4, 5, 12, 13);
    b = __builtin_shufflevector(ab0, cd0, 2, 3, 10, 11, 6, 7, 14, 15);
    c = __builtin_shufflevector(ab1, cd1, 0, 1, 8, 9, 4, 5, 12, 13);
    d = __builtin_shufflevector(ab1, cd1, 2, 3, 10, 11, 6, 7, 14, 15);
}

/// Four floats of each of eight rows, as four Lanes. Halves are loaded to where they belong, which spares a third of the
/// exchanges.
RAGTOP_INLINE void gatherFours(const float* const rows[8], int first, Float8 out[4]) {
    for (int i = 0; i < 4; ++i) {
        const Float4 lower = *reinterpret_cast<const Float4Row*>(rows[i] + first);
        const Float4 upper = *reinterpret_cast<const Float4Row*>(rows[i + 4] + first);
        out[i] = __builtin_shufflevector(lower, upper, 0, 1, 2, 3, 4, 5, 6, 7);
    }
    transposeFours(out[0], out[1], out[2], out[3]);
}

/// Gathers eight consecutive floats per lane from rows[lane].
template <int N>
RAGTOP_INLINE void gather8(const float* const rows[N], Lanes<N> out[8]) {
    if constexpr (N == 4) {
        Float4 lo[4], hi[4];
        for (int i = 0; i < 4; ++i) {
            lo[i] = *reinterpret_cast<const Float4Row*>(rows[i]);
            hi[i] = *reinterpret_cast<const Float4Row*>(rows[i] + 4);
        }
        transpose4(lo[0], lo[1], lo[2], lo[3]);
        transpose4(hi[0], hi[1], hi[2], hi[3]);
        for (int i = 0; i < 4; ++i) {
            out[i].v = lo[i];
            out[i + 4].v = hi[i];
        }
    } else {
        for (int part = 0; part < 2; ++part) {
            Float8 r[4];
            gatherFours(rows, 4 * part, r);
            if constexpr (N == 8) {
                for (int i = 0; i < 4; ++i) out[4 * part + i].v = r[i];
            } else {
                Float8 s[4];
                gatherFours(rows + 8, 4 * part, s);
                for (int i = 0; i < 4; ++i)
                    out[4 * part + i].v =
                        __builtin_shufflevector(r[i], s[i], 0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15);
            }
        }
    }
}

/// Scatters eight floats per lane to rows[lane]; a null row is left out where `kAll` is false.
template <int N, bool kAll>
RAGTOP_INLINE void scatterRows(float* const rows[N], const Lanes<N> in[8]) {
    if constexpr (N == 4) {
        Float4 lo[4], hi[4];
        for (int i = 0; i < 4; ++i) {
            lo[i] = in[i].v;
            hi[i] = in[i + 4].v;
        }
        transpose4(lo[0], lo[1], lo[2], lo[3]);
        transpose4(hi[0], hi[1], hi[2], hi[3]);
        for (int i = 0; i < 4; ++i)
            if (kAll || rows[i]) {
                *reinterpret_cast<Float4Row*>(rows[i]) = lo[i];
                *reinterpret_cast<Float4Row*>(rows[i] + 4) = hi[i];
            }
    } else {
        for (int half = 0; half < N / 8; ++half) {
            Float8 r[8];
            for (int i = 0; i < 8; ++i) {
                if constexpr (N == 8)
                    r[i] = in[i].v;
                else if (half == 0)
                    r[i] = __builtin_shufflevector(in[i].v, in[i].v, 0, 1, 2, 3, 4, 5, 6, 7);
                else
                    r[i] = __builtin_shufflevector(in[i].v, in[i].v, 8, 9, 10, 11, 12, 13, 14, 15);
            }
            transpose8(r);
            for (int i = 0; i < 8; ++i)
                if (kAll || rows[8 * half + i]) *reinterpret_cast<Float8Row*>(rows[8 * half + i]) = r[i];
        }
    }
}
template <int N>
RAGTOP_INLINE void scatter8(float* const rows[N], const Lanes<N> in[8]) {
    scatterRows<N, false>(rows, in);
}
template <int N>
RAGTOP_INLINE void scatterAll8(float* const rows[N], const Lanes<N> in[8]) {
    scatterRows<N, true>(rows, in);
}

/// A vector and a quaternion per lane.
template <int N>
struct WideVec3 {
    Lanes<N> x, y, z;
};
template <int N>
struct WideQuat {
    Lanes<N> x, y, z, w;
};
template <int N> RAGTOP_INLINE WideVec3<N> operator+(const WideVec3<N>& a, const WideVec3<N>& b) {
    return {a.x + b.x, a.y + b.y, a.z + b.z};
}
template <int N> RAGTOP_INLINE WideVec3<N> operator-(const WideVec3<N>& a, const WideVec3<N>& b) {
    return {a.x - b.x, a.y - b.y, a.z - b.z};
}
template <int N> RAGTOP_INLINE WideVec3<N> operator-(const WideVec3<N>& a) { return {-a.x, -a.y, -a.z}; }
template <int N> RAGTOP_INLINE WideVec3<N> operator*(Lanes<N> s, const WideVec3<N>& a) {
    return {s * a.x, s * a.y, s * a.z};
}
/// Component by component.
template <int N> RAGTOP_INLINE WideVec3<N> times(const WideVec3<N>& a, const WideVec3<N>& b) {
    return {a.x * b.x, a.y * b.y, a.z * b.z};
}
template <int N> RAGTOP_INLINE Lanes<N> dot(const WideVec3<N>& a, const WideVec3<N>& b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}
template <int N> RAGTOP_INLINE WideVec3<N> cross(const WideVec3<N>& a, const WideVec3<N>& b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
template <int N> RAGTOP_INLINE WideVec3<N> rotate(const WideQuat<N>& q, const WideVec3<N>& v) {
    const WideVec3<N> u{q.x, q.y, q.z};
    WideVec3<N> t = cross(u, v);
    t = t + t;
    return v + q.w * t + cross(u, t);
}
/// Rᵀ v − v for the rotation of q, without the loss that subtracting brings for small ones.
template <int N> RAGTOP_INLINE WideVec3<N> inverseTurn(const WideQuat<N>& q, const WideVec3<N>& v) {
    const WideVec3<N> u{-q.x, -q.y, -q.z};
    WideVec3<N> t = cross(u, v);
    t = t + t;
    return q.w * t + cross(u, t);
}
template <int N> RAGTOP_INLINE WideVec3<N> inverseRotate(const WideQuat<N>& q, const WideVec3<N>& v) {
    return rotate(WideQuat<N>{-q.x, -q.y, -q.z, q.w}, v);
}
template <int N> RAGTOP_INLINE WideQuat<N> operator*(const WideQuat<N>& a, const WideQuat<N>& b) {
    return {a.w * b.x + a.x * b.w + a.y * b.z - a.z * b.y, a.w * b.y - a.x * b.z + a.y * b.w + a.z * b.x,
            a.w * b.z + a.x * b.y - a.y * b.x + a.z * b.w, a.w * b.w - a.x * b.x - a.y * b.y - a.z * b.z};
}
template <int N> RAGTOP_INLINE WideVec3<N> select(Mask<N> m, const WideVec3<N>& a, const WideVec3<N>& b) {
    return {select(m, a.x, b.x), select(m, a.y, b.y), select(m, a.z, b.z)};
}

}  // namespace
}  // namespace ragtop
