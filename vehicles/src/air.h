#pragma once

#include <span>
#include <vector>

#include "ragtop/vehicle_def.h"

namespace ragtop {

/// Where lift acts, from the centre of mass in the chassis.
struct LiftPoint {
    Vec3 arm;                           ///< m
    float area = 0;                     ///< m²
    float restArea = 0, perHeight = 0;  ///< m², with the struts at rest; m²/m
    unsigned axle = 0;                  ///< whose struts
};

/// That of the car, and those of its axles.
std::vector<LiftPoint> liftPoints(const VehicleDef& def, const Vec3& centerOfMass);

/// How a body goes through the air.
struct AirMotion {
    Vec3 velocity;          ///< m/s through the air, world axes
    Quat rotation;          ///< of the chassis
    float inverseMass = 0;  ///< 1/kg
};

/// What the air does in a substep.
struct AirImpulse {
    Vec3 linear, angular;  ///< N s; N m s about the centre of mass
};

/// Over h seconds, with the direction of travel v̂, the car's axes u up and l left, and V = |v|: drag ½ ρ A V v against
/// the way and the side force ½ ρ A_s V (v·l) against the drift, both implicit in the speed so that they never reverse
/// it; lift across the flow, which takes no power: with a = h ½ ρ A V/m it turns v̂ to v̂ + a u, normalized, a (u − (u·v̂)
/// v̂) where a is small and u itself at most; and the moment ½ ρ Y V (v·l) about u. Each lift acts at its point with its
/// share of the whole.
AirImpulse airImpulse(const AerodynamicsDef& air, std::span<const LiftPoint> lifts, const AirMotion& motion, float h);

}  // namespace ragtop
