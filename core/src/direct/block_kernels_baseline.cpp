// The processor's guaranteed instructions (SSE2, NEON).
#include "direct/block_kernels.inl"

namespace ragtop::direct {

extern const BlockKernels kBlocksBaseline;
const BlockKernels kBlocksBaseline = makeBlockKernels("baseline");

}  // namespace ragtop::direct
