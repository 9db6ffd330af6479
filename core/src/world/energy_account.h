#pragma once

#include <span>

#include "world/energy_guard.h"

/// What bodies had when a step began, what they have now and what forces gave them in between.
namespace ragtop {

/// J, of the motion of all as they are turned now.
double kineticNow(const GuardView& view, std::span<const std::uint32_t> group);
/// J, kinetic at most, of an account's sums.
double lawfulOf(const EnergyAccount& account);
EnergyAccount accountOf(const GuardView& view, std::span<const std::uint32_t> group);
/// What a group has left of its room after a step, as a share.
void keepRoom(float& room, double left, double most);
/// True where a group has gained no more than it has room for, which is noted. What a module has pushed is not looked
/// at.
bool fits(float& room, float& owed, const EnergyAccount& account);
/// What is dissipated refills the room first, then pays what is owed; all in J.
void pay(double& left, double most, double& owed, double paid);

}  // namespace ragtop
