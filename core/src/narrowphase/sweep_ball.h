#pragma once

#include "narrowphase/distance.h"

namespace ragtop {

/// A ball that does not touch a triangle goes along `translation`, up to the share `closer` of it: where it first meets
/// the face, an edge or a corner, in closed form [Ericson 2005, section 5.5.6]. From both sides, as `sweep`.
SweepHit sweepBall(const TriangleView& triangle, const Vec3& center, float radius, const Vec3& translation,
                   float closer);

}  // namespace ragtop
