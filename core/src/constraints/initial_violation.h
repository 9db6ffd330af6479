#pragma once

#include "constraints/joint_sim.h"

/// Joints that are made beyond their hard limits. A stop stores no energy: pushed back by their velocities, bodies that
/// turn would be spun up as arms drawn in spin up a skater. The rows only hold such a side, and the bodies
/// are moved back a little in each step, which gives them no speed.
namespace ragtop {

/// Is a coordinate beyond a hard stop by more than what rows bring back? Asks the margins that are there.
bool isViolatedInitially(const JointSim& joint);
/// Lets the rows of sides that are violated hold without bringing anything back, until the definition is compiled
/// anew.
/// How far the joint is beyond its hard stops where it was placed last, rad or the same of its lengths; negative within
/// them. Stops that it was made beyond do not count.
float limitOverrun(const JointSim& joint);
void holdInitialViolation(JointSim& joint);

/// By how much a body is to be moved: m, and a rotation vector.
struct Shift {
    Vec3 way, turn;
};
struct PairShift {
    Shift a, b;
};
/// What brings the coordinates of a joint nearer to its range, up to `most` rad or of its arms, and the bodies
/// together, to first order.
PairShift shiftBack(const JointSim& joint, const JointBodiesAtStep& bodies, const BodyState* states,
                    const BodyInertia* inertia, float most);

}  // namespace ragtop
