#pragma once

#include "constraints/joint_ball_turn.h"
#include "constraints/joint_types.h"

/// What keeps a ball within its swing and twist.
namespace ragtop {

using BallTurn = BallTurnOf<float>;

/// Margins and axes of the limits at a place.
void refreshLimits(BallRows& rows, const JointPlace& place);
/// Was the joint made beyond a limit, so that it is held where it is (docs/adr/0038)?
bool isHeld(const BallRows& rows);
/// Swing and twist in turn, or together where the joint is held.
void solveBallStops(JointSim& joint, BallTurn& turn, const BodyPair& pair, const JointContext& context, bool moving);

}  // namespace ragtop
