#pragma once

#include <array>
#include <optional>
#include <vector>

#include "ragtop/math.h"
#include "ragtop/tunables.h"

/// How wheels hang on their car: the hardpoints of suspensions, m, in the frame of the chassis, with the car standing.
/// Points are those of the left wheel; the right one has them mirrored at x = 0. Rods and arms do not stretch, and turn
/// without friction. `...Ball` is where an arm meets the upright, which carries the wheel.
namespace ragtop {

/// Two arms, each from an axis in the chassis to a ball in the upright.
struct DoubleWishboneDef {
    Vec3 lowerFront{}, lowerRear{}, lowerBall{};
    Vec3 upperFront{}, upperRear{}, upperBall{};
};

/// One arm, and a strut that is fixed to the upright and slides through a ball in the chassis.
struct McPhersonDef {
    Vec3 lowerFront{}, lowerRear{}, lowerBall{};
    Vec3 strutTop{};   ///< in the chassis
    Vec3 strutFoot{};  ///< in the upright, another point of the strut's axis
};

/// The upright is an arm that turns about an axis of the chassis: trailing, semi-trailing, or a swing axle.
struct TrailingArmDef {
    Vec3 inner{}, outer{};  ///< points of the axis
};

/// A rod with a ball at each end.
struct RodDef {
    Vec3 chassis{}, carrier{};
};

/// One beam for both wheels, on four rods, none of them mirrored.
struct SolidAxleDef {
    std::vector<RodDef> rods{};
};

/// Steers an upright: from the rack of a wheel that steers, else from the chassis.
struct TieRodDef {
    Vec3 inner{}, outer{};
};

/// A suspension: one of its four kinds. It takes the place of SuspensionDef::axis.
struct LinkageDef {
    unsigned axle = 0;  ///< WheelDef::axle, of two wheels that mirror each other
    std::optional<DoubleWishboneDef> doubleWishbone{};
    std::optional<McPhersonDef> mcPherson{};
    std::optional<TrailingArmDef> trailingArm{};
    std::optional<SolidAxleDef> solidAxle{};
    std::optional<TieRodDef> tieRod{};  ///< of wishbones and McPherson struts
    /// Ends of spring and damper; empty: they act as if at the hub, upwards. SuspensionDef says what they do at the
    /// wheel of the standing car; elsewhere that goes with the motion ratio.
    std::optional<RodDef> spring{};
    float camber = 0;  ///< rad, of the standing wheels; positive with their tops apart
    float toe = 0;     ///< rad, of the standing wheels; positive where they look to each other
    float mass = 12;   ///< kg that move with each wheel besides it; part of the chassis's mass
};

/// What a file must say.
constexpr std::array<const char*, 6> requiredFields(const DoubleWishboneDef*) {
    return {"lowerFront", "lowerRear", "lowerBall", "upperFront", "upperRear", "upperBall"};
}
constexpr std::array<const char*, 5> requiredFields(const McPhersonDef*) {
    return {"lowerFront", "lowerRear", "lowerBall", "strutTop", "strutFoot"};
}
constexpr std::array<const char*, 2> requiredFields(const TrailingArmDef*) { return {"inner", "outer"}; }
constexpr std::array<const char*, 2> requiredFields(const RodDef*) { return {"chassis", "carrier"}; }
constexpr std::array<const char*, 1> requiredFields(const SolidAxleDef*) { return {"rods"}; }
constexpr std::array<const char*, 2> requiredFields(const TieRodDef*) { return {"inner", "outer"}; }
constexpr std::array<const char*, 1> requiredFields(const LinkageDef*) { return {"axle"}; }

inline constexpr double kFarthestPoint = 1e4;  ///< m, of a hardpoint from the origin of the chassis, as of wheels

constexpr Tunable hardpoint(const char* name, const char* meaning) {
    return {name, "m", -kFarthestPoint, kFarthestPoint, meaning};
}

template <class Visitor, class Self>
void describe(Visitor& visit, Self& self, const DoubleWishboneDef*) {
    visit(hardpoint("lowerFront", "of the lower arm's axis in the chassis"), self.lowerFront);
    visit(hardpoint("lowerRear", "another point of that axis"), self.lowerRear);
    visit(hardpoint("lowerBall", "of the lower arm in the upright"), self.lowerBall);
    visit(hardpoint("upperFront", "of the upper arm's axis in the chassis"), self.upperFront);
    visit(hardpoint("upperRear", "another point of that axis"), self.upperRear);
    visit(hardpoint("upperBall", "of the upper arm in the upright"), self.upperBall);
}
template <class Visitor, class Self>
void describe(Visitor& visit, Self& self, const McPhersonDef*) {
    visit(hardpoint("lowerFront", "of the lower arm's axis in the chassis"), self.lowerFront);
    visit(hardpoint("lowerRear", "another point of that axis"), self.lowerRear);
    visit(hardpoint("lowerBall", "of the lower arm in the upright"), self.lowerBall);
    visit(hardpoint("strutTop", "ball in the chassis through which the strut slides"), self.strutTop);
    visit(hardpoint("strutFoot", "in the upright, on the axis of the strut"), self.strutFoot);
}
template <class Visitor, class Self>
void describe(Visitor& visit, Self& self, const TrailingArmDef*) {
    visit(hardpoint("inner", "of the axis about which the arm turns"), self.inner);
    visit(hardpoint("outer", "another point of that axis"), self.outer);
}
template <class Visitor, class Self>
void describe(Visitor& visit, Self& self, const RodDef*) {
    visit(hardpoint("chassis", "end in the chassis"), self.chassis);
    visit(hardpoint("carrier", "end that goes with the wheel"), self.carrier);
}
template <class Visitor, class Self>
void describe(Visitor& visit, Self& self, const SolidAxleDef*) {
    visit(Tunable{"rods", "", 0, 0, "four, that hold the beam but for rise and roll"}, self.rods);
}
template <class Visitor, class Self>
void describe(Visitor& visit, Self& self, const TieRodDef*) {
    visit(hardpoint("inner", "at the rack, or in the chassis"), self.inner);
    visit(hardpoint("outer", "in the upright"), self.outer);
}
template <class Visitor, class Self>
void describe(Visitor& visit, Self& self, const LinkageDef*) {
    visit(Tunable{"axle", "", 0, 255, "of two wheels that mirror each other"}, self.axle);
    visit(Tunable{"doubleWishbone", "", 0, 0, "two arms"}, self.doubleWishbone);
    visit(Tunable{"mcPherson", "", 0, 0, "an arm, and a strut that guides the upright"}, self.mcPherson);
    visit(Tunable{"trailingArm", "", 0, 0, "an arm about one axis"}, self.trailingArm);
    visit(Tunable{"solidAxle", "", 0, 0, "one beam for both wheels"}, self.solidAxle);
    visit(Tunable{"tieRod", "", 0, 0, "steers the upright"}, self.tieRod);
    visit(Tunable{"spring", "", 0, 0, "ends of spring and damper; absent: at the hub, upwards"}, self.spring);
    visit(Tunable{"camber", "rad", -0.5, 0.5, "of the standing wheels; positive with their tops apart"}, self.camber);
    visit(Tunable{"toe", "rad", -0.5, 0.5, "of the standing wheels; positive where they look to each other"}, self.toe);
    visit(Tunable{"mass", "kg", 1e-4, 1e8, "of what moves with each wheel besides it"}, self.mass);
}

}  // namespace ragtop
