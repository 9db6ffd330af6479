#include "solve/joint_kernels.h"

namespace ragtop {

RAGTOP_SELECT_KERNELS(JointKernels, selectJointKernels, kJointKernels)

}  // namespace ragtop
