#pragma once

#include "direct/island_system.h"

namespace ragtop::direct {

/// Writes a joint as scalar rows at x + γ h u: what is rigid without bounds, limits with one, motors and friction with
/// two, springs with the resistance that makes them implicit. Adds the stiffness that its tension gives the bodies.
struct JointRowBuilder {
    const BodyArrays& arrays;
    const JointContext& context;
    AlignedArray<SystemRow>& rows;
    SystemBody* bodies;

    void add(JointSim& joint, std::uint32_t index, std::int32_t a, std::int32_t b) const;
};

/// Writes the impulses of rows back to their joints, in the form that sweeps carry.
void storeImpulses(const AlignedArray<SystemRow>& rows, JointSim* const* joints);

}  // namespace ragtop::direct
