// The processor's guaranteed instructions: every width works.
#include "direct/tree_kernels.inl"

namespace ragtop::direct {

extern const TreeTables kTreesBaseline4;
const TreeTables kTreesBaseline4 = makeTreeTables<4>("baseline");
extern const TreeTables kTreesBaseline8;
const TreeTables kTreesBaseline8 = makeTreeTables<8>("baseline");
extern const TreeTables kTreesBaseline16;
const TreeTables kTreesBaseline16 = makeTreeTables<16>("baseline");

}  // namespace ragtop::direct
