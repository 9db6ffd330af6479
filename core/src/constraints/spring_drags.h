#pragma once

/// Springs and dampers whose passes are solved together with everything else, in direct systems.
namespace ragtop {

/// The drags of a row. The first pass is λ₁ = push − moving u₁ with push = −h k C, and u₁ is the mean speed of the
/// substep. The second knows it, λ₂ = push + follows (λ₁ − push) − resting u₂: however neighbours change the speed of
/// either pass, the damper gives −h c times the mean speed. A lone pair has the speeds of springShares.
struct SpringDrags {
    double moving = 0, resting = 0;  ///< N s per m/s
    double follows = 0;
};
/// Up to ωh = 1 moving = (1/q₁ − 1)/w and follows = (1 − q₂)/(1 − q₁), so that the second pass is a force alone. What
/// the stiffness has beyond that is `resting`, as by an implicit step.
SpringDrags springDrags(float stiffness, float damping, float inverseMass, float h);
/// The same speeds of a lone pair by passes that do not know each other, as the iteration has them.
SpringDrags separateDrags(float stiffness, float damping, float inverseMass, float h);

}  // namespace ragtop
