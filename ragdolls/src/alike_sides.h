#pragma once

#include <span>
#include <vector>

#include "fit.h"

namespace ragtop {

/// A part of one side of the body.
struct SidePart {
    Frame axes{};  ///< where it begins, y along it, in the frame of the points; those of the other side are its image
    FittedShape fitted{};          ///< a capsule, box or hull
    std::span<const Vec3> skin{};  ///< m
};

/// Gives both sides the same shape where that of one, mirrored, does for the other: where it holds `share` of the skin
/// of both and both fits are about as large. The smaller one that does is taken. Else both stay, and it returns false.
bool makeAlike(SidePart& left, SidePart& right, float share);
/// Gives both sides this shape, which is the left's, where it does for both and is about as large as what they have.
bool makeAlike(SidePart& left, SidePart& right, const FittedShape& fitted, float share);

/// Points of one side on the other, across x of the axes.
std::vector<Vec3> mirrored(std::span<const Vec3> points, const Frame& from, const Frame& to);

}  // namespace ragtop
