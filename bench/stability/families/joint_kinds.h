#pragma once

#include <cmath>
#include <cstddef>
#include <numbers>
#include <span>

#include "../scenery.h"

/// Joints of every kind in random states, for the families that throw them.
namespace ragtop::stability {

inline constexpr float kJointedMass = 1;                     ///< kg
inline constexpr Vec3 kJointedMoments{0.02f, 0.06f, 0.05f};  ///< kg m²

/// A joint with limits, and where within them B begins, as in Place.
struct Drawn {
    JointDef def;
    Quat rotation{};
    Vec3 offset{};
};
/// Where B begins, in A's joint frame.
struct Place {
    Quat rotation{};
    Vec3 offset{};
};
struct JointType {
    const char* name;
    Drawn (*draw)(Dice& dice);
    Place (*anywhere)(Dice& dice) = nullptr;  ///< what fits the joint but not its limits; none: it has no limits
};
std::span<const JointType> jointTypes();

/// A polygon of seven corners about x, 0.2 to 2.2 rad from it, each with a twist range from `twists`.
template <class Twists>
ReachPolygon anyReach(Dice& dice, Twists&& twists) {
    ReachPolygon reach;
    reach.count = 7;
    for (int i = 0; i < reach.count; ++i) {
        const double about = 2 * std::numbers::pi * i / reach.count;
        const double from = static_cast<double>(dice.between(0.2f, 2.2f));
        reach.corners[static_cast<std::size_t>(i)] = {
            toVec3({std::cos(from), std::sin(from) * std::cos(about), std::sin(from) * std::sin(about)}), twists()};
    }
    return reach;
}

/// One joint between two bodies, or the world and one, at any state; bodies move with up to 10 rad/s.
void addJoint(Scene& scene, Dice& dice, const Drawn& drawn, const DVec3& place, bool twoBodies);

struct Family;
/// Motors and springs at the most that they may give, and turns of more than one round.
void addTorqueCases(Family& family);
void addTurnCases(Family& family);

}  // namespace ragtop::stability
