// AVX-512 F, DQ and VL, contraction off.
#include "solve/wide_kernels.inl"

namespace ragtop {

extern const KernelTable kKernelsAvx5128;
const KernelTable kKernelsAvx5128 = makeTable<8, 16, 2>("avx512");
extern const KernelTable kKernelsAvx51216;
const KernelTable kKernelsAvx51216 = makeTable<16>("avx512");

}  // namespace ragtop
