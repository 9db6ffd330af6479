// The processor's guaranteed instructions (SSE2, NEON): four lanes.
#include "cloth/cloth_kernels.inl"

namespace ragtop::cloth {

extern const ClothKernels kClothBaseline4;
const ClothKernels kClothBaseline4 = makeClothKernels<4>();

}  // namespace ragtop::cloth
