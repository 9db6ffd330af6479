// AVX2 without FMA.
#include "solve/wide_kernels.inl"

namespace ragtop {

extern const KernelTable kKernelsAvx28;
const KernelTable kKernelsAvx28 = makeTable<8>("avx2");

}  // namespace ragtop
