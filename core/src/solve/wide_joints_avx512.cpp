// AVX-512 F, DQ and VL, contraction off.
#include "solve/wide_joints.inl"

namespace ragtop {

extern const JointKernels kJointKernelsAvx51216;
const JointKernels kJointKernelsAvx51216 = makeJointTable<16>("avx512");

}  // namespace ragtop
