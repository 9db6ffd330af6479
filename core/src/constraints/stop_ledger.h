#pragma once

#include <cstdint>

#include "constraints/rows.h"

namespace ragtop {

struct JointSim;

/// In which the joint acted last, of this substep.
enum class LedgerPass : std::uint32_t { none, warmStart, moving };

/// What the soft stops of a joint are answered for: over the time that they are pressed springs give back what they
/// took, dampers less. Substeps follow their trajectory to second order in ωh and in what turning adds meanwhile, those
/// of balls to first; what that leaves is settled when the stops let go, whether that leads into the other stop or not:
/// with the free coordinate, the one of several that has most energy, or the rotation of a ball. Where anything but
/// this joint and a steady force acts on the bodies meanwhile is unknown, and nothing is settled.
struct StopLedger {
    LedgerPass pass = LedgerPass::none;
    float known = 0;    ///< 1: what follows holds
    float begun = 0;    ///< 1: a substep has shown the kick
    float pressed = 0;  ///< 1 from when a stop is met until it lets go
    float steady = 0;   ///< 1: nothing but a steady force has acted since `kept` was measured
    float kept = 0;     ///< J, of the relative motion and the stop, and what the steady force has given since
    Vec3 speed;         ///< m/s, of B relative to A when the joint last acted
    Vec3 spinA, spinB;  ///< rad/s, then
    Vec3 last;          ///< m/s, of B relative to A when the substep before ended
    Vec3 kick;          ///< m/s, what is added to that between substeps
    Vec3 way;           ///< m, B's way relative to A's when the substep began
};

/// Of a joint that was just made, once velocities fit it.
void beginLedger(JointSim& joint, const BodyPair& pair);
/// Before the joint acts in a substep, its margins and masses known.
void openLedger(JointSim& joint, const BodyPair& pair, float h);
/// Around what the joint does in the warm start and in the moving pass: whatever else acts in between is seen by its
/// change of the velocities.
void watchOthers(JointSim& joint, const BodyPair& pair);
void recordOwn(JointSim& joint, const BodyPair& pair, LedgerPass pass);
/// After the relaxing pass, before which `watchOthers` looked.
void settleLedger(JointSim& joint, BodyPair& pair, const JointContext& context);

}  // namespace ragtop
