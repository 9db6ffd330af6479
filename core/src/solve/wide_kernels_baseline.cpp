// The processor's guaranteed instructions (SSE2, NEON): four lanes.
#include "solve/wide_kernels.inl"

namespace ragtop {

extern const KernelTable kKernelsBaseline4;
const KernelTable kKernelsBaseline4 = makeTable<4>("baseline");

}  // namespace ragtop
