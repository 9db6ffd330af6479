#pragma once

#include <string>

#include "peer.h"

namespace ragtop::stability {

enum class MujocoJoints {
    equalities,  ///< every body is free, and joints are equality constraints
    trees,       ///< bodies are nested in those they hang on; joints that close loops are equality constraints
};

/// The scene as MuJoCo's XML, with Newton's method and elliptic cones. Body i is called "b<i>".
std::string mujocoModel(const Scene& scene, const PeerBodies& bodies, MujocoJoints joints);

}  // namespace ragtop::stability
