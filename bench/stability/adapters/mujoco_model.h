#pragma once

#include <string>

#include "peer.h"

namespace ragtop::stability {

/// The scene as MuJoCo's XML: every body free, joints as equality constraints, Newton's method with elliptic cones.
/// Body i is called "b<i>".
std::string mujocoModel(const Scene& scene, const PeerBodies& bodies);

}  // namespace ragtop::stability
