#pragma once

#include <span>

#include "ragtop/body_pose.h"

namespace ragtop {

/// An upper arm that points along a unit vector in the axes of the chest, as far as shoulders go.
PartAngles pointing(BodySide side, const Vec3& along);
/// rad, at least `least`, by which arms that are held as in `arms` stand off for none of their shapes to be nearer to
/// any other that it collides with than `gap` (m); what is in the way of all arms is not heeded.
float armsApart(const BodyAxes& axes, std::span<const PartAngles> arms, float least, float gap);

}  // namespace ragtop
