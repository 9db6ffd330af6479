#pragma once

#include <vector>

#include "ragtop/ragdoll.h"

namespace ragtop {

/// Of a hull its own, of any other shape those of the box about it; in the bone of the part.
std::vector<Vec3> cornersOf(const RagdollPart& part);
/// The four of the rectangle about what a box or hull has lowest along `down` (unit, in the bone), along two axes of
/// the shape; none of other shapes.
std::vector<Vec3> soleCorners(const RagdollPart& part, const Vec3& down);

}  // namespace ragtop
