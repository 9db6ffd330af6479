#include "solve/kernel_table.h"

namespace ragtop {

extern const KernelTable kKernelsBaseline4;
extern const KernelTable kKernelsBaseline8;
extern const KernelTable kKernelsBaseline16;
#if defined(RAGTOP_X86_KERNELS)
extern const KernelTable kKernelsAvx28;
extern const KernelTable kKernelsAvx216;
extern const KernelTable kKernelsAvx51216;
#endif

const KernelTable& selectKernels(int lanes) {
#if defined(RAGTOP_X86_KERNELS)
    const bool avx2 = __builtin_cpu_supports("avx2");
    const bool avx512 =
        __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512vl");
    if (lanes == 0) lanes = avx512 ? 16 : avx2 ? 8 : 4;
    if (lanes == 16 && avx512) return kKernelsAvx51216;
    if (lanes == 16 && avx2) return kKernelsAvx216;
    if (lanes == 8 && avx2) return kKernelsAvx28;
#endif
    if (lanes == 16) return kKernelsBaseline16;
    if (lanes == 8) return kKernelsBaseline8;
    return kKernelsBaseline4;
}

}  // namespace ragtop
