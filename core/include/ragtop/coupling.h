#pragma once

#include <array>
#include <cstdint>
#include <string>

#include "ragtop/id.h"
#include "ragtop/joint_parts.h"
#include "ragtop/tunables.h"

/// Couplings between joints: gears, racks, pulleys, differentials, tendons. A coupling acts on one number, the sum of
/// coordinates of joints times their ratios. It pushes each joint between that joint's own two bodies, so the bodies
/// that carry the joints feel the reaction.
namespace ragtop {

/// One term of the sum: a coordinate of a joint, as World::state has it, and its ratio.
struct CoupledCoordinate {
    JointId joint{};
    int coordinate = 0;  ///< of JointState: 0 `coordinate`, 1 `second`, 2 `third`; 3 to 5 the travels of a SixDofDef
    float ratio = 1;     ///< by which it is multiplied; not zero
};

/// Hinge, slider, distance, cylindrical, universal, plane, screw, path and six-degree-of-freedom joints have
/// coordinates to couple. Those that turn count all their turns.
struct CouplingDef {
    static constexpr int kMostParts = 4;
    int count = 0;  ///< terms in use, 1 to 4
    std::array<CoupledCoordinate, kMostParts> parts{};
    /// What acts along the sum, in the unit of the coordinates times their ratios. A limit with equal ends makes a
    /// gear, a range or a spring a tendon.
    AxisDef sum{};
    std::uint64_t userData = 0;
};

/// `driven` turns `ratio` times as far as `driver`, measured from where both are zero. For two wheels that mesh outside
/// the ratio is minus the teeth of the driver over those of the driven wheel.
CouplingDef gear(JointId driver, JointId driven, float ratio);
/// The slider `rack` travels `radius` (m, of either sign, not zero) per radian of the hinge `pinion`.
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

/// Empty when the definition is usable (its joints are not checked); otherwise names field, value and what is allowed.
std::string whyInvalid(const CouplingDef& def);

/// What a coupling does, at the end of the last step.
struct CouplingState {
    double sum = 0;         ///< of the coordinates
    double speed = 0;       ///< its rate
    float force = 0;        ///< N or N m, towards larger sums; a coordinate gets it times its ratio
    float limitMargin = 0;  ///< of the sum to the nearer limit, negative beyond it; infinite without limits
};

}  // namespace ragtop
