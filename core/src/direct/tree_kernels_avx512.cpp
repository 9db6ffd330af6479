// AVX-512 F, DQ and VL, contraction off.
#include "direct/tree_kernels.inl"

namespace ragtop::direct {

extern const TreeTables kTreesAvx51216;
const TreeTables kTreesAvx51216 = makeTreeTables<16>("avx512");
extern const TreeTables kTreesAvx5128;
const TreeTables kTreesAvx5128 = makeTreeTables<8>("avx512", &kTreesAvx51216);

}  // namespace ragtop::direct
