#pragma once

#include "constraints/joint_image.h"
#include "solve/kernel_table.h"

namespace ragtop {

/// What a pass over joints takes beside its bundles.
struct JointPass {
    BodyArrays arrays;
    JointContext context;
};

/// Wide kernels of joints, of one instruction set and lane count, for ranges of bundles that share no moving body.
/// They give the bits of warmStartJoint and solveJoint.
struct JointKernels {
    const char* name;
    int lanes;
    void (*load)(const JointLanesView&, int begin, int end);
    void (*store)(const JointLanesView&, int begin, int end);
    void (*warmStart)(const JointLanesView&, int begin, int end, const JointPass&);
    void (*solve)(const JointLanesView&, int begin, int end, const JointPass&);
    void (*relax)(const JointLanesView&, int begin, int end, const JointPass&);
};

/// Those of the instruction set that `selectKernels` gives, and of its lane count; with AVX-512 sixteen instead of eight,
/// since bundles of joints are nobody else's.
const JointKernels& selectJointKernels(int lanes);

}  // namespace ragtop
