// The processor's guaranteed instructions (SSE2, NEON): every width works, so that tests of any width run anywhere.
#include "solve/wide_kernels.inl"

namespace ragtop {

extern const KernelTable kKernelsBaseline4;
const KernelTable kKernelsBaseline4 = makeTable<4>("baseline");
extern const KernelTable kKernelsBaseline8;
const KernelTable kKernelsBaseline8 = makeTable<8>("baseline");
extern const KernelTable kKernelsBaseline16;
const KernelTable kKernelsBaseline16 = makeTable<16>("baseline");

}  // namespace ragtop
