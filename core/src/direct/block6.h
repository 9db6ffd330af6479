#pragma once

#include <type_traits>
#include <utility>

/// Dense 6×6 blocks, one per body or pair of bodies: what a sparse factorization is made of.
namespace ragtop::direct {

/// Element (row, column) is at[6 · column + row].
struct alignas(32) Block6 {
    double at[36];
};

/// Calls visit(std::integral_constant<int, i>) for i from `From` below `Until` in turn. Compilers do not unroll loops
/// of six within each other by themselves, and blocks are then read and written once for each of their columns.
template <int From, int Until, class Visit>
inline void unrolled(Visit&& visit) {
    if constexpr (From < Until) {
        visit(std::integral_constant<int, From>{});
        unrolled<From + 1, Until>(visit);
    }
}

/// A ← A + weight rows columnsᵀ
inline void addOuter(Block6& block, double weight, const double rows[6], const double columns[6]) {
    unrolled<0, 6>([&](auto c) {
        const double s = weight * columns[c];
        unrolled<0, 6>([&](auto r) { block.at[6 * c + r] += s * rows[r]; });
    });
}
/// A ← A + weight a aᵀ, the lower triangle.
inline void addSquare(Block6& block, double weight, const double a[6]) {
    unrolled<0, 6>([&](auto c) {
        const double s = weight * a[c];
        unrolled<c, 6>([&](auto r) { block.at[6 * c + r] += s * a[r]; });
    });
}

}  // namespace ragtop::direct
