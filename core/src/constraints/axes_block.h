#pragma once

#include "constraints/rows.h"

/// A joint of any rows: some rigid, solved as one block, and up to three coordinates that act through it. Joints whose
/// rigid rows are not three of one half of the relative motion have this instead of a RigidBlock.
namespace ragtop {

struct AxesBlock {
    static constexpr int kMostRigid = 6, kMostFree = 6;  ///< of the six coordinates of two bodies
    std::uint32_t rigidRows = 0, freeRows = 0;
    std::uint32_t isIsolated = 0;  ///< 1: neither body has another joint
    std::uint32_t isAbrupt = 0;  ///< 1: rigid rows bend too differently from substep to substep to be foreseen
    std::uint32_t locked = 0;    ///< a bit for each coordinate that is a rigid row, at AxisRows::lower
    std::uint32_t vague = 0;  ///< the same where its row is not its rate: near a half turn, where swings have no axis

    // Carried from substep to substep, along the directions of the rows.
    float impulse[kMostRigid] = {}, startImpulse[kMostRigid] = {};
    AxisRows axis[kMostFree];

    // Of the current substep.
    PairVector rigid[kMostRigid], free[kMostFree];  ///< what a row takes of the relative motion
    /// Coordinates, m, or rad with all turns, and what single precision leaves of them.
    float value[kMostFree] = {}, rounded[kMostFree] = {};
    float error[kMostRigid] = {};
    float rigidBend[kMostRigid] = {}, freeBend[kMostFree] = {};  ///< mean rates over the substep less those of now
    float lower[kMostRigid][kMostRigid] = {};  ///< L D Lᵀ of the rigid rows: L, and the inverse pivots on its diagonal
    float gain[kMostFree][kMostRigid] = {};  ///< K_rr⁻¹ K_rf: what keeps the rigid rows' velocity, per free impulse
};

inline double coordinateOf(const AxesBlock& block, std::uint32_t f) {
    return static_cast<double>(block.value[f]) + static_cast<double>(block.rounded[f]);
}
/// Was the joint made beyond a limit, so that it is held where it is (docs/adr/0038)?
bool isHeld(const AxesBlock& block);
/// Masses from the directions, once these are filled in.
void refreshMass(AxesBlock& block, const PairMass& mass);
/// All that is carried over as one impulse.
PairVector warmStartImpulse(const AxesBlock& block);
/// The impulse along a coordinate with what keeps the rigid rows' velocity, which is noted.
PairVector freeImpulse(AxesBlock& block, std::uint32_t coordinate, float amount);
/// The velocities that the rigid rows leave when they only hold, or bend as in the substep before.
BodyPair held(const AxesBlock& block, const BodyPair& pair, const Arms& arms, bool bending);
void solveAxes(AxesBlock& block, BodyPair& pair, const Arms& arms, const Softness& rigid, const JointContext& context,
               bool moving);
/// Moves the bodies such that `share` of the rigid rows' errors is gone, to first order.
void closeAxes(const AxesBlock& block, const BodyPair& pair, const Arms& arms, float share);
/// When a substep begins, once directions and masses are there.
void beginAxes(AxesBlock& block, const BodyPair& pair, const Arms& arms, float reaction, const JointContext& context);
void rescale(AxesBlock& block, float ratio);

inline float speedAlong(const PairVector& row, const PairVector& velocity) {
    return dot(row.linear, velocity.linear) + dot(row.angular, velocity.angular);
}
/// A travel of B along a direction that turns with A: at the shared point, half the gap away from either anchor, the
/// relative velocity has half of what the gap turns by too much on each side.
inline PairVector travelRow(const Vec3& direction, const Vec3& gap) {
    return {direction, 0.5f * cross(gap, direction)};
}

}  // namespace ragtop
