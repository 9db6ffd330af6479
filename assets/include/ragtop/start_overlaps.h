#pragma once

#include <string>
#include <vector>

#include "ragtop/scene.h"

namespace ragtop {

/// Which bodies, cars and ragdolls of a scene begin inside of others, or below fixed meshes and height fields: a line of
/// each, the deepest first, with what it is in and by how much; of each kind at most five, and how many more. What is no
/// deeper than a twentieth of a shape's inner radius counts as lying on; what cannot touch is not looked at.
std::vector<std::string> startOverlaps(const Scene& scene);

}  // namespace ragtop
