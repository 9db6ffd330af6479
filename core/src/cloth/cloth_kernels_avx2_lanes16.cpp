// Sixteen lanes in AVX2, to compare with.
#include "cloth/cloth_kernels.inl"

namespace ragtop::cloth {

extern const ClothKernels kClothAvx216;
const ClothKernels kClothAvx216 = makeClothKernels<16>();

}  // namespace ragtop::cloth
