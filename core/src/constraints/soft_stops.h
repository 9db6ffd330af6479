#pragma once

#include <cstdint>

#include "constraints/joint_sim.h"

/// What holds the margins of a joint as a spring does.
namespace ragtop {

inline bool hasSoftStops(const AxisRows& axis) {
    return axis.stop.stiffness > 0 && (axis.features & AxisRows::kLimit) != 0 && axis.inverseMass > 0;
}

/// Calls visit(axis, row) for the coordinates that have rows of their own, with the direction that each moves along.
template <class Joint, class Visit>
void eachAxis(Joint& joint, Visit&& visit) {
    if (hasAxes(joint.kind)) {
        auto& axes = withAxes(joint).axes;
        for (std::uint32_t f = 0; f < axes.freeRows; ++f) visit(axes.axis[f], axes.free[f]);
    } else if (joint.kind == JointKind::hinge) {
        visit(joint.axis, PairVector{{}, joint.block.basis.cz});
    } else if (joint.kind == JointKind::slider || joint.kind == JointKind::distance) {
        visit(joint.axis, PairVector{joint.block.basis.cz, {}});
    }
}
/// Calls visit(side, axis) for the sides that a ball has, with what the margin's rate is the speed about.
template <class Rows, class Visit>
void eachSide(Rows& rows, Visit&& visit) {
    if (rows.features & BallRows::kTwist) {
        visit(rows.twistLower, rows.lowerTwistAxis());
        visit(rows.twistUpper, rows.upperTwistAxis());
    }
    for (int i = 0; i < sidesOf(rows.swingLimit.shape); ++i) visit(rows.swing[i], rows.swingAxis[i]);
}

/// The impulse on the pair that has this amount along one of the coordinates of `eachAxis`; nothing of it is carried
/// over.
PairVector impulseAlong(JointSim& joint, std::uint32_t coordinate, float amount);

/// Does any margin have a soft stop to hold it, and no spring beside that?
bool hasSoftStops(const JointSim& joint);
/// What soft stops that are pressed lead by when a step ends (spring_lead.h), margins and masses known; `kick` is what
/// acts from outside in a substep.
PairVector leadStops(JointSim& joint, const BodyPair& pair, const PairVector& kick, float h);

}  // namespace ragtop
