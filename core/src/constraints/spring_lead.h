#pragma once

#include "constraints/joint_sim.h"

/// Springs push before each motion by what they push where it begins (springShares), so that rows know the speed of
/// half a substep before the place. Between steps bodies have the speed of their place: when a step ends, joints lead
/// it by
///   β (−h k C + Λ),  β = ½ of an undamped spring and less of a damped one,
/// with C the displacement (feed-forward beside it) and Λ what else pushes along it in a substep, and take that back
/// when the next one begins. At rest under whatever load it is nothing. Soft stops lead alike while they are pressed
/// (soft_stops.h). Substeps do not know of it.
namespace ragtop {

/// Of a joint's bodies, what forces and torques from outside give in a substep: m/s and rad/s.
struct BodyKicks {
    Vec3 vA, wA, vB, wB;
};

bool hasSprings(const JointSim& joint);
/// Does it have springs, or soft stops, which are springs while they are pressed?
bool leads(const JointSim& joint);
/// Before the first substep, the joint prepared: from the speeds of bodies to those of rows.
void beginLead(JointSim& joint, BodyState* states, const BodyInertia* inertia, const BodyKicks& kicks, float h);
/// After the last one: from those of rows to those of bodies.
void endLead(JointSim& joint, BodyState* states, const BodyInertia* inertia, const BodyKicks& kicks, float h);

/// β of a spring along a coordinate of so much inverse mass.
float leadShare(float stiffness, float damping, float inverseMass, float h);

}  // namespace ragtop
