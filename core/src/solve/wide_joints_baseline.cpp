// The processor's guaranteed instructions (SSE2, NEON), for any width.
#include "solve/wide_joints.inl"

namespace ragtop {

extern const JointKernels kJointKernelsBaseline4;
const JointKernels kJointKernelsBaseline4 = makeJointTable<4>("baseline");
extern const JointKernels kJointKernelsBaseline8;
const JointKernels kJointKernelsBaseline8 = makeJointTable<8>("baseline");
extern const JointKernels kJointKernelsBaseline16;
const JointKernels kJointKernelsBaseline16 = makeJointTable<16>("baseline");

}  // namespace ragtop
