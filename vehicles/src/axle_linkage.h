#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include "linkage_solver.h"
#include "ragtop/vehicle_def.h"
#include "suspension_curves.h"

/// Linkages of a car's axles: which wheels they hold, whether they can, and the curves along which they do.
namespace ragtop {

struct AxleWheels {
    std::size_t left = 0, right = 0;
};
/// Of an axle of two wheels.
AxleWheels axleWheels(const VehicleDef& def, unsigned axle);

/// Empty when the linkage can be assembled wherever its wheels travel and steer; otherwise names the field, its value
/// and what is allowed.
std::string whyInvalid(const VehicleDef& def, const LinkageDef& linkage, std::size_t i);

/// Of a linkage that has wheels.
LinkageSolver linkageSolver(const VehicleDef& def, const LinkageDef& linkage);

/// m of the rack per rad of its wheels; 0 where nothing steers.
double rackPerAngle(const LinkageSolver& solver);

/// Of a usable definition.
struct AxleLinkage {
    AxleWheels wheels;
    LinkageSolver solver;
    bool solid = false;
    float rackTravel = 0;  ///< m per rad of steering
    std::array<SuspensionCurves, 2> curves;
};
std::vector<AxleLinkage> axleLinkages(const VehicleDef& def);

}  // namespace ragtop
