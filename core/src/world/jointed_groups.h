#pragma once

#include <cstdint>

namespace ragtop {

class Bodies;
struct EnergyGuard;
struct GuardView;

/// Groups the bodies that joints hold together through bodies that move, and tells how closely the energy of each group
/// can be watched: EnergyGuard's starts, bodies and watched. Does so anew only where joints, the bodies that are awake
/// or direct islands have changed.
void findGroups(const GuardView& view);
/// Do two bodies belong to one group of those that are awake?
bool areGrouped(const Bodies& bodies, const EnergyGuard& guard, std::uint32_t a, std::uint32_t b);

}  // namespace ragtop
