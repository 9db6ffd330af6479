#pragma once

#include <cstdint>
#include <optional>

#include "ragtop/joint_parts.h"

/// Scalar rows along one coordinate, described so that both solvers can solve them: the iteration one after the other,
/// through the joint's block; direct islands all at once.
namespace ragtop {

class StopTrajectory;
struct JointContext;

/// What a row asks for in one pass. A rigid row is to reach a speed; a compliant one gives λ = push − drag u.
struct RowAim {
    float target = 0;
    float push = 0, drag = -1;  ///< N s, N s per m/s; a negative drag: rigid
    float lower = -kNoForceLimit, upper = kNoForceLimit;
    bool soft = false;  ///< rigid rows that recover from an error, with the softness of joints
};

/// Drags of a spring or damper for the passes that move positions and the one after it, as shares q = 1/(1 + w drag)
/// of a speed that they leave.
struct SpringShares {
    float moving = 1, resting = 1;
};
/// With λ = (−h k C − drag u)/(1 + w drag) in both passes, speeds before and after a substep are related as
///   h v₁ = q₁ (h v − z C),  v₂ = q₂ (v − z C/h),  z = h² k w,
/// so that rest is exact whatever the shares are; they are chosen so that the two eigenvalues are those of the damped
/// oscillator: q₂ = e^{−2a}, z q₁ = (1 − e^{−a})² + 4 e^{−a} sin²(b/2) with a = ζωh, b = √(1 − ζ²) ωh. Beyond ωh = 1,
/// where neighbours would make that unstable, the excess is added as by an implicit step.
SpringShares springShares(float stiffness, float damping, float inverseMass, float h);
/// Stiffness and damping of a spring, by frequency and damping ratio where these are given.
struct TunedSpring {
    float stiffness, damping;
};
TunedSpring tuned(const TunedSpring& given, float frequency, float dampingRatio, float inverseMass);
/// A share as the drag of a row.
inline float dragOf(float share, float inverseMass) { return (1 / share - 1) / inverseMass; }

/// A limit that is violated by much is come back from by at most so much in a substep, rad. Turning faster, bodies
/// with unequal moments would make energy of it that is not taken back.
inline constexpr float kTurnRecovery = 0.01f;

inline constexpr float kArrives = 1, kLeaves = 2;  ///< of StopSide::meets

/// One end of a range. Its coordinate is the margin, which is negative beyond the end.
struct StopSide {
    float impulse = 0;                  ///< N s or N m s, carried
    float margin = 0, startMargin = 0;  ///< now, and when the substep began
    float rebound = 0;                  ///< speed after an impact in this substep; 0: none
    float landing = 0;                  ///< speed that brings it to where the rebound leads
    float lastSpeed = 0;                ///< of the margin when the substep before began
    float wasSeen = 0;                  ///< 1 where lastSpeed holds
    float recovery = kNoForceLimit;     ///< m or rad per substep, the fastest recovery
    float share = 0;                    ///< of the substep in which a soft stop that is met on the way acts
    float pressed = 0;                  ///< 1 when it was in touch before this substep already
    float due = 0;                      ///< N s, what a soft stop that has let go still gives
    float meets = 0;                    ///< a soft stop on the way, kArrives or kLeaves, with `landing` and `leaving`
    float leaving = 0;                  ///< speed after the substep
};
/// When a substep begins; `speed` is that of the margin before the rows of the joint act. True when something ran into
/// the stop in the substep before: an impact does not last, so that its impulses are no guess for those to come.
bool beginStop(StopSide& side, const Stop& stop, float speed, const StopTrajectory& course, float h, float bend = 0);
/// False where the row of a stop would leave an impulse of zero as it is.
bool mayAct(const StopSide& side, const Stop& stop, float speed, const JointContext& context, bool moving);
RowAim aimAtStop(const StopSide& side, const Stop& stop, float inverseMass, const JointContext& context, bool moving);

/// An impulse over another substep. Times 0 nothing is left of it, be it a number or not.
inline void rescale(float& impulse, float ratio) { impulse = ratio == 0 ? 0.0f : ratio * impulse; }
inline void rescale(Vec3& impulse, float ratio) { impulse = ratio == 0 ? Vec3{} : ratio * impulse; }

/// Dry friction that knows whether it slides. What slides through a whole substep acts half before the motion and half
/// after it, as a constant force should: then its path is exact.
struct DryFriction {
    float bound = 0;   ///< N s or N m s, of this substep
    float slides = 0;  ///< 1 or 0
    /// `size` is that of the impulse carried over, which must be halved when this returns true.
    bool begin(float size, float kinetic, float breakaway);
    float boundOf(bool moving) const { return moving && slides > 0 ? 0.5f * bound : bound; }
};

enum class AxisSlot : std::uint32_t { spring, viscous, friction, motor, lower, upper };
inline constexpr int kAxisSlots = 6;  ///< of AxisSlot

/// What a definition says about a coordinate.
struct AxisSettings {
    std::optional<Range> limit{};
    Stop stop{};
    std::optional<Motor> motor{};
    std::optional<Spring> spring{};
    float target = 0, friction = 0;
    std::optional<Bearing> bearing{};
    bool turns = false;  ///< rad, not m
};

struct AxisRows {
    static constexpr std::uint32_t kLimit = 1, kLocked = 2, kMotor = 4, kSpring = 8, kFriction = 16, kViscous = 32;  ///< bits
    static constexpr std::uint32_t kCoupled = 64;  ///< other joints push along this coordinate
    std::uint32_t features = 0;
    float lower = 0, upper = 0;  ///< m or rad
    Stop stop{};
    float targetSpeed = 0, maxForward = 0, maxReverse = 0;  ///< of the motor
    float stiffness = 0, damping = 0, frequency = 0, dampingRatio = 0, target = 0, springSpeed = 0, feedForward = 0,
          maxSpring = 0;
    float friction = 0, breakaway = 0, viscous = 0, loadFriction = 0;

