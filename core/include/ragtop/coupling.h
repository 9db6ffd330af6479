#pragma once

#include <array>
#include <cstdint>
#include <string>

#include "ragtop/id.h"
#include "ragtop/joint_parts.h"
#include "ragtop/tunables.h"

/// Couplings between joints: gears, racks, pulleys, differentials, tendons. A coupling acts along one coordinate, the
/// sum of coordinates of joints times their ratios, and pushes each joint between its own two bodies, so that whatever
/// carries the joints feels its share.
namespace ragtop {

/// One of the coordinates that World::state tells of a joint.
struct CoupledCoordinate {
    JointId joint{};
    int coordinate = 0;  ///< which: 0 is `coordinate`, 1 `second`, 2 `third`; 3 to 5 the travels of a SixDofDef
    float ratio = 1;     ///< in the sum; not zero
};

/// Hinge, slider, distance, cylindrical, universal, plane, screw, path and six-degree-of-freedom joints have
/// coordinates to couple. Those that turn count all their turns.
struct CouplingDef {
    static constexpr int kMostParts = 4;
    int count = 0;  ///< 1 to 4
    std::array<CoupledCoordinate, kMostParts> parts{};
    /// What acts along the sum: a limit with equal ends makes gears of it, a range or a spring a tendon. In the unit of
    /// the coordinates times their ratios.
    AxisDef sum{};
    std::uint64_t userData = 0;
};

/// `driven` turns `ratio` times as far as `driver`: minus the teeth of the driver over those of the driven wheel where
/// two wheels mesh outside. From where both are zero.
CouplingDef gear(JointId driver, JointId driven, float ratio);
/// The slider `rack` travels `radius` (m, above zero or below) per radian of the hinge `pinion`.
CouplingDef rackAndPinion(JointId pinion, JointId rack, float radius);
/// A rope from one body over pulleys to another: a + ratio · b stays up to `length`, m, where `a` and `b` are distance
/// joints, without limits of their own, from a pulley to what hangs from it. `ratio` is the number of strands that
/// carry b over those that carry a.
CouplingDef pulley(JointId a, JointId b, float length, float ratio = 1);

template <class Visitor, class Self>
void describe(Visitor& visit, Self& self, const CoupledCoordinate*) {
    visit(Tunable{"coordinate", "", 0, 5, "which coordinate of the joint"}, self.coordinate);
    visit(Tunable{"ratio", "", -1e6, 1e6, "how often it counts in the sum"}, self.ratio);
}

/// Empty when the definition is usable, its joints aside; otherwise names the field, its value and what is allowed.
std::string whyInvalid(const CouplingDef& def);

/// What a coupling does, at the end of the last step.
struct CouplingState {
    double sum = 0;         ///< of the coordinates
    double speed = 0;       ///< its rate
    float force = 0;        ///< N or N m, towards larger sums; times its ratio, on a coordinate
    float limitMargin = 0;  ///< to the nearer limit, negative beyond it; infinite without limits
};

}  // namespace ragtop
