// Joints, N at a time: written once, compiled per instruction set. Every kind does what its refresh and solve functions
// in constraints/ do, operation by operation; rows that act in some lanes alone leave the others as they are.

#include <cstdint>

#include "constraints/joint_angle.h"
#include "constraints/joint_constants.h"
#include "solve/joint_kernels.h"
#include "solve/lane_rows.h"
#include "solve/lanes.h"

// In this order: each builds on those before it.
// clang-format off
#include "solve/wide_bodies.inl"
#include "solve/wide_joint_bodies.inl"
#include "solve/wide_joint_springs.inl"
#include "solve/wide_joint_rows.inl"
#include "solve/wide_joint_ball.inl"
#include "solve/wide_joint_blocks.inl"
#include "solve/wide_joint_copies.inl"
// clang-format on

namespace ragtop {
namespace {

/// As warmStartImpulse.
template <int N>
struct WideImpulse {
    WideVec3<N> linear, angular;
};
template <int N>
RAGTOP_INLINE WideImpulse<N> warmStartImpulse(const WideJoint<N>& j) {
    const Lanes<N> zero(0.0f);
    WideImpulse<N> sum{j.vector(RAGTOP_JOINT_FIELD(block.impulseFirst)),
                       j.vector(RAGTOP_JOINT_FIELD(block.impulseSecond))};
    const JointKind kind = j.bundle.kind;
    if (kind == JointKind::ball) {
        sum.angular = sum.angular + (j.bundle.features != 0 ? turningImpulse(j) : nothing<N>());
    } else if (kind == JointKind::hinge) {
        const Lanes<N> amount = j.bundle.features != 0 ? axisImpulse(j) : zero;
        sum.angular = sum.angular + amount * j.vector(RAGTOP_JOINT_FIELD(block.basis.cz));
    } else if (kind == JointKind::distance) {
        sum.linear = sum.linear + axisImpulse(j) * j.vector(RAGTOP_JOINT_FIELD(block.basis.cz));
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
                storeFixed(j, refreshFixed(j));
                break;
            default:
                beginDistance(j, pass.context);
                break;
        }
        const WideImpulse<N> carried = warmStartImpulse(j);
        j.apply(carried.linear, carried.angular);
        j.writeVelocities();
    }
}

template <int N>
void solveJoints(const JointLanesView& view, int begin, int end, const JointPass& pass) {
    const JointContext& context = pass.context;
    for (int i = begin; i < end; ++i) {
        WideJoint<N> j(view, i, pass.arrays);
        j.loadArms();
        switch (j.bundle.kind) {
            case JointKind::ball:
                solveBall(j, loadBall(j), loadTurns(j), context, true);
                break;
            case JointKind::hinge:
                solveHinge(j, loadHinge(j), j.at(RAGTOP_JOINT_FIELD(axis.inverseMass)), context, true);
                break;
            case JointKind::fixed:
                solveFixed(j, loadFixed(j), context, true);
                break;
            default:
                j.gap = j.vector(RAGTOP_JOINT_FIELD(block.errorFirst));
                solveDistance(j, j.vector(RAGTOP_JOINT_FIELD(block.basis.cz)),
                              j.at(RAGTOP_JOINT_FIELD(axis.inverseMass)), context, true);
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
        if (j.bundle.breakable) {
            constexpr int kLinear = RAGTOP_JOINT_FIELD(stepImpulse.linear),
                          kAngular = RAGTOP_JOINT_FIELD(stepImpulse.angular);
            const WideImpulse<N> carried = warmStartImpulse(j);
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
