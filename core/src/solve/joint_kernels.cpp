#include "solve/joint_kernels.h"

#include <string_view>

namespace ragtop {

extern const JointKernels kJointKernelsBaseline4;
extern const JointKernels kJointKernelsBaseline8;
extern const JointKernels kJointKernelsBaseline16;
#if defined(RAGTOP_X86_KERNELS)
extern const JointKernels kJointKernelsAvx28;
extern const JointKernels kJointKernelsAvx216;
extern const JointKernels kJointKernelsAvx51216;
#endif

const JointKernels& selectJointKernels(int lanes) {
    const KernelTable& contacts = selectKernels(lanes);
    const JointKernels* const all[] = {
#if defined(RAGTOP_X86_KERNELS)
        &kJointKernelsAvx28,
        &kJointKernelsAvx216,
        &kJointKernelsAvx51216,
#endif
        &kJointKernelsBaseline4,
        &kJointKernelsBaseline8,
        &kJointKernelsBaseline16
    };
    for (const JointKernels* joints : all)
        if (joints->lanes == contacts.lanes && std::string_view(joints->name) == contacts.name) return *joints;
    return kJointKernelsBaseline4;
}

}  // namespace ragtop
