#pragma once

#include <cstdint>

#include "direct/block6.h"

namespace ragtop::direct {

/// A sparse matrix of blocks and its pattern, for the kernels: diagonal blocks, and the blocks below them by columns.
struct BlockMatrix {
    std::uint32_t count = 0;
    const std::uint32_t* columnBegin = nullptr;  ///< count + 1
    const std::uint32_t* rows = nullptr;         ///< of each block below the diagonal
    const std::uint32_t* targets = nullptr;      ///< where the product of each pair of blocks of a column goes, in turn
    Block6* diagonal = nullptr;
    Block6* lower = nullptr;
};

/// Of one instruction set: the sums of each number are the same ones in the same order, so all give the same bits.
struct BlockKernels {
    const char* name;
    /// Puts the Cholesky factor in place of the matrix. False when that is not positive definite.
    bool (*factorize)(const BlockMatrix&);
    /// x ← A⁻¹ x of a factor, six numbers per variable in the order of elimination.
    void (*solve)(const BlockMatrix&, double* x);
};

/// Those of the processor (solve/kernel_table.h).
const BlockKernels& selectBlockKernels();

}  // namespace ragtop::direct
