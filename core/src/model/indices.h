#pragma once

#include <cstdint>

#include "model/bodies.h"
#include "model/joints.h"
#include "model/shapes.h"

/// What ids name. Throws std::out_of_range where that is nothing; body 0, the world, is nothing to a caller.
namespace ragtop {

std::uint32_t indexOf(const Bodies& bodies, BodyId id);
std::uint32_t indexOf(const Shapes& shapes, ShapeId id);
std::uint32_t indexOf(const Joints& joints, JointId id);
std::uint32_t indexOf(const Couplings& couplings, CouplingId id);

}  // namespace ragtop
