#include "solve/joint_kernels.h"

namespace ragtop {

extern const JointKernels kJointKernelsBaseline4;
#if defined(RAGTOP_X86_KERNELS)
extern const JointKernels kJointKernelsAvx28;
extern const JointKernels kJointKernelsAvx216;
extern const JointKernels kJointKernelsAvx51216;
#endif

const JointKernels& selectJointKernels(int lanes) {
    static constexpr KernelTables<JointKernels> kTables = {
        &kJointKernelsBaseline4,
#if defined(RAGTOP_X86_KERNELS)
        &kJointKernelsAvx28,
        &kJointKernelsAvx216,
        &kJointKernelsAvx51216,
        &kJointKernelsAvx51216,
#endif
    };
    return selectTable<JointKernels>(kTables, lanes);
}

}  // namespace ragtop
