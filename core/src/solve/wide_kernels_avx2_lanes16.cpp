// Sixteen lanes in AVX2, to compare with.
#include "solve/wide_kernels.inl"

namespace ragtop {

extern const KernelTable kKernelsAvx216;
const KernelTable kKernelsAvx216 = makeTable<16>("avx2");

}  // namespace ragtop
