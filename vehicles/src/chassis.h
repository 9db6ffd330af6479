#pragma once

#include <cstddef>
#include <string>

#include "ragtop/body.h"
#include "ragtop/vehicle.h"

namespace ragtop {

/// Mass, centre and inertia of the whole car: the shapes scaled to the definition's mass, but for what it says itself.
MassProperties chassisMass(const ChassisDef& def);

/// The body of a car there: its bodywork, and after that its wheels, which give way along their struts.
BodyDef chassisBody(const VehicleDef& def, const VehiclePlacement& placement);

/// Of a shape of that body: the definition's, with at least what dents in bodywork and rubber take of rolling and
/// rocking.
Material shapeMaterial(const VehicleDef& def, std::size_t shape);

/// Names the first number, and the one to keep, by which the shape of `next` is another than that of `now`; empty where
/// they are alike.
std::string whyAnotherShape(const WheelDef& now, const WheelDef& next);

/// Of a wheel whose axle, to the left, is not upright: its x axis, with z level.
Quat wheelRotation(const Vec3& axle);

/// Of a wheel's shape in the chassis, its hub and its axle there, which points to the left.
Frame wheelShapeFrame(const WheelDef& wheel, const Vec3& hub, const Vec3& axle);

}  // namespace ragtop
