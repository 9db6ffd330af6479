#pragma once

#include <optional>
#include <string>
#include <vector>

#include "axle_linkage.h"
#include "ragtop/id.h"
#include "ragtop/shape.h"

/// Bodies of level 3: what carries the wheels, and the joints of the world that hold it.
namespace ragtop {

class World;

/// A wheel on its carrier, in the carrier's frame.
struct CarriedWheel {
    std::size_t wheel = 0;  ///< of the definition
    Vec3 hub, axle;         ///< unit, to the left
};

/// A rigid body that holds a wheel, or both of a beam. Its frame has its origin in the middle of its wheels, and the
/// axes of the chassis where the car stands.
struct CarrierSpec {
    std::size_t linkage = 0;  ///< of the definition
    bool mirrored = false;    ///< of the right wheel
    Vec3 middle;              ///< of the standing car, in the chassis
    MassProperties mass;      ///< in its frame, without what turns of its wheels
    std::vector<CarriedWheel> wheels;
    bool sprung = false;          ///< has a spring of its own; else springs are at the hubs, upwards
    Vec3 springTop, springFoot;   ///< its ends: in the chassis, in the carrier
    float springLength = 0;       ///< m, of the standing car
    float motionRatio = 1;        ///< LinkageSolver::motionRatio
    std::optional<Vec3> rackEnd;  ///< in the chassis: inner end of a tie rod that a rack moves
};
std::vector<CarrierSpec> makeCarrierSpecs(const VehicleDef& def);

/// What is left of a car for its body. Not above zero where carriers are heavier than it.
MassProperties bodyworkMass(const MassProperties& whole, const std::vector<CarrierSpec>& carriers);

/// Empty when the car can be at level 3; otherwise names the field, its value and what is allowed.
std::string whyNoCarriers(const VehicleDef& def);

/// A carrier in its world. Saved as it is: no padding.
struct Carrier {
    BodyId body;     ///< null below level 3
    JointId tieRod;  ///< that a rack moves; null where there is none
    float rack = 0;  ///< m to the left, of that joint
};
static_assert(sizeof(Carrier) == 20);

/// Makes its body, with that shape, which nothing meets, and its joints to the chassis.
Carrier makeCarrier(World& world, BodyId chassis, const CarrierSpec& spec, const LinkageSolver& solver,
                    const Shape& shape, const Pose& pose);
/// Moves its rack.
void steerCarrier(World& world, const CarrierSpec& spec, Carrier& carrier, float rack);

/// Of the right side from the left one's.
inline Vec3 mirrored(const Vec3& point) { return {-point.x, point.y, point.z}; }
inline Vec3 mirroredTurn(const Vec3& turn) { return {turn.x, -turn.y, -turn.z}; }

}  // namespace ragtop
