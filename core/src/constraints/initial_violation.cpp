#include "constraints/initial_violation.h"

#include <algorithm>
#include <limits>

namespace ragtop {
namespace {

/// rad, or of the lengths of a joint: what the rows of limits bring back themselves.
constexpr float kSlight = 2e-4f;

/// Of a joint's travels: its arms, or the line of a rope.
float lengthOf(const JointSim& joint) {
    return length(joint.anchorA) + length(joint.anchorB) + length(joint.block.errorFirst);
}

/// The sides of hard stops with what stands for a radian of their coordinates.
template <class Visit>
void forEachHardSide(JointSim& joint, Visit&& visit) {
    const auto axis = [&](AxisRows& rows, float size) {
        if (!(rows.features & AxisRows::kLimit) || rows.stop.stiffness > 0) return;
        visit(rows.atLower, size);
        visit(rows.atUpper, size);
    };
    if (hasAxes(joint.kind)) {
        AxesBlock& axes = withAxes(joint).axes;
        for (std::uint32_t f = 0; f < axes.freeRows; ++f)
            axis(axes.axis[f], lengthSquared(axes.free[f].linear) > 0 ? lengthOf(joint) : 1.0f);
    } else if (joint.kind == JointKind::ball) {
        BallRows& rows = joint.ball;
        if (rows.stop.stiffness > 0) return;
        for (int i = 0; i < sidesOf(rows.swingLimit.shape); ++i) visit(rows.swing[i], 1.0f);
        if (!(rows.features & BallRows::kTwist)) return;
        visit(rows.twistLower, 1.0f);
        visit(rows.twistUpper, 1.0f);
    } else {
        axis(joint.axis, joint.kind == JointKind::hinge ? 1.0f : lengthOf(joint));
    }
}

/// A joint of which nothing is left but what keeps its bodies together and within its range.
AxesJointSim bare(const JointSim& joint, float most) {
    AxesJointSim now = copyOf(joint);
    rescaleJoint(now, 0);
    now.ofFreeTree = 0;
    now.axis.features &= AxisRows::kLimit | AxisRows::kLocked;
    now.ball.features &= BallRows::kSwing | BallRows::kTwist;
    for (AxisRows& rows : now.axes.axis) rows.features &= AxisRows::kLimit | AxisRows::kLocked;
    forEachHardSide(now, [=](StopSide& side, float size) { side.recovery = most * size; });
    return now;
}

}  // namespace

bool isViolatedInitially(const JointSim& joint) {
    bool found = false;
    forEachHardSide(const_cast<JointSim&>(joint),
                    [&](const StopSide& side, float size) { found = found || side.margin < -kSlight * size; });
    return found;
}

float limitOverrun(const JointSim& joint) {
    float most = -std::numeric_limits<float>::max();
    forEachHardSide(const_cast<JointSim&>(joint), [&](const StopSide& side, float size) {
        if (side.recovery > 0) most = std::max(most, -side.margin / size);
    });
    return most;
}

void holdInitialViolation(JointSim& joint) {
    forEachHardSide(joint, [](StopSide& side, float size) {
        if (side.margin < -kSlight * size) side.recovery = 0;
    });
}

/// The pass that moves, of bodies at rest and with a time of 1 s: the velocities that it gives are the shifts.
PairShift shiftBack(const JointSim& joint, const JointBodiesAtStep& bodies, const BodyState* states,
                    const BodyInertia* inertia, float most) {
    constexpr JointContext kAtOnce{1, 1, {1, 1, 0}};
    AxesJointSim now = bare(joint, most);
    BodyState pair[3] = {};
    BodyInertia inertias[3] = {};
    const auto take = [&](std::uint32_t& state, std::uint32_t as) {
        if (state == 0) return;
        pair[as] = states[state];
        pair[as].v = pair[as].w = {};
        inertias[as] = inertia[state];
        state = as;
    };
    take(now.stateA, 1);
    take(now.stateB, 2);
    prepareJoint(now, bodies, pair, inertias, kAtOnce);
    warmStartJoint(now, pair, inertias, kAtOnce);
    solveJoint(now, pair, inertias, kAtOnce, true);
    return {{pair[now.stateA].v, pair[now.stateA].w}, {pair[now.stateB].v, pair[now.stateB].w}};
}

}  // namespace ragtop
