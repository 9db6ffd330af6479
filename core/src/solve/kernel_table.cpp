#include "solve/kernel_table.h"

#include <algorithm>

namespace ragtop {

RAGTOP_SELECT_KERNELS(KernelTable, selectKernels, kKernels)

namespace {

Instructions widestAllowed = Instructions::avx512;

Instructions widestHere() {
#if defined(RAGTOP_X86_KERNELS)
    if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512vl"))
        return Instructions::avx512;
    if (__builtin_cpu_supports("avx2")) return Instructions::avx2;
#endif
    return Instructions::baseline;
}

}  // namespace

Instructions usableInstructions() { return std::min(widestHere(), widestAllowed); }

void limitInstructions(Instructions most) { widestAllowed = most; }

KernelSet selectKernelSet([[maybe_unused]] int lanes) {
#if defined(RAGTOP_X86_KERNELS)
    const Instructions usable = usableInstructions();
    if (lanes == 0) lanes = usable == Instructions::avx512 ? 16 : usable == Instructions::avx2 ? 8 : 4;
    if (usable == Instructions::avx512 && lanes > 4)
        return lanes == 16 ? KernelSet::avx512Lanes16 : KernelSet::avx512Lanes8;
#if defined(RAGTOP_AVX2_LANES16)
    if (usable == Instructions::avx2 && lanes == 16) return KernelSet::avx2Lanes16;
#endif
    if (usable == Instructions::avx2 && lanes > 4) return KernelSet::avx2Lanes8;
#endif
    return KernelSet::baseline4;
}

}  // namespace ragtop
