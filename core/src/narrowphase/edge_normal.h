#pragma once

#include "narrowphase/manifold.h"
#include "shapes/hull.h"

namespace ragtop {

/// Where two edges lie along each other, as those of leaning cards, every direction between the faces beside them
/// separates the shapes, and that of the face that was clipped to (whose points are given) is the last of them. The
/// middle one is what symmetry asks for. Faces that lie flush on each other keep theirs. `size` is that of the smaller
/// shape.
void turnToMiddle(const HullView& reference, int face, const HullView& incident, float size, Manifold& manifold);

}  // namespace ragtop
