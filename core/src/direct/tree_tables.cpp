#include <cstring>

#include "direct/tree_layout.h"

namespace ragtop::direct {

extern const TreeTables kTreesBaseline4;
extern const TreeTables kTreesBaseline8;
extern const TreeTables kTreesBaseline16;
#if defined(RAGTOP_X86_KERNELS)
extern const TreeTables kTreesAvx28;
extern const TreeTables kTreesAvx216;
extern const TreeTables kTreesAvx51216;
#endif

const TreeTables& selectTreeKernels(int lanes) {
    const KernelTable& wide = selectKernels(lanes);
#if defined(RAGTOP_X86_KERNELS)
    const TreeTables* const tables[] = {&kTreesAvx28, &kTreesAvx216, &kTreesAvx51216};
    for (const TreeTables* table : tables)
        if (table->single.lanes == wide.lanes && std::strcmp(table->single.name, wide.name) == 0) return *table;
#endif
    return wide.lanes == 16 ? kTreesBaseline16 : wide.lanes == 8 ? kTreesBaseline8 : kTreesBaseline4;
}

}  // namespace ragtop::direct
