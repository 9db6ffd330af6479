#include "direct/block_kernels.h"

#include "solve/kernel_table.h"

namespace ragtop::direct {

extern const BlockKernels kBlocksBaseline, kBlocksAvx2;

/// Blocks of six have no use for vectors of eight: what has AVX-512 takes those of AVX2.
const BlockKernels& selectBlockKernels() {
#if defined(RAGTOP_X86_KERNELS)
    if (usableInstructions() != Instructions::baseline) return kBlocksAvx2;
#endif
    return kBlocksBaseline;
}

}  // namespace ragtop::direct
