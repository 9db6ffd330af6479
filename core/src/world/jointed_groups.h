#pragma once

namespace ragtop {

struct GuardView;

/// Groups the bodies that joints hold together through bodies that move, and tells how closely the energy of each group
/// can be watched: EnergyGuard's starts, bodies and watched. Does so anew only where joints, the bodies that are awake
/// or direct islands have changed.
void findGroups(const GuardView& view);

}  // namespace ragtop
