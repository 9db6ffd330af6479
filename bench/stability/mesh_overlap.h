#pragma once

#include <vector>

#include "trial.h"

namespace ragtop::stability {

/// How deep (m) points of the surfaces of bodies, corners and places along edges, lie inside other bodies, one number
/// for each pair of bodies that overlap: the deepest of the pair. Found apart from the engines, by the solid angle that
/// a surface takes up and the distance from all its triangles. Round shapes and compounds of them count by their parts.
std::vector<double> overlapsOf(const Run& run, int first);

}  // namespace ragtop::stability
