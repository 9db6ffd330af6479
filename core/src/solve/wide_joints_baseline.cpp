// The processor's guaranteed instructions (SSE2, NEON): four lanes.
#include "solve/wide_joints.inl"

namespace ragtop {

extern const JointKernels kJointKernelsBaseline4;
const JointKernels kJointKernelsBaseline4 = makeJointTable<4>("baseline");

}  // namespace ragtop
