// Sixteen lanes in AVX2, to compare with.
#include "solve/wide_joints.inl"

namespace ragtop {

extern const JointKernels kJointKernelsAvx216;
const JointKernels kJointKernelsAvx216 = makeJointTable<16>("avx2");

}  // namespace ragtop
