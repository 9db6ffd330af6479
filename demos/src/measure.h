#pragma once

#include <vector>

#include "ragtop/scene.h"
#include "ragtop/world.h"

namespace ragtop::demos {

/// Overlaps of all pairs of shapes that may collide, m, sorted upwards; measured by the program, not by the solver.
std::vector<double> overlaps(const World& world, const Scene& scene, const SceneInstance& instance);
/// The value that the share `q` of the sorted values does not exceed; 0 when there are none.
double quantile(const std::vector<double>& sorted, double q);

/// The largest distance between two points that a joint should hold together (or to the range it allows), m.
double largestJointGap(const World& world);
/// How far the masonry farthest from its place has moved, m.
double largestDisplacement(const World& world, const Scene& scene, const SceneInstance& instance);
/// The speed of the fastest body, m/s.
double largestSpeed(const World& world);
bool allFinite(const World& world);
/// Of the points of cloths, which the world does not list.
bool allFinite(const SceneInstance& instance);

}  // namespace ragtop::demos
