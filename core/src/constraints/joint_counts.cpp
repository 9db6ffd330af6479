#include "constraints/joint_counts.h"

#include "constraints/joint_sim.h"

namespace ragtop {
// Balls, sliders and the like count nothing, and most joints are balls: what is kept of the others lies a cache line
// away.

void keepCounts(JointSim& joint) {
    if (joint.kind == JointKind::hinge) {
        joint.countsAtStep.axis = joint.axis.angle;
    } else if (hasAxes(joint.kind)) {
        for (std::uint32_t i = 0; i < joint.axes.freeRows; ++i) joint.countsAtStep.axes[i] = joint.axes.axis[i].angle;
        joint.countsAtStep.path = joint.path.at;
    }
}

void restoreCounts(JointSim& joint) {
    if (joint.kind == JointKind::hinge) {
        joint.axis.angle = joint.countsAtStep.axis;
    } else if (hasAxes(joint.kind)) {
        for (std::uint32_t i = 0; i < joint.axes.freeRows; ++i) joint.axes.axis[i].angle = joint.countsAtStep.axes[i];
        joint.path.at = joint.countsAtStep.path;
    }
}

}  // namespace ragtop
