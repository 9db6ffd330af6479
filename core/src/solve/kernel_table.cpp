#include "solve/kernel_table.h"

namespace ragtop {

extern const KernelTable kKernelsBaseline4;
extern const KernelTable kKernelsBaseline8;
extern const KernelTable kKernelsBaseline16;
#if defined(RAGTOP_X86_KERNELS)
extern const KernelTable kKernelsAvx28;
extern const KernelTable kKernelsAvx216;
extern const KernelTable kKernelsAvx5128;
extern const KernelTable kKernelsAvx51216;
#endif

KernelSet selectKernelSet(int lanes) {
#if defined(RAGTOP_X86_KERNELS)
    const bool avx2 = __builtin_cpu_supports("avx2");
    const bool avx512 =
        __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512vl");
    if (lanes == 0) lanes = avx512 ? 16 : avx2 ? 8 : 4;
    if (lanes == 16 && avx512) return KernelSet::avx512Lanes16;
    if (lanes == 16 && avx2) return KernelSet::avx2Lanes16;
    if (lanes == 8 && avx512) return KernelSet::avx512Lanes8;
    if (lanes == 8 && avx2) return KernelSet::avx2Lanes8;
#endif
    if (lanes == 16) return KernelSet::baseline16;
    if (lanes == 8) return KernelSet::baseline8;
    return KernelSet::baseline4;
}

const KernelTable& selectKernels(int lanes) {
    static constexpr KernelTables<KernelTable> kTables = {
        &kKernelsBaseline4,
        &kKernelsBaseline8,
        &kKernelsBaseline16,
#if defined(RAGTOP_X86_KERNELS)
        &kKernelsAvx28,
        &kKernelsAvx216,
        &kKernelsAvx5128,
        &kKernelsAvx51216,
#endif
    };
    return selectTable<KernelTable>(kTables, lanes);
}

}  // namespace ragtop
