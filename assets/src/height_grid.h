#pragma once

#include <vector>

#include "ragtop/shape.h"
#include "ragtop/tunables.h"

namespace ragtop {

/// A height field as a file holds it: rows of heights along x, one row per z. With `smooth` above one each cell is
/// divided that many times by cubic curves through the heights, so that a few numbers make rolling hills.
struct HeightGrid {
    float spacing = 1;                        ///< m, between the heights of the file
    unsigned smooth = 1;
    std::vector<std::vector<float>> heights;  ///< m
};

template <class Visitor, class Self>
void describe(Visitor& visit, Self& self, const HeightGrid*) {
    visit(Tunable{"spacing", "m", 1e-3, 1e4, "distance between neighbouring heights"}, self.spacing);
    visit(Tunable{"smooth", "", 1, 64, "parts that each cell is divided into by cubic curves"}, self.smooth);
    visit(Tunable{"heights", "m", -1e5, 1e5, "rows of heights along x, one row per z"}, self.heights);
}

/// Throws std::invalid_argument where the rows differ in length or are too few.
HeightField heightFieldOf(const HeightGrid& grid);
HeightGrid gridOf(const HeightField& field);

}  // namespace ragtop
