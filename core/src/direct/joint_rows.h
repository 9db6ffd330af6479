#pragma once

#include "direct/island_system.h"

namespace ragtop::direct {

/// Writes a joint as scalar rows: what is rigid without bounds, limits with one, motors and friction with two, springs
/// with the resistance that makes them implicit. Adds the stiffness that its tension gives the bodies.
///
/// Velocities stand half a substep beside positions, so forces that keep the energy of a swing pull along the Jacobian
/// of the substep's beginning, J(x)ᵀ λ, while errors are to vanish at its end [SHAKE; Ryckaert, Ciccotti, Berendsen,
/// 1977]:
///   C(x + h u) ≈ C(x + h u_free) + h J (u − u_free).
/// The stiffness of tension keeps energy with γ = ¼ (mean acceleration) and damps what is far too fast for the step
/// with γ = ½, which long taut chains need.
struct JointRowBuilder {
    const BodyArrays& arrays;
    const JointContext& context;
    AlignedArray<SystemPair>& pairs;
    AlignedArray<SystemRow>& rows;
    SystemBody* bodies;
    bool begins;  ///< for the first time in the substep
    RowAims aims = RowAims::substep;
    bool touches = false;  ///< contacts are solved beside; passes of springs then do not know each other

    void add(JointSim& joint, std::uint32_t index, std::int32_t a, std::int32_t b) const;
};

/// The row of a contact point beside which joints are closed, which pushes alone.
SystemRow closingRow(const ClosingPoint& point, const SystemPair& pair, const SystemBody* bodies);

/// Writes the impulses of rows back to their joints, in the form that the iteration keeps.
void storeImpulses(const AlignedArray<SystemRow>& rows, JointSim* const* joints);

}  // namespace ragtop::direct
