#pragma once

#include "world/joint_closing.h"

/// Continuous collision takes single bodies back to what they meet, after the step has been accounted for. What springs
/// between them and the rest of their group hold then is paid: the group goes a share of its step that its energy is
/// enough for, ever smaller down to none, and what is still too much is taken from its motion.
namespace ragtop {

/// Before bodies are swept: notes what groups with springs have of which one is to be.
void noteEnergyToSweep(const ClosingView& world);
/// When they have been.
void payForSweeps(const ClosingView& world);

}  // namespace ragtop
