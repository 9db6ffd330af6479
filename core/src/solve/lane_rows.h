#pragma once

// Rows of eight floats, one per lane, to eight Lanes and back, by transposes: out[i][lane] = rows[lane][i]. As lanes.h this
// depends on the compiler. Where registers are wider than a row's half, halves are loaded to where they belong: a
// memory operand costs less than an exchange of registers. (Storing quarters of wide registers costs more.)

#if defined(__AVX__)
#include <immintrin.h>
#endif

#include <type_traits>

#include "solve/lanes.h"

namespace ragtop {
namespace {

typedef float Float4 __attribute__((vector_size(16)));
typedef float Float8 __attribute__((vector_size(32)));
typedef float Float16 __attribute__((vector_size(64)));

/// The same in memory, anywhere.
typedef float Float4Row __attribute__((vector_size(16), aligned(4)));
typedef float Float8Row __attribute__((vector_size(32), aligned(4)));

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

/// Four floats from each place, side by side.
RAGTOP_INLINE Float8 joinHalves(const float* lower, const float* upper) {
#if defined(__AVX__)
    return _mm256_insertf128_ps(_mm256_castps128_ps256(_mm_loadu_ps(lower)), _mm_loadu_ps(upper), 1);
#else
    const Float4 a = *reinterpret_cast<const Float4Row*>(lower), b = *reinterpret_cast<const Float4Row*>(upper);
    return __builtin_shufflevector(a, b, 0, 1, 2, 3, 4, 5, 6, 7);
#endif
}

#if defined(__AVX512F__)
RAGTOP_INLINE void transposeFours(Float16& a, Float16& b, Float16& c, Float16& d) {
    const Float16 ab0 = __builtin_shufflevector(a, b, 0, 16, 1, 17, 4, 20, 5, 21, 8, 24, 9, 25, 12, 28, 13, 29);
    const Float16 ab1 = __builtin_shufflevector(a, b, 2, 18, 3, 19, 6, 22, 7, 23, 10, 26, 11, 27, 14, 30, 15, 31);
    const Float16 cd0 = __builtin_shufflevector(c, d, 0, 16, 1, 17, 4, 20, 5, 21, 8, 24, 9, 25, 12, 28, 13, 29);
    const Float16 cd1 = __builtin_shufflevector(c, d, 2, 18, 3, 19, 6, 22, 7, 23, 10, 26, 11, 27, 14, 30, 15, 31);
    a = __builtin_shufflevector(ab0, cd0, 0, 1, 16, 17, 4, 5, 20, 21, 8, 9, 24, 25, 12, 13, 28, 29);
    b = __builtin_shufflevector(ab0, cd0, 2, 3, 18, 19, 6, 7, 22, 23, 10, 11, 26, 27, 14, 15, 30, 31);
    c = __builtin_shufflevector(ab1, cd1, 0, 1, 16, 17, 4, 5, 20, 21, 8, 9, 24, 25, 12, 13, 28, 29);
    d = __builtin_shufflevector(ab1, cd1, 2, 3, 18, 19, 6, 7, 22, 23, 10, 11, 26, 27, 14, 15, 30, 31);
}

/// Four floats from each place, side by side.
RAGTOP_INLINE Float16 joinQuarters(const float* a, const float* b, const float* c, const float* d) {
    const __m512 two = _mm512_insertf32x4(_mm512_castps128_ps512(_mm_loadu_ps(a)), _mm_loadu_ps(b), 1);
    return _mm512_insertf32x4(_mm512_insertf32x4(two, _mm_loadu_ps(c), 2), _mm_loadu_ps(d), 3);
}
#endif

/// The lanes of two fields, and back.
template <int L>
RAGTOP_INLINE Lanes<2 * L> loadTwo(const float* lower, const float* upper) {
    static_assert(L == 8);
    const Float8 a = *reinterpret_cast<const Float8*>(lower), b = *reinterpret_cast<const Float8*>(upper);
#if defined(__AVX512F__)
    return Lanes<16>(_mm512_insertf32x8(_mm512_castps256_ps512(a), b, 1));
#else
    Lanes<16> result;
    setPiece(result.v, 0, a);
    setPiece(result.v, 1, b);
    return result;
#endif
}
template <int L>
RAGTOP_INLINE void storeTwo(Lanes<2 * L> value, float* lower, float* upper) {
    static_assert(L == 8);
#if defined(__AVX512F__)
    *reinterpret_cast<Float8*>(lower) = __builtin_shufflevector(value.v, value.v, 0, 1, 2, 3, 4, 5, 6, 7);
    *reinterpret_cast<Float8*>(upper) = __builtin_shufflevector(value.v, value.v, 8, 9, 10, 11, 12, 13, 14, 15);
#else
    *reinterpret_cast<Float8*>(lower) = pieceOf<Float8>(value.v, 0);
    *reinterpret_cast<Float8*>(upper) = pieceOf<Float8>(value.v, 1);
#endif
}

/// Rows of an array by their numbers, read anew for every row: addresses that wait in memory until they are needed would
/// fill the queue of stores, and the next bundle could not begin before this one is done.
template <class T, int L>
struct NumberedRows {
    using Float = std::conditional_t<std::is_const_v<T>, const float, float>;
    T* rows;
    const std::uint32_t* numbers;
    long perBundle = 0;  ///< entries from the numbers of one bundle of L to those of the next
    int offset = 0;      ///< floats

