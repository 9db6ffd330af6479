#pragma once

#include "constraints/joint_sim.h"

/// What springs, and soft stops that are pressed, hold.
namespace ragtop {

/// Does a joint have any whose energy is counted? Those of joints of more axes are not.
bool storesEnergy(const JointSim& joint);
/// J, where the bodies are; of a spring with a bound, what it takes to bring it there.
double storedEnergy(const JointSim& joint, const JointBodiesAtStep& bodies);

}  // namespace ragtop
