#pragma once

#include "model/bodies.h"
#include "model/joints.h"

/// The part of couplings in a step. They are few, act on up to eight bodies at once and are therefore solved one after
/// the other, after the joints and contacts of all colours.
namespace ragtop {

/// Lists those whose joints are iterated; their loads are of substeps that are `ratio` times as long as those before.
void prepareCouplings(Couplings& couplings, const Joints& joints, float ratio);
void warmStartCouplings(Couplings& couplings, Joints& joints);
void beginCouplings(Couplings& couplings, Joints& joints, Bodies& bodies, const JointContext& context);
/// A push along one joint may open another that shares a body with it: so these are solved in turn.
void solveCouplings(Couplings& couplings, Joints& joints, Bodies& bodies, const JointContext& context, bool moving);

}  // namespace ragtop
