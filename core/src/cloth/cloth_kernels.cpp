#include "cloth/cloth_kernels.h"

#include "solve/kernel_table.h"

namespace ragtop::cloth {

RAGTOP_SELECT_KERNELS(ClothKernels, selectClothKernels, kCloth)

}  // namespace ragtop::cloth
