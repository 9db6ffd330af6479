#pragma once

#include <cmath>

/// Dense 6×6 blocks, one per body or pair of bodies: what a sparse factorization is made of.
namespace ragtop::direct {

/// Element (row, column) is at[6 · column + row].
struct alignas(64) Block6 {
    double at[36];
};

/// L of A = L Lᵀ in place of the lower triangle, with the inverse of its diagonal on the diagonal. False, and the block
/// is of no use, when A is not positive definite.
inline bool factorize(Block6& block) {
    double* a = block.at;
    for (int j = 0; j < 6; ++j) {
        const double pivot = a[7 * j];
        if (!(pivot > 0) || !(pivot < 1e300)) return false;
        const double inverse = 1 / std::sqrt(pivot);
        a[7 * j] = inverse;
        for (int i = j + 1; i < 6; ++i) a[6 * j + i] *= inverse;
        for (int k = j + 1; k < 6; ++k) {
            const double s = a[6 * j + k];
            for (int i = k; i < 6; ++i) a[6 * k + i] -= a[6 * j + i] * s;
        }
    }
    return true;
}

/// A ← A L⁻ᵀ
inline void divideRight(Block6& block, const Block6& factor) {
    double* a = block.at;
    const double* l = factor.at;
    for (int j = 0; j < 6; ++j) {
        for (int k = 0; k < j; ++k) {
            const double s = l[6 * k + j];
            for (int i = 0; i < 6; ++i) a[6 * j + i] -= a[6 * k + i] * s;
        }
        const double inverse = l[7 * j];
        for (int i = 0; i < 6; ++i) a[6 * j + i] *= inverse;
    }
}

/// C ← C − A Bᵀ
inline void subtractProduct(Block6& c, const Block6& a, const Block6& b) {
    for (int j = 0; j < 6; ++j) {
        double column[6];
        for (int i = 0; i < 6; ++i) column[i] = c.at[6 * j + i];
        for (int k = 0; k < 6; ++k) {
            const double s = b.at[6 * k + j];
            for (int i = 0; i < 6; ++i) column[i] -= a.at[6 * k + i] * s;
        }
        for (int i = 0; i < 6; ++i) c.at[6 * j + i] = column[i];
    }
}

/// x ← L⁻¹ x
inline void solveLower(const Block6& factor, double* x) {
    const double* l = factor.at;
    for (int j = 0; j < 6; ++j) {
        x[j] *= l[7 * j];
        for (int i = j + 1; i < 6; ++i) x[i] -= l[6 * j + i] * x[j];
    }
}
/// x ← L⁻ᵀ x
inline void solveUpper(const Block6& factor, double* x) {
    const double* l = factor.at;
    for (int j = 5; j >= 0; --j) {
        double s = x[j];
        for (int i = j + 1; i < 6; ++i) s -= l[6 * j + i] * x[i];
        x[j] = s * l[7 * j];
    }
}
/// y ← y − A x
inline void subtractTimes(const Block6& a, const double* x, double* y) {
    for (int j = 0; j < 6; ++j)
        for (int i = 0; i < 6; ++i) y[i] -= a.at[6 * j + i] * x[j];
}
/// y ← y − Aᵀ x
inline void subtractTransposedTimes(const Block6& a, const double* x, double* y) {
    for (int j = 0; j < 6; ++j) {
        double s = y[j];
        for (int i = 0; i < 6; ++i) s -= a.at[6 * j + i] * x[i];
        y[j] = s;
    }
}
/// A ← A + weight rows columnsᵀ
inline void addOuter(Block6& a, double weight, const double rows[6], const double columns[6]) {
    for (int c = 0; c < 6; ++c) {
        const double s = weight * columns[c];
        for (int r = 0; r < 6; ++r) a.at[6 * c + r] += s * rows[r];
    }
}

}  // namespace ragtop::direct
