#pragma once

#include <cstdint>
#include <type_traits>

#include "constraints/axes_block.h"
#include "constraints/joint_ball_drives.h"
#include "constraints/joint_counts.h"
#include "constraints/joint_path.h"
#include "constraints/joint_swing.h"
#include "constraints/rows.h"
#include "constraints/stop_ledger.h"
#include "ragtop/joint.h"
#include "ragtop/math.h"
#include "solve/body_state.h"

/// Joints as the solver sees them. A joint is a composition of a few shared parts (constraints/rows.h): one block of
/// rigid rows, and scalar rows with limits, motor, spring and friction. Their Jacobians are refreshed in every substep
/// and again before the relaxing pass, so that velocities end each substep compatible with its final positions.
namespace ragtop {

/// Both bodies when the step began. The solver works relative to centres of mass. A body that is the world should
/// have its "centre" at the joint's frame, so that nothing large is rounded to single precision.
struct JointBodiesAtStep {
    Vec3 centerOffset;          ///< m, centre of mass of B minus that of A, world axes (from doubles)
    Quat rotationA, rotationB;  ///< q₀ of both bodies (identity for the world)
};

/// In the order of JointDef.
enum class JointKind : std::uint32_t {
    none,
    ball,
    hinge,
    slider,
    fixed,
    distance,
    cylindrical,
    universal,
    plane,
    screw,
    path,
    sixDof
};
constexpr bool hasAxes(JointKind kind) { return kind >= JointKind::cylindrical; }
inline JointKind kindOf(const JointDef& def) { return static_cast<JointKind>(def.index() + 1); }

/// What only a ball has: rows that turn B in A about any axis.
struct BallRows {
    static constexpr std::uint32_t kSwing = 1, kTwist = 2, kSpring = 4, kFriction = 8, kViscous = 16;  ///< bits
    static constexpr std::uint32_t kDrives = 32;  ///< JointSim::drives, in the stead of the spring
    std::uint32_t features = 0;
    Range twistLimit{};  ///< rad; a polygon has its own
    Stop stop{};
    ResistanceOf<float> resistance;
    struct Spring {
        SpringTuning tuning;
        float most = 0;
    };
    Spring spring;
    Quat target{};

    // Carried from substep to substep, N m s.
    Vec3 springImpulse, viscousImpulse, frictionImpulse;  ///< world axes
    StopSide swing[SwingLimit::kSides], twistLower, twistUpper;
    DryFriction dry;
    Vec3 springStart, springLoad;  ///< as of AxisRows, world axes

    // Of the current substep.
    Vec3 springError;              ///< rotation vector from the target when the substep began
    float springStiffness = 0;     ///< N m/rad
    float springDrag[2] = {0, 0};  ///< N m s per rad/s, in the pass that moves and in the other
    float viscousDrag[2] = {0, 0};
    Vec3 swingAxis[SwingLimit::kSides], twistAxis;  ///< unit vectors, zero where the row has no direction
    float mostEnergy = kNoForceLimit;  ///< J, of the relative rotation that a recovery from beyond a limit may leave
    SwingLimit swingLimit;
    /// What the swing adds to the axes of the twist's rows, not of unit length: a polygon's range grows with it, and
    /// the margin of a soft stop, which may be pressed by much, is a share of the twist that falls with it. Else zero.
    Vec3 lowerTilt, upperTilt;

    Vec3 lowerTwistAxis() const { return hasTilt() ? twistAxis + lowerTilt : twistAxis; }
    Vec3 upperTwistAxis() const { return hasTilt() ? -twistAxis + upperTilt : -twistAxis; }
    bool hasTilt() const { return swingLimit.shape == SwingShape::polygon || stop.stiffness > 0; }
};

/// How far what a joint holds together is apart, or a coordinate beyond its limits.
struct Opening {
    float way = 0;   ///< m
    float turn = 0;  ///< rad
};

/// One joint in the solver: trivially copyable and without padding, so that a saved world is a copy of memory. The
/// world reads and sets stateA and stateB only. From centerOffset to ball the order is that of joints in lanes, which
/// are transposed copies of it (joint_image.h). One of a kind that has axes is an AxesJointSim.
struct JointSim {
    std::uint32_t stateA = 0, stateB = 0;  ///< indices of states and inertias; 0 is the static body

    JointKind kind = JointKind::none;
    std::uint32_t breakable = 0;
    Frame localA{}, localB{};  ///< joint frames relative to centre of mass and body rotation

    // Of the current step.
    Vec3 centerOffset;        ///< m
    Vec3 anchorA, anchorB;    ///< m, from the centres of mass
    Quat frameA{}, frameB{};  ///< of the joint frames in the world

