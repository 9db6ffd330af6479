#pragma once

#include "constraints/joint_sim.h"

/// What each joint type adds to the common pass in joint_sim.cpp.
namespace ragtop {

/// The joint's frames now.
struct JointPlace {
    Quat a, b;  ///< rotations of the joint frames, world
    Vec3 gap;   ///< m, anchor of B minus that of A
};

/// Fills in directions, errors and masses from the current positions. Springs act on the displacement at the
/// beginning of the substep in both passes: `begins` says that this is it.
void refreshJoint(JointSim& joint, const BodyPair& pair, bool begins);
void refreshBall(JointSim& joint, const JointPlace& place, const BodyPair& pair, bool begins);
void refreshHinge(JointSim& joint, const JointPlace& place, const BodyPair& pair, bool begins);
void refreshSlider(JointSim& joint, const JointPlace& place, const BodyPair& pair, bool begins);
void refreshFixed(JointSim& joint, const JointPlace& place, const BodyPair& pair);
void refreshDistance(JointSim& joint, const JointPlace& place, const BodyPair& pair, bool begins);

void solveBall(JointSim& joint, BodyPair& pair, const JointContext& context, bool useBias);
/// Hinge and slider: the block, then the rows of the free direction.
void solveBlockAndAxis(JointSim& joint, BodyPair& pair, const JointContext& context, bool useBias);
void solveDistance(JointSim& joint, BodyPair& pair, const JointContext& context, bool useBias);

/// Everything that the joint carries over, as one impulse in the directions that were just refreshed.
PairVector carriedImpulse(const JointSim& joint);
/// The angular impulse of a ball's rows.
Vec3 turningImpulse(const BallRows& rows);

/// Coordinates for the report. Angles in (−π, π].
float angleAboutX(const Quat& q);
inline float hingeAngle(const Quat& a, const Quat& b) { return angleAboutX(conjugate(a) * b); }
struct SwingTwist {
    float swing = 0, twist = 0;
    float cosHalfSwing = 1;
};
SwingTwist swingTwist(const Quat& a, const Quat& b);
/// Twice the vector part of the rotation from a to b, which is its rotation vector while small and grows with the
/// angle up to a half turn.
Vec3 rotationError(const Quat& a, const Quat& b);
/// The same for the two x axes alone, and perpendicular to both.
Vec3 axisError(const Vec3& xA, const Vec3& xB);
/// Margins of the coordinate to both limits; those of an angle are taken the short way round, so that half a turn
/// beyond the middle of the range separates what is pushed up from what is pushed down.
void setMargins(AxisRows& rows, float coordinate, bool isAngle);
/// Axis u of a twist limit: the twist rate is u · ω / cos(swing / 2).
Vec3 twistAxis(const Vec3& xA, const Vec3& xB);

}  // namespace ragtop
