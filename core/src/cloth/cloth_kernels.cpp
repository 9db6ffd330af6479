#include "cloth/cloth_kernels.h"

#include "solve/kernel_table.h"

namespace ragtop::cloth {

extern const ClothKernels kClothBaseline4;
#if defined(RAGTOP_X86_KERNELS)
extern const ClothKernels kClothAvx28;
extern const ClothKernels kClothAvx216;
extern const ClothKernels kClothAvx5128;
extern const ClothKernels kClothAvx51216;
#endif

const ClothKernels& selectClothKernels(int lanes) {
    static constexpr KernelTables<ClothKernels> kTables = {
        &kClothBaseline4,
#if defined(RAGTOP_X86_KERNELS)
        &kClothAvx28,
        &kClothAvx216,
        &kClothAvx5128,
        &kClothAvx51216,
#endif
    };
    return selectTable<ClothKernels>(kTables, lanes);
}

}  // namespace ragtop::cloth
