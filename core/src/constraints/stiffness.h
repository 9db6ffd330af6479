#pragma once

#include "constraints/joint_sim.h"

/// How stiff springs and soft stops are for a substep.
namespace ragtop {

/// z/z₀ of the joint's stiffest spring or soft stop, z = h² k w, and z₀ where the iteration stops to hold it beside
/// neighbours:
///   z₀ = 14 ζ, from 0.03 to 1, of springs; 1 of soft stops, whose trajectory the iteration knows up to there;
/// w is the inverse mass of the relative motion where nothing else holds the bodies, of turns about the axis about
/// which these turn most easily, nearly. 0 where there is none. Springs of more than 1 that have neighbours are to be
/// solved all at once (docs/adr/0038).
float stiffnessOf(const JointSim& joint, const BodyState* states, const BodyInertia* inertia, float h);

}  // namespace ragtop
