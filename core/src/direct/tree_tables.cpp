#include "direct/tree_layout.h"

namespace ragtop::direct {

RAGTOP_SELECT_KERNELS(TreeTables, selectTreeKernels, kTrees)

}  // namespace ragtop::direct
