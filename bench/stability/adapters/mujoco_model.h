#pragma once

#include <string>

#include "peer.h"

namespace ragtop::stability {

/// The scene as MuJoCo's XML, with Newton's method. Body i is called "b<i>".
std::string mujocoModel(const Scene& scene, const PeerBodies& bodies, const MujocoOptions& options);

}  // namespace ragtop::stability
