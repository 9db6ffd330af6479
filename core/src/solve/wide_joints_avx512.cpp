// AVX-512 F, DQ and VL, contraction off. Bundles of joints are nobody else's: sixteen lanes where others have eight.
#include "solve/wide_joints.inl"

namespace ragtop {

extern const JointKernels kJointKernelsAvx5128;
const JointKernels kJointKernelsAvx5128 = makeJointTable<16>("avx512");
extern const JointKernels kJointKernelsAvx51216;
const JointKernels kJointKernelsAvx51216 = makeJointTable<16>("avx512");

}  // namespace ragtop
