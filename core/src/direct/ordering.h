#pragma once

#include <cstdint>
#include <memory_resource>

#include "base/aligned_array.h"

namespace ragtop::direct {

struct BlockPair {
    std::uint32_t a, b;
};

/// The pattern of a symmetric block matrix and of its Cholesky factor, for variables in an order of minimum degree
/// [George, Liu, 1989]: eliminating a variable joins all its neighbours, so the one with fewest goes first. A tree then
/// gets no block that the matrix has not. Kept while the same pairs are given.
class Ordering {
public:
    explicit Ordering(std::pmr::memory_resource* memory);

    /// Makes room for a pattern of about that size.
    void reserve(std::size_t count, std::size_t pairCount);
    /// Variables 0..count−1 coupled by `pairs`, which may repeat. True when the pattern is a new one.
    bool update(std::uint32_t count, const BlockPair* pairs, std::size_t pairCount);

    std::uint32_t count() const { return count_; }
    /// Place of a variable in the order of elimination.
    std::uint32_t place(std::uint32_t variable) const { return place_[variable]; }
    /// Off-diagonal blocks of column k: [columnBegin(k), columnBegin(k + 1)), their rows ascending.
    std::uint32_t columnBegin(std::uint32_t k) const { return begin_[k]; }
    std::uint32_t row(std::uint32_t block) const { return rows_[block]; }
    /// The same as arrays, of count() + 1 and blockCount().
    const std::uint32_t* columns() const { return begin_.data(); }
    const std::uint32_t* rows() const { return rows_.data(); }
    std::uint32_t blockCount() const { return begin_[count_]; }
    /// The block that couples two variables; they must be coupled.
    std::uint32_t blockOf(std::uint32_t a, std::uint32_t b) const;

private:
    static constexpr std::uint64_t kDone = ~std::uint64_t{0};  ///< the rank of what is eliminated

    void eliminate();
    void beginElimination();
    void join(std::uint32_t chosen, std::uint32_t firstRow);
    void setRank(std::uint32_t variable, std::uint64_t rank);
    std::uint64_t* neighboursOf(std::uint32_t v) { return neighbours_.data() + std::size_t{v} * words_; }

    std::uint32_t count_ = 0, words_ = 0, leaves_ = 0;
    AlignedArray<BlockPair> pairs_;
    AlignedArray<std::uint64_t> neighbours_;  ///< one row of bits per variable
    /// Ranks, degree and then number, of the variables from leaves_ on; before them, the lesser one of 2i and 2i + 1.
    AlignedArray<std::uint64_t> least_;
    AlignedArray<std::uint32_t> filled_;  ///< words of a row that have a bit
    AlignedArray<std::uint32_t> place_, begin_, rows_;
};

}  // namespace ragtop::direct
