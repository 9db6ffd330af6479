#pragma once

#include "model/bodies.h"
#include "model/joints.h"
#include "model/shapes.h"

/// Which shapes meet each other at all, before the game's own filter is asked.
namespace ragtop {

bool filtersAgree(const Filter& a, const Filter& b);
/// By what moves them, their filters, and the joints between their bodies.
bool shouldCollide(const Bodies& bodies, const Shapes& shapes, const Joints& joints, const ShapeRecord& a,
                   const ShapeRecord& b);

}  // namespace ragtop
