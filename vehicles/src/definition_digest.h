#pragma once

#include <cstdint>

#include "ragtop/body.h"
#include "ragtop/vehicle_def.h"

namespace ragtop {

/// Differs, but for chance, where two cars of as many wheels go different ways from the same state. What a car looks
/// like and is called does not matter, nor do the shapes beyond the `mass` that they give: they are the world's.
std::uint64_t definitionDigest(const VehicleDef& def, const MassProperties& mass, float gravity);

}  // namespace ragtop
