#pragma once

#include <cstddef>
#include <functional>

#include "fit.h"

namespace ragtop {

/// A foot that holds at least `share` of the points and stands on a rectangle: z of `rotation` is out of the ground, y
/// towards the toes. Over the sole it is a hull of few corners, or a box where that has little more volume.
FittedShape fitFoot(std::span<const Vec3> points, const Quat& rotation, float share);

using FitShape = std::function<FittedShape(std::span<const Vec3>, float share)>;

/// How many points of two kinds a shape may leave out.
struct LeftOut {
    float own = 0, rest = 0;
};

/// A shape that `fit` makes about points of two kinds, the first `own` of them and the others. What it leaves out of
/// either goes with what it may leave out of all, as a rule, which tells how much to ask.
FittedShape fitBoth(std::span<const Vec3> points, std::size_t own, const LeftOut& allowed, const FitShape& fit);

}  // namespace ragtop
