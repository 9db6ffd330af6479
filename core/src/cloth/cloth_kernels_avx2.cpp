// AVX2 without FMA.
#include "cloth/cloth_kernels.inl"

namespace ragtop::cloth {

extern const ClothKernels kClothAvx28;
const ClothKernels kClothAvx28 = makeClothKernels<8>();

}  // namespace ragtop::cloth
