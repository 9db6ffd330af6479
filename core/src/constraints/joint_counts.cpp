#include "constraints/joint_counts.h"

#include "constraints/joint_sim.h"

namespace ragtop {
// Balls, sliders and the like count nothing, and most joints are balls: what is kept of the others lies a cache line
// away.

void keepCounts(JointSim& joint) {
    if (joint.kind == JointKind::hinge) {
        joint.angleAtStep = joint.axis.angle;
    } else if (hasAxes(joint.kind)) {
        AxesJointSim& own = withAxes(joint);
        for (std::uint32_t i = 0; i < own.axes.freeRows; ++i) own.countsAtStep.axes[i] = own.axes.axis[i].angle;
        own.countsAtStep.path = own.path.at;
    }
}

void restoreCounts(JointSim& joint) {
    if (joint.kind == JointKind::hinge) {
        joint.axis.angle = joint.angleAtStep;
    } else if (hasAxes(joint.kind)) {
        AxesJointSim& own = withAxes(joint);
        for (std::uint32_t i = 0; i < own.axes.freeRows; ++i) own.axes.axis[i].angle = own.countsAtStep.axes[i];
        own.path.at = own.countsAtStep.path;
    }
}

}  // namespace ragtop
