// N doubles side by side, and vectors and matrices of lanes of either precision. Included by tree_kernels.inl.

#pragma once

#include "solve/lane_rows.h"
#include "solve/lanes.h"

namespace ragtop {
namespace {

/// Apart from its callers, which seldom need it.
#define RAGTOP_APART __attribute__((noinline))

template <int N>
struct DoubleTypes;
template <>
struct DoubleTypes<2> {
    typedef double Double __attribute__((vector_size(16)));
    typedef long long Int __attribute__((vector_size(16)));
    typedef float Float __attribute__((vector_size(8)));
};
template <>
struct DoubleTypes<4> {
    typedef double Double __attribute__((vector_size(32)));
    typedef long long Int __attribute__((vector_size(32)));
    typedef float Float __attribute__((vector_size(16)));
};
template <>
struct DoubleTypes<8> {
    typedef double Double __attribute__((vector_size(64)));
    typedef long long Int __attribute__((vector_size(64)));
    typedef float Float __attribute__((vector_size(32)));
};

template <int N>
struct DoubleMask {
    using V = typename DoubleTypes<N>::Int;
    V v;
};

template <int N>
struct DoubleLanes {
    using V = typename DoubleTypes<N>::Double;
    V v;

    DoubleLanes() = default;
    RAGTOP_INLINE DoubleLanes(const DoubleLanes& a) : v(a.v) {}  // as Lanes
    RAGTOP_INLINE DoubleLanes& operator=(const DoubleLanes& a) {
        v = a.v;
        return *this;
    }
    RAGTOP_INLINE DoubleLanes(V a) : v(a) {}
    RAGTOP_INLINE DoubleLanes(double a) : v(a - V{}) {}
    RAGTOP_INLINE double operator[](int lane) const { return v[lane]; }
};
template <int N>
RAGTOP_INLINE DoubleLanes<N> operator+(DoubleLanes<N> a, DoubleLanes<N> b) {
    return a.v + b.v;
}
template <int N>
RAGTOP_INLINE DoubleLanes<N> operator-(DoubleLanes<N> a, DoubleLanes<N> b) {
    return a.v - b.v;
}
template <int N>
RAGTOP_INLINE DoubleLanes<N> operator*(DoubleLanes<N> a, DoubleLanes<N> b) {
    return a.v * b.v;
}
template <int N>
RAGTOP_INLINE DoubleLanes<N> operator/(DoubleLanes<N> a, DoubleLanes<N> b) {
    return a.v / b.v;
}
template <int N>
RAGTOP_INLINE DoubleLanes<N> operator-(DoubleLanes<N> a) {
    return -a.v;
}
template <int N>
RAGTOP_INLINE DoubleMask<N> operator>(DoubleLanes<N> a, DoubleLanes<N> b) {
    return {inPieces<typename DoubleMask<N>::V>(Above{}, a.v, b.v)};
}
template <int N>
RAGTOP_INLINE DoubleMask<N> operator<(DoubleLanes<N> a, DoubleLanes<N> b) {
    return {inPieces<typename DoubleMask<N>::V>(Above{}, b.v, a.v)};
}
template <int N>
RAGTOP_INLINE DoubleMask<N> operator&(DoubleMask<N> a, DoubleMask<N> b) {
    return {a.v & b.v};
}
template <int N>
RAGTOP_INLINE DoubleMask<N> operator|(DoubleMask<N> a, DoubleMask<N> b) {
    return {a.v | b.v};
}
template <int N>
RAGTOP_INLINE DoubleLanes<N> select(DoubleMask<N> m, DoubleLanes<N> a, DoubleLanes<N> b) {
    return inPieces<typename DoubleLanes<N>::V>(Chosen{}, m.v, a.v, b.v);
}
template <int N>
RAGTOP_INLINE DoubleLanes<N> max(DoubleLanes<N> a, DoubleLanes<N> b) {
    return inPieces<typename DoubleLanes<N>::V>(Larger{}, a.v, b.v);
}
template <int N>
RAGTOP_INLINE DoubleLanes<N> min(DoubleLanes<N> a, DoubleLanes<N> b) {
    return inPieces<typename DoubleLanes<N>::V>(Smaller{}, a.v, b.v);
}
template <int N>
RAGTOP_INLINE bool any(DoubleMask<N> m) {
    long long set = 0;
    for (int i = 0; i < N; ++i) set |= m.v[i];
    return set != 0;
}
template <int N>
RAGTOP_INLINE DoubleLanes<N> sqrt(DoubleLanes<N> a) {
    DoubleLanes<N> r;
    for (int i = 0; i < N; ++i) r.v[i] = __builtin_sqrt(a.v[i]);
    return r;
}

/// What differs between precisions: how eight floats per lane come and go, the scheme (TreeKernels), and whether points
/// give way by 10⁻⁶, which in single precision is a few roundings.
template <class R>
struct TreeReal;
template <int N>
struct TreeReal<Lanes<N>> {
    static constexpr int kLanes = N;
    static constexpr bool kLeapfrog = true, kYields = false;
    using Test = Mask<N>;
    static RAGTOP_INLINE Lanes<N> toSingle(Lanes<N> a) { return a; }
    static RAGTOP_INLINE void gather(const float* const rows[N], Lanes<N> out[8]) { gather8<N>(rows, out); }
    static RAGTOP_INLINE void scatter(float* const rows[N], const Lanes<N> in[8]) { scatter8<N>(rows, in); }
};
template <int N>
struct TreeReal<DoubleLanes<N>> {
    static constexpr int kLanes = N;
    static constexpr bool kLeapfrog = false, kYields = true;
    using Test = DoubleMask<N>;
    using Double = typename DoubleTypes<N>::Double;
    using Float = typename DoubleTypes<N>::Float;
    static RAGTOP_INLINE DoubleLanes<N> toSingle(DoubleLanes<N> a) {
        return __builtin_convertvector(__builtin_convertvector(a.v, Float), Double);
    }
    static RAGTOP_INLINE void gather(const float* const rows[N], DoubleLanes<N> out[8]) {
        constexpr int kWide = N < 4 ? 4 : N;
        const float* wide[kWide];
        for (int i = 0; i < kWide; ++i) wide[i] = rows[i < N ? i : 0];
        Lanes<kWide> single[8];
        gather8<kWide>(wide, single);
        for (int i = 0; i < 8; ++i) {
            if constexpr (N == 2)
                out[i].v = __builtin_convertvector(__builtin_shufflevector(single[i].v, single[i].v, 0, 1), Double);
            else
                out[i].v = __builtin_convertvector(single[i].v, Double);
        }
    }
    static RAGTOP_INLINE void scatter(float* const rows[N], const DoubleLanes<N> in[8]) {
        constexpr int kWide = N < 4 ? 4 : N;
        float* wide[kWide];
        for (int i = 0; i < kWide; ++i) wide[i] = i < N ? rows[i] : nullptr;
        Lanes<kWide> single[8];
        for (int i = 0; i < 8; ++i) {
            const Float narrow = __builtin_convertvector(in[i].v, Float);
            if constexpr (N == 2)
                single[i].v = __builtin_shufflevector(narrow, narrow, 0, 1, 0, 1);
            else
                single[i].v = narrow;
        }
        scatter8<kWide>(wide, single);
    }
};

template <class R>
struct TreeVec {
    R x, y, z;
};
template <class R>
struct TreeSym {
    R xx, xy, xz, yy, yz, zz;
};
/// By columns.
template <class R>
struct TreeMat {
    TreeVec<R> x, y, z;
};

template <class R>
RAGTOP_INLINE TreeVec<R> operator+(const TreeVec<R>& a, const TreeVec<R>& b) {
    return {a.x + b.x, a.y + b.y, a.z + b.z};
}
template <class R>
RAGTOP_INLINE TreeVec<R> operator-(const TreeVec<R>& a, const TreeVec<R>& b) {
    return {a.x - b.x, a.y - b.y, a.z - b.z};
}
template <class R>
RAGTOP_INLINE TreeVec<R> operator-(const TreeVec<R>& a) {
    return {-a.x, -a.y, -a.z};
}
template <class R>
RAGTOP_INLINE TreeVec<R> scaled(R s, const TreeVec<R>& a) {
    return {s * a.x, s * a.y, s * a.z};
}
template <class R>
RAGTOP_INLINE R dot(const TreeVec<R>& a, const TreeVec<R>& b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}
template <class R>
RAGTOP_INLINE TreeVec<R> cross(const TreeVec<R>& a, const TreeVec<R>& b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
template <class R, class Test>
RAGTOP_INLINE TreeVec<R> choose(Test m, const TreeVec<R>& a, const TreeVec<R>& b) {
    return {select(m, a.x, b.x), select(m, a.y, b.y), select(m, a.z, b.z)};
}
template <class R>
RAGTOP_INLINE TreeVec<R> operator*(const TreeSym<R>& m, const TreeVec<R>& a) {
    return {m.xx * a.x + m.xy * a.y + m.xz * a.z, m.xy * a.x + m.yy * a.y + m.yz * a.z,
            m.xz * a.x + m.yz * a.y + m.zz * a.z};
}
template <class R>
RAGTOP_INLINE TreeVec<R> operator*(const TreeMat<R>& m, const TreeVec<R>& a) {
    return {m.x.x * a.x + m.y.x * a.y + m.z.x * a.z, m.x.y * a.x + m.y.y * a.y + m.z.y * a.z,
            m.x.z * a.x + m.y.z * a.y + m.z.z * a.z};
}
/// Mᵀ a
template <class R>
RAGTOP_INLINE TreeVec<R> transposed(const TreeMat<R>& m, const TreeVec<R>& a) {
    return {dot(m.x, a), dot(m.y, a), dot(m.z, a)};
}
template <class R>
RAGTOP_INLINE TreeSym<R> operator+(const TreeSym<R>& a, const TreeSym<R>& b) {
    return {a.xx + b.xx, a.xy + b.xy, a.xz + b.xz, a.yy + b.yy, a.yz + b.yz, a.zz + b.zz};
}
template <class R>
RAGTOP_INLINE TreeSym<R> operator-(const TreeSym<R>& a, const TreeSym<R>& b) {
    return {a.xx - b.xx, a.xy - b.xy, a.xz - b.xz, a.yy - b.yy, a.yz - b.yz, a.zz - b.zz};
}
template <class R>
RAGTOP_INLINE TreeMat<R> operator+(const TreeMat<R>& a, const TreeMat<R>& b) {
    return {a.x + b.x, a.y + b.y, a.z + b.z};
}
template <class R>
RAGTOP_INLINE TreeMat<R> operator-(const TreeMat<R>& a, const TreeMat<R>& b) {
    return {a.x - b.x, a.y - b.y, a.z - b.z};
}
/// s a aᵀ
template <class R>
RAGTOP_INLINE TreeSym<R> outer(R s, const TreeVec<R>& a) {
    const TreeVec<R> b = scaled(s, a);
    return {b.x * a.x, b.x * a.y, b.x * a.z, b.y * a.y, b.y * a.z, b.z * a.z};
}
/// s a bᵀ
template <class R>
RAGTOP_INLINE TreeMat<R> outer(R s, const TreeVec<R>& a, const TreeVec<R>& b) {
    const TreeVec<R> c = scaled(s, a);
    return {scaled(b.x, c), scaled(b.y, c), scaled(b.z, c)};
}
/// M [r]×, with [r]× a = r × a
template <class R>
RAGTOP_INLINE TreeMat<R> timesCross(const TreeSym<R>& m, const TreeVec<R>& r) {
    const TreeVec<R> x{m.xx, m.xy, m.xz}, y{m.xy, m.yy, m.yz}, z{m.xz, m.yz, m.zz};
    return {scaled(r.z, y) - scaled(r.y, z), scaled(r.x, z) - scaled(r.z, x), scaled(r.y, x) - scaled(r.x, y)};
}
/// [r]×ᵀ A, where that is symmetric.
template <class R>
RAGTOP_INLINE TreeSym<R> crossLeft(const TreeVec<R>& r, const TreeMat<R>& a) {
    const TreeVec<R> x = cross(a.x, r), y = cross(a.y, r), z = cross(a.z, r);
    return {x.x, y.x, z.x, y.y, z.y, z.z};
}
/// [r]×ᵀ A + Bᵀ [r]×, of two matrices for which that is symmetric.
template <class R>
RAGTOP_INLINE TreeSym<R> crossBoth(const TreeVec<R>& r, const TreeMat<R>& a, const TreeMat<R>& b) {
    // [r]×ᵀ a = a × r by columns; (Bᵀ [r]×) at (i, j) is (bᵢ × r)ⱼ.
    const TreeVec<R> ax = cross(a.x, r), ay = cross(a.y, r), az = cross(a.z, r);
    const TreeVec<R> bx = cross(b.x, r), by = cross(b.y, r), bz = cross(b.z, r);
    return {ax.x + bx.x, ay.x + bx.y, az.x + bx.z, ay.y + by.y, az.y + by.z, az.z + bz.z};
}
/// M⁻¹ by minors; `determinant` tells whether it is one.
template <class R>
RAGTOP_INLINE TreeSym<R> inverseOf(const TreeSym<R>& m, R& determinant) {
    const R xx = m.yy * m.zz - m.yz * m.yz, xy = m.xz * m.yz - m.xy * m.zz, xz = m.xy * m.yz - m.xz * m.yy;
    determinant = m.xx * xx + m.xy * xy + m.xz * xz;
    const R s = R(1.0f) / determinant;
    return {s * xx,
            s * xy,
            s * xz,
            s * (m.xx * m.zz - m.xz * m.xz),
            s * (m.xy * m.xz - m.xx * m.yz),
            s * (m.xx * m.yy - m.xy * m.xy)};
}
/// A S
template <class R>
RAGTOP_INLINE TreeMat<R> product(const TreeMat<R>& a, const TreeSym<R>& s) {
    return {a * TreeVec<R>{s.xx, s.xy, s.xz}, a * TreeVec<R>{s.xy, s.yy, s.yz}, a * TreeVec<R>{s.xz, s.yz, s.zz}};
}
/// A Bᵀ where that is symmetric.
template <class R>
RAGTOP_INLINE TreeSym<R> productTransposed(const TreeMat<R>& a, const TreeMat<R>& b) {
    const auto at = [](R a0, R b0, R a1, R b1, R a2, R b2) __attribute__((always_inline)) {
        return a0 * b0 + a1 * b1 + a2 * b2;
    };
    return {at(a.x.x, b.x.x, a.y.x, b.y.x, a.z.x, b.z.x), at(a.x.x, b.x.y, a.y.x, b.y.y, a.z.x, b.z.y),
            at(a.x.x, b.x.z, a.y.x, b.y.z, a.z.x, b.z.z), at(a.x.y, b.x.y, a.y.y, b.y.y, a.z.y, b.z.y),
            at(a.x.y, b.x.z, a.y.y, b.y.z, a.z.y, b.z.z), at(a.x.z, b.x.z, a.y.z, b.y.z, a.z.z, b.z.z)};
}

}  // namespace
}  // namespace ragtop
