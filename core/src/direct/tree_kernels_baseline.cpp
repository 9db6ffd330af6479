// The processor's guaranteed instructions (SSE2, NEON): four lanes.
#include "direct/tree_kernels.inl"

namespace ragtop::direct {

extern const TreeTables kTreesBaseline4;
const TreeTables kTreesBaseline4 = makeTreeTables<4>("baseline");

}  // namespace ragtop::direct
