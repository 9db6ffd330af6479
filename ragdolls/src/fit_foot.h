#pragma once

#include "fit.h"

namespace ragtop {

/// A foot that holds at least `share` of the points and stands on a rectangle: z of `rotation` is out of the ground, y
/// towards the toes. Over the sole it is a hull of few corners, or a box where that has little more volume.
FittedShape fitFoot(std::span<const Vec3> points, const Quat& rotation, float share);

}  // namespace ragtop
