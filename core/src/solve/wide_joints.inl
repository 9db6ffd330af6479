// Joints, N at a time: written once, compiled per instruction set. Every kind does what its refresh and solve functions
// in constraints/ do, operation by operation; rows that act in some lanes alone leave the others as they are.

#include <cstdint>

#include "constraints/joint_ball_turn.h"
#include "constraints/joint_constants.h"
#include "constraints/joint_geometry.h"
#include "constraints/joint_hinge.h"
#include "solve/joint_kernels.h"
#include "solve/lane_rows.h"
#include "solve/lanes.h"

// In this order: each builds on those before it.
// clang-format off
#include "solve/wide_parts.inl"
#include "solve/wide_joint_bodies.inl"
#include "solve/wide_joint_rows.inl"
#include "solve/wide_joint_springs.inl"
#include "solve/wide_joint_ball.inl"
#include "solve/wide_joint_blocks.inl"
#include "solve/wide_joint_copies.inl"
// clang-format on

namespace ragtop {
namespace {

/// As warmStartImpulse.
template <int N>
RAGTOP_INLINE PairVectorOf<Lanes<N>> warmStartImpulse(const WideJoint<N>& j) {
    const WideBlock<N>& block = blockAt(j);
    PairVectorOf<Lanes<N>> sum{block.impulseFirst, block.impulseSecond};
    const JointKind kind = j.bundle.kind;
    if (kind == JointKind::ball) {
        if (j.bundle.features != 0) sum.angular = sum.angular + turningImpulse(j);
    } else if (kind == JointKind::hinge) {
        if (j.bundle.features != 0)
            sum.angular = sum.angular + ownImpulse(axisRows(j)) * block.basis.cz;
    } else if (kind == JointKind::distance) {
        sum.linear = sum.linear + ownImpulse(axisRows(j)) * block.basis.cz;
    }
    return sum;
}

template <int N>
void warmStartJoints(const JointLanesView& view, int begin, int end, const JointPass& pass) {
    for (int i = begin; i < end; ++i) {
        WideJoint<N> j(view, i, pass.arrays);
        j.locate();
        j.storeArms();
        j.recordPull(warmStartImpulse(j).linear, pass.context.h);
        switch (j.bundle.kind) {
            case JointKind::ball:
                beginBallJoint(j, pass.context);
                break;
            case JointKind::hinge:
                beginHinge(j, pass.context);
                break;
            case JointKind::fixed:
                keep(blockAt(j), refreshFixed(j), j.bundle);
                break;
            default:
                beginDistance(j, pass.context);
                break;
        }
        j.apply(j.arms, warmStartImpulse(j));
        j.writeVelocities();
    }
}

template <int N>
void solveJoints(const JointLanesView& view, int begin, int end, const JointPass& pass) {
    const JointContext& context = pass.context;
    for (int i = begin; i < end; ++i) {
        WideJoint<N> j(view, i, pass.arrays);
        j.loadArms();
        j.gap = blockAt(j).errorFirst;
        switch (j.bundle.kind) {
            case JointKind::ball: {
                WideBlock<N> block = loadBlock(j, 0);
                solveBall(j, block, loadTurns(j), context, true);
                break;
            }
            case JointKind::hinge: {
                WideBlock<N> block = loadBlock(j, 2);
                solveHinge(j, block, axisRows(j).inverseMass, context, true);
                break;
            }
            case JointKind::fixed: {
                WideBlock<N> block = loadBlock(j, 3);
                solveFixed(j, block, context, true);
                break;
            }
            default:
                solveDistance(j, blockAt(j).basis.cz,
                              axisRows(j).inverseMass, context, true);
                break;
        }
        j.writeVelocities();
    }
}

template <int N>
void relaxJoints(const JointLanesView& view, int begin, int end, const JointPass& pass) {
    const JointContext& context = pass.context;
    for (int i = begin; i < end; ++i) {
        WideJoint<N> j(view, i, pass.arrays);
        j.locate();
        switch (j.bundle.kind) {
            case JointKind::ball:
                relaxBall(j, context);
                break;
            case JointKind::hinge:
                relaxHinge(j, context);
                break;
            case JointKind::fixed:
                relaxFixed(j, context);
                break;
            default:
                relaxDistance(j, context);
                break;
        }
        j.writeVelocities();
        if (j.bundle.breakable && !context.settling) {
            constexpr int kLinear = RAGTOP_JOINT_FIELD(stepImpulse.linear),
                          kAngular = RAGTOP_JOINT_FIELD(stepImpulse.angular);
            const PairVectorOf<Lanes<N>> carried = warmStartImpulse(j);
            j.set(kLinear, j.vector(kLinear) + carried.linear);
            j.set(kAngular, j.vector(kAngular) + carried.angular);
        }
    }
}

template <int N>
constexpr JointKernels makeJointTable(const char* name) {
    return {name, N, loadJoints<N>, storeJoints<N>, warmStartJoints<N>, solveJoints<N>, relaxJoints<N>};
}

}  // namespace
}  // namespace ragtop
