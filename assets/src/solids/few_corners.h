#pragma once

#include "solids/point_hull.h"

namespace ragtop {

/// A hull of at most so many corners that holds another one, and is little larger.
PointHull withFewCorners(const PointHull& hull, std::size_t most);

}  // namespace ragtop
