#pragma once

#include <span>

#include "ragtop/math.h"
#include "ragtop/shape.h"

namespace ragtop {

/// A shape and where it is.
struct FittedShape {
    Shape shape;
    Frame frame;  ///< in the frame of the points
};

/// The capsule along `axis` (unit) of least volume among a few, that holds at least `share` of the points.
FittedShape fitCapsule(std::span<const Vec3> points, const Vec3& axis, float share);
/// The box with the axes of `rotation` that leaves out the outermost points evenly and holds at least `share`.
FittedShape fitBox(std::span<const Vec3> points, const Quat& rotation, float share);
/// A capsule along the y axis of `rotation`, or the box where the capsule has more than `roundness` times its volume.
FittedShape fitShape(std::span<const Vec3> points, const Quat& rotation, float share, float roundness);

/// m, of the lowest point of a shape along `up` (unit).
float bottomOf(const FittedShape& fitted, const Vec3& up);
/// The shape without what is lower than `floor` along `up`: a capsule becomes shorter from its lower end, then thinner;
/// a box loses size along its steepest axis first; a hull is cut. No size gets below `least`.
FittedShape keptAbove(FittedShape fitted, const Vec3& up, float floor, float least);

/// Number of points in the shape (a capsule, box or hull), its surface included up to rounding.
int countInside(const FittedShape& fitted, std::span<const Vec3> points);

/// A capsule of the given volume (m³) from `start` to `end`; shorter than that when the volume is too little for it.
FittedShape capsuleBetween(const Vec3& start, const Vec3& end, float volume);

/// Whether two shapes touch, each thickened by `margin`. Errs towards yes for boxes and hulls.
bool mayOverlap(const FittedShape& a, const FittedShape& b, float margin);

}  // namespace ragtop
