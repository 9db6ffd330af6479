// AVX2 without FMA.
#include "cloth/cloth_kernels.inl"

namespace ragtop::cloth {

extern const ClothKernels kClothAvx28;
const ClothKernels kClothAvx28 = makeClothKernels<8>();
extern const ClothKernels kClothAvx216;
const ClothKernels kClothAvx216 = makeClothKernels<16>();

}  // namespace ragtop::cloth
