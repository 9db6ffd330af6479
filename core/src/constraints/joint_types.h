#pragma once

#include "constraints/joint_geometry.h"
#include "constraints/joint_sim.h"

/// What each joint type adds to the common pass in joint_sim.cpp.
namespace ragtop {

/// The joint's frames now.
struct JointPlace {
    Quat a, b;  ///< rotations of the joint frames, world
    Vec3 gap;   ///< m, anchor of B minus that of A
};

/// What a refresh is for.
struct Refresh {
    const JointContext& context;
    bool begins = false;  ///< the substep begins: what springs, friction and stops do in it is settled now
    bool places = false;  ///< balls and hinges are to have directions, errors and margins alone, and no new masses
};

/// Fills in directions, errors and masses from the current positions.
void refreshJoint(JointSim& joint, const BodyPair& pair, const Refresh& refresh);
void refreshBall(JointSim& joint, const JointPlace& place, const BodyPair& pair, const Refresh& refresh);
void refreshHinge(JointSim& joint, const JointPlace& place, const BodyPair& pair, const Refresh& refresh);
void refreshSlider(JointSim& joint, const JointPlace& place, const BodyPair& pair, const Refresh& refresh);
void refreshFixed(JointSim& joint, const JointPlace& place, const BodyPair& pair);
void refreshAxes(JointSim& joint, const JointPlace& place, const BodyPair& pair, const Refresh& refresh);
/// How the rows of an AxesBlock will bend within the substep, as velocities are now.
void foreseeAxes(JointSim& joint, const JointPlace& place, const BodyPair& pair, const JointContext& context);
/// By how much the mean rate of a free coordinate over h will differ from its speed now.
float bendOf(const JointSim& joint, std::uint32_t coordinate, const BodyPair& pair, float h);
/// The velocities that rigid rows leave, of which nothing is carried over.
BodyPair fitted(JointSim& joint, const BodyPair& pair);
/// Where the joint's frames are; sets its arms.
JointPlace locate(JointSim& joint, const BodyPair& pair);
/// Where the joint's frames will be after h.
JointPlace placeAhead(const JointPlace& now, const Arms& arms, const BodyPair& pair, float h);
void refreshDistance(JointSim& joint, const JointPlace& place, const BodyPair& pair, const Refresh& refresh);

/// Solves the rigid rows: for the mean velocity of the substep where positions are to move, else for that of now.
void solveRigid(JointSim& joint, BodyPair& pair, const JointContext& context, bool moving);
void solveBall(JointSim& joint, BodyPair& pair, const JointContext& context, bool useBias);
/// Hinge and slider: the block, then the rows of the free direction.
void solveBlockAndAxis(JointSim& joint, BodyPair& pair, const JointContext& context, bool useBias);
void solveDistance(JointSim& joint, BodyPair& pair, const JointContext& context, bool useBias);

void compileAxes(const JointDef& def, JointSim& joint);
/// Coordinates, gap and margins of a joint with an AxesBlock, at a place and relative velocity of its anchors' middle.
void reportAxes(const JointSim& joint, const JointPlace& place, const PairVector& speed, JointState& state);
void compile(BallRows& rows, const BallDef& def);
/// The drives of a ball: what does not change in a substep, and the change of their impulse in a pass.
void beginDrives(JointSim& joint, const JointPlace& place, float inverseInertia, float h);
Vec3 solveDrives(JointSim& joint, const Vec3& spin, int pass, float longest);
void rescale(BallRows& rows, float ratio);
/// By how much springs with drives lead, N m s: see spring_lead.h. `steady` is the load.
Vec3 leadDrives(const JointSim& joint, const JointPlace& place, float inverseInertia, float h, const Vec3& steady);
/// Inverse inertia of a ball about the axis that follows most quickly.
float easiest(const RigidBlock& block);
/// The angular impulse of a ball's rows.
Vec3 turningImpulse(const BallRows& rows);

/// Coordinates for the report. Angles in (−π, π].
inline float hingeAngle(const Quat& a, const Quat& b) { return angleAboutX(conjugate(a) * b); }
struct SwingTwist {
    float swing = 0, twist = 0;
    float cosHalfSwing = 1;
};
SwingTwist swingTwist(const Quat& a, const Quat& b);
/// The twist range of a ball where B's x axis has the direction d in A's frame.
Range twistRange(const BallRows& rows, const Vec3& d);

}  // namespace ragtop
