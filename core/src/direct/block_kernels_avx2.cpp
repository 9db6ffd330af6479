// AVX2 without FMA.
#include "direct/block_kernels.inl"

namespace ragtop::direct {

extern const BlockKernels kBlocksAvx2;
const BlockKernels kBlocksAvx2 = makeBlockKernels("avx2");

}  // namespace ragtop::direct
