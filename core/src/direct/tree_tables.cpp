#include "direct/tree_layout.h"

namespace ragtop::direct {

extern const TreeTables kTreesBaseline4;
#if defined(RAGTOP_X86_KERNELS)
extern const TreeTables kTreesAvx28;
extern const TreeTables kTreesAvx216;
extern const TreeTables kTreesAvx5128;
extern const TreeTables kTreesAvx51216;
#endif

const TreeTables& selectTreeKernels(int lanes) {
    static constexpr KernelTables<TreeTables> kTables = {
        &kTreesBaseline4,
#if defined(RAGTOP_X86_KERNELS)
        &kTreesAvx28,
        &kTreesAvx216,
        &kTreesAvx5128,
        &kTreesAvx51216,
#endif
    };
    return selectTable<TreeTables>(kTables, lanes);
}

}  // namespace ragtop::direct
