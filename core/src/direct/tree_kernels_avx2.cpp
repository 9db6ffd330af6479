// AVX2 without FMA.
#include "direct/tree_kernels.inl"

namespace ragtop::direct {

extern const TreeTables kTreesAvx28;
const TreeTables kTreesAvx28 = makeTreeTables<8>("avx2");

}  // namespace ragtop::direct
