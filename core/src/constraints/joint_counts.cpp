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

void keepCounts(JointSim& joint) {
    JointCounts& kept = joint.countsAtStep;
    if (!hasAxes(joint.kind)) {
        kept.axis = turnsOf(joint.axis);
        return;
    }
    for (std::uint32_t i = 0; i < joint.axes.freeRows; ++i) kept.axes[i] = turnsOf(joint.axes.axis[i]);
    kept.path = joint.path.at;
}

void restoreCounts(JointSim& joint) {
    const JointCounts& kept = joint.countsAtStep;
    if (!hasAxes(joint.kind)) {
        setTurns(joint.axis, kept.axis);
        return;
    }
    for (std::uint32_t i = 0; i < joint.axes.freeRows; ++i) setTurns(joint.axes.axis[i], kept.axes[i]);
    joint.path.at = kept.path;
}

}  // namespace ragtop
