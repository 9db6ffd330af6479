#pragma once

#include <vector>

#include "fit.h"

namespace ragtop {

/// A part of one side of the body.
struct SidePart {
    Frame axes{};  ///< where it begins, y along it, in the frame of the points; those of the other side are its image
    FittedShape fitted{};      ///< a capsule or a box
    std::vector<Vec3> skin{};  ///< m
};

/// Gives both sides the same shape where that of one, mirrored, does for the other: where it holds `share` of the skin
/// of both and both fits are about as large. The smaller one that does is taken. Else both stay, and it returns false.
bool makeAlike(SidePart& left, SidePart& right, float share);

}  // namespace ragtop
