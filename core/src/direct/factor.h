#pragma once

#include <cstdint>
#include <memory_resource>

#include "base/aligned_array.h"
#include "direct/block_kernels.h"
#include "direct/ordering.h"

namespace ragtop::direct {

/// A symmetric positive definite matrix of 6×6 blocks and, in its place, its Cholesky factor.
class BlockFactor {
public:
    explicit BlockFactor(std::pmr::memory_resource* memory);

    /// Makes room for a pattern of about that size.
    void reserve(std::size_t count, std::size_t pairCount);
    /// The pattern; a new one makes the factor worthless.
    bool update(std::uint32_t count, const BlockPair* pairs, std::size_t pairCount);
    const Ordering& ordering() const { return ordering_; }

    void setZero();
    /// Of which the lower triangle counts.
    Block6& diagonal(std::uint32_t variable) { return diagonal_[ordering_.place(variable)]; }
    /// A coupling block as it is stored: rows of the variable that is eliminated later.
    Block6& coupling(std::uint32_t block) { return lower_[block]; }
    /// True when a is the variable of the rows of the block that couples a and b.
    bool rowsAreOf(std::uint32_t a, std::uint32_t b) const { return ordering_.place(a) > ordering_.place(b); }

    /// Products of blocks that factorizing takes.
    std::size_t products() const { return targets_.size() + lower_.size(); }
    /// False when the matrix is not positive definite.
    bool factorize();
    /// x ← A⁻¹ x, six numbers per variable.
    void solve(double* x);

private:
    BlockMatrix matrix();

    const BlockKernels* kernels_;
    Ordering ordering_;
    AlignedArray<Block6> diagonal_, lower_;
    AlignedArray<std::uint32_t> targets_;  ///< where the product of each pair of blocks of a column goes
    AlignedArray<double> permuted_;
};

}  // namespace ragtop::direct
