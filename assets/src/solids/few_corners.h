#pragma once

#include "solids/point_hull.h"

namespace ragtop {

/// A hull of at most so many corners that holds another one, and is little larger.
PointHull withFewCorners(const PointHull& hull, std::size_t most);

/// About by how much a hull of that volume and so many corners grows where it has to have fewer.
double airOfFewCorners(double volume, std::size_t corners, std::size_t most);

/// The hull of a hull and points, but for those that are less than 2e-5 outside of it.
PointHull holding(PointHull hull, std::vector<DVec3> points);

}  // namespace ragtop
