#pragma once

#include <cstdint>
#include <type_traits>

#include "constraints/joint_sim.h"
#include "ragtop/coupling.h"

/// One scalar row across several joints. Along each of them it pushes through the joint's own block, as a motor would,
/// so that no joint opens; what it has given is carried by the coordinates of the joints (AxisRows::coupledImpulse).
namespace ragtop {

/// A coupling in the solver: trivially copyable and without padding.
struct CouplingSim {
    static constexpr int kMost = CouplingDef::kMostParts;
    std::uint32_t count = 0;
    std::uint32_t joints[kMost] = {}, coordinates[kMost] = {};
    float ratios[kMost] = {};
    AxisRows axis;
};
static_assert(std::is_trivially_copyable_v<CouplingSim>);

/// Has a joint of this kind such a coordinate?
bool hasCoordinate(JointKind kind, int coordinate);
/// Does it turn?
bool coordinateTurns(JointKind kind, int coordinate);

/// Takes a definition over and keeps impulses. `joints` are all joints of the world.
void compileCoupling(const CouplingDef& def, JointSim* const* joints, CouplingSim& into);
/// Of each substep, in this order: before the joints are warm started, after that, and in each pass after the joints.
void warmStartCoupling(const CouplingSim& coupling, JointSim* const* joints);
void beginCoupling(CouplingSim& coupling, JointSim* const* joints, BodyState* states, const BodyInertia* inertia,
                   const JointContext& context);
/// After positions have moved, once the joints are refreshed.
void refreshCoupling(CouplingSim& coupling, JointSim* const* joints, const BodyState* states,
                     const BodyInertia* inertia);
void solveCoupling(CouplingSim& coupling, JointSim* const* joints, BodyState* states, const BodyInertia* inertia,
                   const JointContext& context, bool moving);
/// When a coupling begins.
void markCoupled(const CouplingSim& coupling, JointSim* const* joints);
/// Before the couplings of a joint carry to it anew, or when it has none any more.
void clearCoupled(JointSim& joint, bool coupled);
/// `joints`: copies of those of the coupling, in its order, refreshed where their bodies are.
CouplingState couplingState(const CouplingSim& coupling, JointSim* const* joints, const BodyState* states,
                            const BodyInertia* inertia, float inverseSubstep);

}  // namespace ragtop
