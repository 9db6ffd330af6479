#pragma once

#include <cstdint>

#include "model/bodies.h"
#include "model/shapes.h"
#include "ragtop/world.h"

/// What the surfaces of two shapes do to each other.
namespace ragtop {

/// Of a pair of shapes, where A's triangle is touched if it has any; without the game's callback.
ContactSurface surfaceOf(const Bodies& bodies, const Shapes& shapes, std::uint32_t shapeA, std::uint32_t shapeB,
                         std::uint32_t triangle);
/// What callbacks are asked about.
PairInfo pairInfo(const Bodies& bodies, const Shapes& shapes, std::uint32_t shapeA, std::uint32_t shapeB);
/// A round surface turns under its contact point, and is cheap to collide.
bool turnsUnderContact(const Shapes& shapes, const ContactRecord& contact);

}  // namespace ragtop
