// Sixteen lanes in AVX2, to compare with.
#include "direct/tree_kernels.inl"

namespace ragtop::direct {

extern const TreeTables kTreesAvx216;
const TreeTables kTreesAvx216 = makeTreeTables<16>("avx2");

}  // namespace ragtop::direct
