// Cholesky factors of 6 × 6 blocks and what is solved with them. Included by one source per instruction set.

#include <cstddef>

#include "base/numbers.h"
#include "direct/block_kernels.h"

namespace ragtop::direct {
namespace {

/// A column of six in vectors: rows 0 to 3, and rows 4 and 5. Two columns have their last rows in one vector.
typedef double Four __attribute__((vector_size(32)));
typedef double Two __attribute__((vector_size(16)));

template <class V>
RAGTOP_INLINE void loadTo(V& to, const double* from) {
    __builtin_memcpy(&to, from, sizeof(V));
}
template <class V>
RAGTOP_INLINE void storeFrom(const V& from, double* to) {
    __builtin_memcpy(to, &from, sizeof(V));
}

/// L of A = L Lᵀ in place of the lower triangle, with the inverse of its diagonal on the diagonal. False, and the block
/// is of no use, when A is not positive definite.
RAGTOP_INLINE bool factorizeBlock(Block6& block) {
    double* a = block.at;
    bool positive = true;
    unrolled<0, 6>([&](auto j) {
        const double pivot = a[7 * j];
        positive = positive && pivot > 0 && pivot < 1e300;
        const double inverse = 1 / __builtin_sqrt(pivot);
        a[7 * j] = inverse;
        unrolled<j + 1, 6>([&](auto i) { a[6 * j + i] *= inverse; });
        unrolled<j + 1, 6>([&](auto k) {
            const double s = a[6 * j + k];
            unrolled<k, 6>([&](auto i) { a[6 * k + i] -= a[6 * j + i] * s; });
        });
    });
    return positive;
}

/// A ← A L⁻ᵀ
RAGTOP_INLINE void divideRight(Block6& block, const Block6& factor) {
    double* a = block.at;
    const double* l = factor.at;
    Four top[6];
    Two rest[6];
    unrolled<0, 6>([&](auto j) {
        loadTo(top[j], a + 6 * j);
        loadTo(rest[j], a + 6 * j + 4);
        unrolled<0, j>([&](auto k) {
            const double s = l[6 * k + j];
            top[j] -= top[k] * s;
            rest[j] -= rest[k] * s;
        });
        top[j] *= l[7 * j];
        rest[j] *= l[7 * j];
        storeFrom(top[j], a + 6 * j);
        storeFrom(rest[j], a + 6 * j + 4);
    });
}

/// C ← C − A Bᵀ. Of a block on the diagonal the lower triangle alone: what lies above is of no use to anybody.
template <bool kDiagonal>
RAGTOP_INLINE void subtractProduct(Block6& c, const Block6& a, const Block6& b) {
    constexpr int kTops = kDiagonal ? 4 : 6;
    Four top[kTops], rest[3];
    unrolled<0, kTops>([&](auto j) { loadTo(top[j], c.at + 6 * j); });
    unrolled<0, 3>([&](auto p) {
        Two first, second;
        loadTo(first, c.at + 12 * p + 4);
        loadTo(second, c.at + 12 * p + 10);
        rest[p] = __builtin_shufflevector(first, second, 0, 1, 2, 3);
    });
    unrolled<0, 6>([&](auto k) {
        const double *ofA = a.at + 6 * k, *ofB = b.at + 6 * k;
        Four left;
        Two last;
        loadTo(left, ofA);
        loadTo(last, ofA + 4);
        const Four under = __builtin_shufflevector(last, last, 0, 1, 0, 1);
        unrolled<0, kTops>([&](auto j) { top[j] -= left * ofB[j]; });
        unrolled<0, 3>([&](auto p) {
            Two s;
            loadTo(s, ofB + 2 * p);
            rest[p] -= under * __builtin_shufflevector(s, s, 0, 0, 1, 1);
        });
    });
    unrolled<0, kTops>([&](auto j) { storeFrom(top[j], c.at + 6 * j); });
    unrolled<0, 3>([&](auto p) {
        storeFrom(__builtin_shufflevector(rest[p], rest[p], 0, 1), c.at + 12 * p + 4);
        storeFrom(__builtin_shufflevector(rest[p], rest[p], 2, 3), c.at + 12 * p + 10);
    });
}

/// x ← L⁻¹ x
RAGTOP_INLINE void solveLower(const Block6& factor, double* x) {
    const double* l = factor.at;
    unrolled<0, 6>([&](auto j) {
        x[j] *= l[7 * j];
        unrolled<j + 1, 6>([&](auto i) { x[i] -= l[6 * j + i] * x[j]; });
    });
}
/// x ← L⁻ᵀ x
RAGTOP_INLINE void solveUpper(const Block6& factor, double* x) {
    const double* l = factor.at;
    for (int j = 5; j >= 0; --j) {
        double s = x[j];
        for (int i = j + 1; i < 6; ++i) s -= l[6 * j + i] * x[i];
        x[j] = s * l[7 * j];
    }
}
/// y ← y − A x
RAGTOP_INLINE void subtractTimes(const Block6& a, const double* x, double* y) {
    Four top;
    Two rest;
    loadTo(top, y);
    loadTo(rest, y + 4);
    unrolled<0, 6>([&](auto j) {
        Four left;
        Two under;
        loadTo(left, a.at + 6 * j);
        loadTo(under, a.at + 6 * j + 4);
        top -= left * x[j];
        rest -= under * x[j];
    });
    storeFrom(top, y);
    storeFrom(rest, y + 4);
}
/// y ← y − Aᵀ x
RAGTOP_INLINE void subtractTransposedTimes(const Block6& a, const double* x, double* y) {
    unrolled<0, 6>([&](auto j) {
        double s = y[j];
        unrolled<0, 6>([&](auto i) { s -= a.at[6 * j + i] * x[i]; });
        y[j] = s;
    });
}

/// Right-looking: each column, once complete, is taken out of all columns that it reaches.
bool factorizeMatrix(const BlockMatrix& m) {
    const std::uint32_t* target = m.targets;
    for (std::uint32_t k = 0; k < m.count; ++k) {
        if (!factorizeBlock(m.diagonal[k])) return false;
        const std::uint32_t begin = m.columnBegin[k], end = m.columnBegin[k + 1];
        for (std::uint32_t b = begin; b < end; ++b) divideRight(m.lower[b], m.diagonal[k]);
        for (std::uint32_t b = begin; b < end; ++b) {
            subtractProduct<true>(m.diagonal[m.rows[b]], m.lower[b], m.lower[b]);
            for (std::uint32_t a = b + 1; a < end; ++a)
                subtractProduct<false>(m.lower[*target++], m.lower[a], m.lower[b]);
        }
    }
    return true;
}

void solveMatrix(const BlockMatrix& m, double* x) {
    for (std::uint32_t k = 0; k < m.count; ++k) {
        solveLower(m.diagonal[k], x + std::size_t{6} * k);
        for (std::uint32_t b = m.columnBegin[k]; b < m.columnBegin[k + 1]; ++b)
            subtractTimes(m.lower[b], x + std::size_t{6} * k, x + std::size_t{6} * m.rows[b]);
    }
    for (std::uint32_t k = m.count; k-- > 0;) {
        for (std::uint32_t b = m.columnBegin[k]; b < m.columnBegin[k + 1]; ++b)
            subtractTransposedTimes(m.lower[b], x + std::size_t{6} * m.rows[b], x + std::size_t{6} * k);
        solveUpper(m.diagonal[k], x + std::size_t{6} * k);
    }
}

constexpr BlockKernels makeBlockKernels(const char* name) { return {name, factorizeMatrix, solveMatrix}; }

}  // namespace
}  // namespace ragtop::direct
