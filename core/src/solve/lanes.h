#pragma once

// The one header that depends on the compiler: N floats side by side. Another compiler needs this file only.
// Everything lives in an anonymous namespace, because each instruction set compiles its own copy and the linker must
// not merge them; for the same reason the kernels call nothing inline from elsewhere.

#include <cstddef>
#include <cstdint>

#include "base/numbers.h"

namespace ragtop {
namespace {

/// Of the widest vectors that the instruction set has.
#if defined(__AVX512F__)
constexpr int kNativeBytes = 64;  // 512 bits
#elif defined(__AVX__)
constexpr int kNativeBytes = 32;  // 256 bits
#else
constexpr int kNativeBytes = 16;  // 128 bits
#endif

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

/// Such a vector of the same kind of numbers as V's.
template <class Number>
struct NativeVector {
    typedef Number Type __attribute__((vector_size(kNativeBytes)));
};
template <class V>
using Native = typename NativeVector<decltype(V{}[0] + 0)>::Type;

/// In bytes.
template <class Piece>
constexpr std::size_t placeOf(int place) {
    return static_cast<std::size_t>(place) * sizeof(Piece);
}
/// Vectors are taken apart and put together in memory, which compilers see through.
template <class Piece, class V>
RAGTOP_INLINE Piece pieceOf(const V& v, int place) {
    Piece piece;
    __builtin_memcpy(&piece, reinterpret_cast<const char*>(&v) + placeOf<Piece>(place), sizeof(Piece));
    return piece;
}
template <class Piece, class V>
RAGTOP_INLINE void setPiece(V& v, int place, Piece piece) {
    __builtin_memcpy(reinterpret_cast<char*>(&v) + placeOf<Piece>(place), &piece, sizeof(Piece));
}

/// f of vectors of equal size. g++ takes comparisons and choices of vectors wider than the machine's apart into single
/// lanes, at many times the cost of compiling and of running them; so f is called for one native piece after the other.
template <class Result, class F, class... V>
RAGTOP_INLINE Result inPieces(F f, const V&... v) {
    if constexpr (sizeof(Result) <= kNativeBytes) {
        return reinterpret_cast<Result>(f(v...));
    } else {
        Result result;
        for (int i = 0; i < static_cast<int>(sizeof(Result)) / kNativeBytes; ++i)
            setPiece(result, i, reinterpret_cast<Native<Result>>(f(pieceOf<Native<V>>(v, i)...)));
        return result;
    }
}
struct Above {
    template <class V> RAGTOP_INLINE auto operator()(V a, V b) const { return a > b; }
};
struct AtLeast {
    template <class V> RAGTOP_INLINE auto operator()(V a, V b) const { return a >= b; }
};
struct Differs {
    template <class V> RAGTOP_INLINE auto operator()(V a, V b) const { return a != b; }
};
struct Chosen {
    template <class M, class V> RAGTOP_INLINE auto operator()(M m, V a, V b) const { return m ? a : b; }
};
struct Larger {
    template <class V> RAGTOP_INLINE auto operator()(V a, V b) const { return a > b ? a : b; }
};
struct Smaller {
    template <class V> RAGTOP_INLINE auto operator()(V a, V b) const { return a < b ? a : b; }
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
template <int N> RAGTOP_INLINE Mask<N> operator>(Lanes<N> a, Lanes<N> b) { return {inPieces<typename Mask<N>::V>(Above{}, a.v, b.v)}; }
template <int N> RAGTOP_INLINE Mask<N> operator<(Lanes<N> a, Lanes<N> b) { return {inPieces<typename Mask<N>::V>(Above{}, b.v, a.v)}; }
template <int N> RAGTOP_INLINE Mask<N> operator<=(Lanes<N> a, Lanes<N> b) { return {inPieces<typename Mask<N>::V>(AtLeast{}, b.v, a.v)}; }
template <int N> RAGTOP_INLINE Mask<N> operator>=(Lanes<N> a, Lanes<N> b) { return {inPieces<typename Mask<N>::V>(AtLeast{}, a.v, b.v)}; }
template <int N> RAGTOP_INLINE Mask<N> operator>(Lanes<N> a, float b) { return a > Lanes<N>(b); }
template <int N> RAGTOP_INLINE Mask<N> operator<(Lanes<N> a, float b) { return a < Lanes<N>(b); }
template <int N> RAGTOP_INLINE Mask<N> operator!=(Lanes<N> a, float b) {
    return {inPieces<typename Mask<N>::V>(Differs{}, a.v, Lanes<N>(b).v)};
}
template <int N> RAGTOP_INLINE Mask<N> operator&(Mask<N> a, Mask<N> b) { return {a.v & b.v}; }
template <int N> RAGTOP_INLINE Mask<N> operator|(Mask<N> a, Mask<N> b) { return {a.v | b.v}; }
template <int N> RAGTOP_INLINE Mask<N> operator!(Mask<N> a) { return {~a.v}; }
template <int N>
RAGTOP_INLINE Lanes<N> select(Mask<N> m, Lanes<N> a, Lanes<N> b) {
    return inPieces<typename Lanes<N>::V>(Chosen{}, m.v, a.v, b.v);
}
template <int N> RAGTOP_INLINE Lanes<N> max(Lanes<N> a, Lanes<N> b) {
    return inPieces<typename Lanes<N>::V>(Larger{}, a.v, b.v);
}
template <int N> RAGTOP_INLINE Lanes<N> min(Lanes<N> a, Lanes<N> b) {
    return inPieces<typename Lanes<N>::V>(Smaller{}, a.v, b.v);
}
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
    return anySet(pieceOf<VectorTypes<4>::Int>(v, 0) | pieceOf<VectorTypes<4>::Int>(v, 1));
#endif
}
RAGTOP_INLINE bool anySet(VectorTypes<16>::Int v) {
#if defined(__AVX512F__)
    return anySet(__builtin_shufflevector(v, v, 0, 1, 2, 3, 4, 5, 6, 7) |
                  __builtin_shufflevector(v, v, 8, 9, 10, 11, 12, 13, 14, 15));
#else
    return anySet(pieceOf<VectorTypes<8>::Int>(v, 0) | pieceOf<VectorTypes<8>::Int>(v, 1));
#endif
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
template <int N> RAGTOP_INLINE WideVec3<N> scale(const WideVec3<N>& a, const WideVec3<N>& b) {
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
template <int N> RAGTOP_INLINE WideQuat<N> conjugate(const WideQuat<N>& q) { return {-q.x, -q.y, -q.z, q.w}; }
template <int N> RAGTOP_INLINE Lanes<N> length(const WideVec3<N>& a) { return sqrt(dot(a, a)); }
template <int N> RAGTOP_INLINE WideVec3<N> normalized(const WideVec3<N>& a, const WideVec3<N>& fallback) {
    const Lanes<N> l = length(a);
    return select(l > 0.0f, (1.0f / l) * a, fallback);
}
template <int N> RAGTOP_INLINE WideVec3<N> perpendicular(const WideVec3<N>& n) {
    const Lanes<N> zero(0.0f), one(1.0f);
    const Mask<N> flat = n.x * n.x < 0.5f;
    return normalized(cross(n, {select(flat, one, zero), select(flat, zero, one), zero}), {one, zero, zero});
}

/// Of columns.
template <int N>
struct WideMat3 {
    WideVec3<N> cx, cy, cz;
};
template <int N> RAGTOP_INLINE WideVec3<N> operator*(const WideMat3<N>& m, const WideVec3<N>& v) {
    return v.x * m.cx + v.y * m.cy + v.z * m.cz;
}
template <int N> RAGTOP_INLINE WideVec3<N> transposeTimes(const WideMat3<N>& m, const WideVec3<N>& v) {
    return {dot(m.cx, v), dot(m.cy, v), dot(m.cz, v)};
}
template <int N> RAGTOP_INLINE WideMat3<N> transpose(const WideMat3<N>& m) {
    return {{m.cx.x, m.cy.x, m.cz.x}, {m.cx.y, m.cy.y, m.cz.y}, {m.cx.z, m.cy.z, m.cz.z}};
}

}  // namespace

template <int N>
struct NumberTypes<Lanes<N>> {
    using Vector = WideVec3<N>;
    using Rotation = WideQuat<N>;
    using Matrix = WideMat3<N>;
    using Test = Mask<N>;
};

}  // namespace ragtop