    Arms arms;               ///< m, of the current substep
    float ofFreeTree = 0;    ///< 1: the joint is one of a free tree's, see openShare
    PairVector stepImpulse;  ///< what a breakable joint gave in this step so far, N s and N m s
    RigidBlock block{};
    AxisRows axis;  ///< along the free direction of hinge, slider and distance
    BallRows ball;
    BallDrives drives;
    StopLedger ledger;
    PairVector lead;           ///< N s and N m s, given when the last step ended: see spring_lead.h
    std::uint32_t leads = 0;   ///< 1: `lead` was given, and is to be taken back
    Opening apart;             ///< by which a caller put its ends apart, as far as it was not seen closed since
    CountedAngle angleAtStep;  ///< what a hinge had counted when the step began: see joint_counts.h
};
static_assert(std::is_trivially_copyable_v<JointSim> && std::is_standard_layout_v<JointSim>);

/// What only the seldom kinds with an AxesBlock have, in the stead of block and axis: twice as much as all else.
struct AxesJointSim : JointSim {
    AxesBlock axes;
    struct Thread {
        float pitch = 0;   ///< m per rad
        float radius = 0;  ///< m
    };
    Thread thread;  ///< of a screw
    PathRows path;
    AxesCounts countsAtStep;
};
static_assert(std::is_trivially_copyable_v<AxesJointSim>);

/// Of a joint whose kind has axes.
inline AxesJointSim& withAxes(JointSim& joint) { return static_cast<AxesJointSim&>(joint); }
inline const AxesJointSim& withAxes(const JointSim& joint) { return static_cast<const AxesJointSim&>(joint); }
/// A copy of all that a joint has.
inline AxesJointSim copyOf(const JointSim& joint) {
    if (hasAxes(joint.kind)) return withAxes(joint);
    AxesJointSim copy;
    static_cast<JointSim&>(copy) = joint;
    return copy;
}

/// Compiles a definition that whyInvalid accepts. centerA/B: centre of mass of each body in its body frame (frames in
/// a definition are relative to the body's pose). Keeps the impulses of `into` when it already holds a joint of the
/// same type; never changes its state indices. `into` is an AxesJointSim where the definition's kind has axes.
void compileJoint(const JointDef& def, const Vec3& centerA, const Vec3& centerB, JointSim& into);
/// Once per step.
void prepareJoint(JointSim& joint, const JointBodiesAtStep& bodies, const BodyState* states, const BodyInertia* inertia,
                  const JointContext& context);
/// Directions and coordinates where the bodies are, for a look between steps.
void placeJoint(JointSim& joint, const JointBodiesAtStep& bodies, const BodyState* states, const BodyInertia* inertia);
/// Once per substep, in this order: warm start, solve with bias, (positions are integrated), solve without bias.
void warmStartJoint(JointSim& joint, BodyState* states, const BodyInertia* inertia, const JointContext& context);
void solveJoint(JointSim& joint, BodyState* states, const BodyInertia* inertia, const JointContext& context,
                bool useBias);
/// The same once more, with the directions that are there.
void solveJointAgain(JointSim& joint, BodyState* states, const BodyInertia* inertia, const JointContext& context,
                     bool useBias);
/// Everything that the joint carries over, as one impulse in the directions that were just refreshed.
PairVector warmStartImpulse(const JointSim& joint);
/// At the end of each substep.
inline void recordLoad(JointSim& joint) {
    if (joint.breakable == 0) return;
    const PairVector impulse = warmStartImpulse(joint);
    joint.stepImpulse.linear += impulse.linear;
    joint.stepImpulse.angular += impulse.angular;
}
/// Takes out of the velocities what the rigid rows do not allow, as a joint that was just made does; nothing is carried
/// over from that. True where that was more than rounding.
bool fitVelocities(JointSim& joint, BodyState* states, const BodyInertia* inertia);
/// What is reported at the end of a step; reads velocities only from `states`.
JointState jointState(const JointSim& joint, const JointBodiesAtStep& atEnd, const BodyState* states,
                      float inverseSubstep);
/// rad, by which axes or frames that a joint holds together are turned.
float turnedApart(const JointSim& joint, const JointBodiesAtStep& at);
/// Of what is reported.
Opening openingOf(const JointSim& joint, const JointState& state, const JointBodiesAtStep& at);
/// Scales the impulses carried over when the substep length changes (ratio = new h / old h).
void rescaleJoint(JointSim& joint, float ratio);

}  // namespace ragtop