    // Carried from substep to substep, N s or N m s.
    float springImpulse = 0, viscousImpulse = 0, frictionImpulse = 0, motorImpulse = 0;
    float coupledImpulse = 0;  ///< of couplings with other joints, which carry it themselves
    StopSide atLower, atUpper;
    DryFriction dry;
    float motorStalls = 0;  ///< 1: forward, −1: in reverse, as far as it can
    float springStart = 0;  ///< m/s or rad/s, when the last substep began and forces had acted
    float springLoad = 0;   ///< N s or N m s, what else than the spring pushed in the last substep of the step
    // Of an angle.
    float lastAngle = 0;     ///< rad, in (−π, π]
    std::int32_t turns = 0;  ///< whole turns beside it
    std::uint32_t tracked = 0;

    // Of the current substep.
    float inverseMass = 0;  ///< speed per impulse through the block; 0: the axis cannot move
    float springError = 0;  ///< displacement from the target when the substep began
    float springStiffness = 0;
    SpringShares springShare, viscousShare;

    bool has(AxisSlot slot) const;
    bool isStop(AxisSlot slot) const { return slot >= AxisSlot::lower && (features & kLimit) != 0; }
    bool keepsRange() const { return (features & (kLimit | kLocked)) != 0; }
    const StopSide& stopAt(AxisSlot slot) const { return slot == AxisSlot::upper ? atUpper : atLower; }
    float& impulse(AxisSlot slot);
    float impulse(AxisSlot slot) const { return const_cast<AxisRows*>(this)->impulse(slot); }
};
/// Takes a definition over and keeps the impulses of the rows that remain.
void compile(AxisRows& rows, const AxisSettings& settings);
/// Of all rows together.
float axisImpulse(const AxisRows& rows);
void rescale(AxisRows& rows, float ratio);

/// An angle about x in (−π, π] with the turns that it has made, rad. It may change by less than half a turn between
/// two calls.
double unwrapped(const AxisRows& rows, float angle);
void track(AxisRows& rows, float angle);
/// Margins of a coordinate to both ends.
void setMargins(AxisRows& rows, double coordinate);
/// When a substep begins, before the rows act: what does not change in it. `reaction` is the impulse across the axis
/// that the joint gave in the last one, `bend` that of solveAxis. True as for stops.
bool beginAxis(AxisRows& rows, double coordinate, float speed, float reaction, const JointContext& context,
               float bend = 0);

RowAim aimOf(const AxisRows& rows, AxisSlot slot, const JointContext& context, bool moving);
/// Solves one row and returns the change of its impulse.
float solveRow(float& impulse, const RowAim& aim, float speed, float inverseMass, const JointContext& context);
/// Solves all rows in turn, limits last, and returns the sum of the impulses added. Where positions are to move, what
/// is to stay within a range counts `bend`, by which its mean rate differs from its speed; springs, dampers and motors
/// know how their own motion goes on.
float solveAxis(AxisRows& rows, float speed, const JointContext& context, bool moving, float bend = 0);
/// The same of what keeps it in its range alone.
float solveStops(AxisRows& rows, float speed, const JointContext& context, bool moving, float bend);

/// `angle` plus or minus a turn so that it lies within half a turn of `center`; |angle − center| < 3π.
float wrapAbout(float angle, float center);

}  // namespace ragtop
