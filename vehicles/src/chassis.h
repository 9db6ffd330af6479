#pragma once

#include "ragtop/body.h"
#include "ragtop/vehicle.h"

namespace ragtop {

/// Mass, centre and inertia of a chassis, in its frame: those of its shapes at even density, scaled to its mass, unless
/// the definition says otherwise.
MassProperties chassisMass(const ChassisDef& def);
BodyDef chassisBody(const VehicleDef& def, const VehiclePlacement& placement);

}  // namespace ragtop
