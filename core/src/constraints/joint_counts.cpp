#include "constraints/joint_counts.h"

#include "constraints/joint_sim.h"

namespace ragtop {
namespace {

JointCounts::Turns turnsOf(const AxisRows& axis) { return {axis.lastAngle, axis.turns, axis.tracked}; }
void setTurns(AxisRows& axis, const JointCounts::Turns& counted) {
    axis.lastAngle = counted.lastAngle;
    axis.turns = counted.turns;
    axis.tracked = counted.tracked;
}

}  // namespace

// Balls, sliders and the like count nothing, and most joints are balls: what is kept of the others lies a cache line
// away.

void keepCounts(JointSim& joint) {
    if (joint.kind == JointKind::hinge) {
        joint.countsAtStep.axis = turnsOf(joint.axis);
    } else if (hasAxes(joint.kind)) {
        for (std::uint32_t i = 0; i < joint.axes.freeRows; ++i)
            joint.countsAtStep.axes[i] = turnsOf(joint.axes.axis[i]);
        joint.countsAtStep.path = joint.path.at;
    }
}

void restoreCounts(JointSim& joint) {
    if (joint.kind == JointKind::hinge) {
        setTurns(joint.axis, joint.countsAtStep.axis);
    } else if (hasAxes(joint.kind)) {
        for (std::uint32_t i = 0; i < joint.axes.freeRows; ++i)
            setTurns(joint.axes.axis[i], joint.countsAtStep.axes[i]);
        joint.path.at = joint.countsAtStep.path;
    }
}

}  // namespace ragtop
