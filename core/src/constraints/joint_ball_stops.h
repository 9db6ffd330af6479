#pragma once

#include "constraints/joint_types.h"

/// What keeps a ball within its swing and twist.
namespace ragtop {

/// The ball's rotation while its rows are solved in turn: torques come with the force that keeps the point together,
/// so the inverse inertia is the block's P.
struct BallTurn {
    const RigidBlock& block;
    Vec3 speed, total;

    void add(const Vec3& impulse) {
        total += impulse;
        speed += block.mass.rest * impulse;
    }
};

/// Margins and axes of the limits at a place.
void refreshLimits(BallRows& rows, const JointPlace& place);
/// Was the joint made beyond a limit, so that it is held where it is (docs/adr/0038)?
bool isHeld(const BallRows& rows);
/// Swing and twist in turn, or together where the joint is held.
void solveBallStops(JointSim& joint, BallTurn& turn, const BodyPair& pair, const JointContext& context, bool moving);

}  // namespace ragtop
