// AVX2 without FMA.
#include "solve/wide_joints.inl"

namespace ragtop {

extern const JointKernels kJointKernelsAvx28;
const JointKernels kJointKernelsAvx28 = makeJointTable<8>("avx2");

}  // namespace ragtop