    RAGTOP_INLINE Float* operator[](int i) const {
        return reinterpret_cast<Float*>(rows + numbers[i % L + i / L * perBundle]) + offset;
    }
    /// The same where the compiler knows nothing of numbers that it has read before.
    RAGTOP_INLINE NumberedRows anew() const {
        const std::uint32_t* same = numbers;
        asm volatile("" : "+r"(same));
        return {rows, same, perBundle, offset};
    }
};

/// Gathers eight consecutive floats per lane from rows[lane].
template <int N, class Rows>
RAGTOP_INLINE void gather8(const Rows& rows, Lanes<N> out[8]) {
    if constexpr (N * sizeof(float) > kNativeBytes) {
        for (int k = 0; k < 2; ++k) {
            const float* half[N / 2];
            for (int i = 0; i < N / 2; ++i) half[i] = rows[N / 2 * k + i];
            Lanes<N / 2> lanes[8];
            gather8<N / 2>(half, lanes);
            for (int i = 0; i < 8; ++i) setPiece(out[i].v, k, lanes[i].v);
        }
    } else if constexpr (N == 4) {
        Float4 lo[4], hi[4];
        for (int i = 0; i < 4; ++i) {
            const float* row = rows[i];
            lo[i] = *reinterpret_cast<const Float4Row*>(row);
            hi[i] = *reinterpret_cast<const Float4Row*>(row + 4);
        }
        transpose4(lo[0], lo[1], lo[2], lo[3]);
        transpose4(hi[0], hi[1], hi[2], hi[3]);
        for (int i = 0; i < 4; ++i) {
            out[i].v = lo[i];
            out[i + 4].v = hi[i];
        }
    } else if constexpr (N == 8) {
        Float8 lo[4], hi[4];
        for (int i = 0; i < 4; ++i) {
            const float *lower = rows[i], *upper = rows[i + 4];
            lo[i] = joinHalves(lower, upper);
            hi[i] = joinHalves(lower + 4, upper + 4);
        }
        transposeFours(lo[0], lo[1], lo[2], lo[3]);
        transposeFours(hi[0], hi[1], hi[2], hi[3]);
        for (int i = 0; i < 4; ++i) {
            out[i].v = lo[i];
            out[i + 4].v = hi[i];
        }
    } else {
#if defined(__AVX512F__)
        Float16 lo[4], hi[4];
        for (int i = 0; i < 4; ++i) {
            const float *a = rows[i], *b = rows[i + 4], *c = rows[i + 8], *d = rows[i + 12];
            lo[i] = joinQuarters(a, b, c, d);
            hi[i] = joinQuarters(a + 4, b + 4, c + 4, d + 4);
        }
        transposeFours(lo[0], lo[1], lo[2], lo[3]);
        transposeFours(hi[0], hi[1], hi[2], hi[3]);
        for (int i = 0; i < 4; ++i) {
            out[i].v = lo[i];
            out[i + 4].v = hi[i];
        }
#endif
    }
}

/// Scatters eight floats per lane to rows[lane]; a null row is left out where `kAll` is false.
template <int N, bool kAll, class Rows>
RAGTOP_INLINE void scatterRows(const Rows& rows, const Lanes<N> in[8]) {
    if constexpr (N * sizeof(float) > kNativeBytes) {
        for (int k = 0; k < 2; ++k) {
            float* half[N / 2];
            for (int i = 0; i < N / 2; ++i) half[i] = rows[N / 2 * k + i];
            Lanes<N / 2> lanes[8];
            for (int i = 0; i < 8; ++i) lanes[i].v = pieceOf<typename Lanes<N / 2>::V>(in[i].v, k);
            scatterRows<N / 2, kAll>(half, lanes);
        }
    } else if constexpr (N == 4) {
        Float4 lo[4], hi[4];
        for (int i = 0; i < 4; ++i) {
            lo[i] = in[i].v;
            hi[i] = in[i + 4].v;
        }
        transpose4(lo[0], lo[1], lo[2], lo[3]);
        transpose4(hi[0], hi[1], hi[2], hi[3]);
        for (int i = 0; i < 4; ++i) {
            float* row = rows[i];
            if (!kAll && !row) continue;
            *reinterpret_cast<Float4Row*>(row) = lo[i];
            *reinterpret_cast<Float4Row*>(row + 4) = hi[i];
        }
    } else if constexpr (N == 8) {
        Float8 r[8];
        for (int i = 0; i < 8; ++i) r[i] = in[i].v;
        transpose8(r);
        for (int i = 0; i < 8; ++i) {
            float* row = rows[i];
            if (kAll || row) *reinterpret_cast<Float8Row*>(row) = r[i];
        }
    } else {
        for (int k = 0; k < 2; ++k) {
            Float8 r[8];
            for (int i = 0; i < 8; ++i)
                r[i] = k == 0 ? __builtin_shufflevector(in[i].v, in[i].v, 0, 1, 2, 3, 4, 5, 6, 7)
                              : __builtin_shufflevector(in[i].v, in[i].v, 8, 9, 10, 11, 12, 13, 14, 15);
            transpose8(r);
            for (int i = 0; i < 8; ++i) {
                float* row = rows[8 * k + i];
                if (kAll || row) *reinterpret_cast<Float8Row*>(row) = r[i];
            }
        }
    }
}
template <int N>
RAGTOP_INLINE void scatter8(float* const rows[N], const Lanes<N> in[8]) {
    scatterRows<N, false>(rows, in);
}
template <int N, class Rows>
RAGTOP_INLINE void scatterAll8(const Rows& rows, const Lanes<N> in[8]) {
    scatterRows<N, true>(rows, in);
}

/// To the rows of bodies that impulses move; those of others are shared between threads and never written.
template <int N, class Rows>
RAGTOP_INLINE void scatterMoving(const Rows& rows, const Lanes<N> in[8], Lanes<N> inverseMass) {
    if (!any(!(inverseMass > 0.0f))) return scatterAll8<N>(rows, in);
    if (!any(inverseMass > 0.0f)) return;
    float* moving[N];
    for (int i = 0; i < N; ++i) moving[i] = inverseMass[i] > 0 ? rows[i] : nullptr;
    scatter8<N>(moving, in);
}

}  // namespace
}  // namespace ragtop
