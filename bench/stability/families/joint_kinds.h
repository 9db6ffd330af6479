#pragma once

#include <span>

#include "../scenery.h"

/// Joints of every kind in random states, for the families that throw them.
namespace ragtop::stability {

inline constexpr float kJointedMass = 1;                     ///< kg
inline constexpr Vec3 kJointedMoments{0.02f, 0.06f, 0.05f};  ///< kg m²

/// A joint with limits, and where within them B begins, in A's joint frame.
struct Drawn {
    JointDef def;
    Quat rotation{};
    Vec3 offset{};
};
struct JointType {
    const char* name;
    Drawn (*draw)(Dice& dice);
};
std::span<const JointType> jointTypes();

/// One joint between two bodies, or the world and one, at any state; bodies move with up to 10 rad/s.
void addJoint(Scene& scene, Dice& dice, const Drawn& drawn, const DVec3& place, bool twoBodies);

}  // namespace ragtop::stability
