// AVX-512 without FMA.
#include "cloth/cloth_kernels.inl"

namespace ragtop::cloth {

extern const ClothKernels kClothAvx5128;
const ClothKernels kClothAvx5128 = makeClothKernels<8>();
extern const ClothKernels kClothAvx51216;
const ClothKernels kClothAvx51216 = makeClothKernels<16>();

}  // namespace ragtop::cloth
