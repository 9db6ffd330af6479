#pragma once

#include <cstdint>

#include "ragtop/math.h"

namespace ragtop {

struct WorldImpl;

/// Puts a shape to a frame in its body's internal frame (World::setFrame).
void moveShape(WorldImpl& world, std::uint32_t shape, const Frame& frame);

}  // namespace ragtop
