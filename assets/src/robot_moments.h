#pragma once

#include <array>
#include <string>
#include <vector>

#include "ragtop/shape.h"

namespace ragtop {

/// kg m²: xx, yy, zz, xy, xz, yz.
using Moments = std::array<double, 6>;

/// What is wrong with moments about a centre: they turn backwards about some axis. Those of a rod or a point do not.
std::string whyNoInertia(const Moments& moments);

/// Have the moments of a body no resistance to turning about some axis, so that it cannot move?
bool isThin(const MassProperties& mass);

/// The same mass with moments that can be turned: a thousandth of the largest more about each axis, or, where there are
/// none, those of the shapes of the body, or else of a ball of water.
struct Thickened {
    MassProperties mass;
    std::string as;  ///< what it is now like
};
Thickened thickened(const MassProperties& mass, const std::vector<ShapeDef>& shapes);

}  // namespace ragtop
