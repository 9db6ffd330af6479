#pragma once

#include <cstdint>
#include <optional>

#include "base/numbers.h"
#include "constraints/joint_constants.h"
#include "ragtop/joint_parts.h"
#include "solve/body_state.h"

/// Scalar rows along one coordinate, described so that both solvers can solve them: the iteration one after the other,
/// through the joint's block; direct islands all at once.
namespace ragtop {

class StopTrajectory;

/// What all joints share in a substep.
struct JointContext {
    float h = 0, inverseH = 0;  ///< s, 1/s
    Softness softness;          ///< of the rows that are rigid in the definition
    bool ofFreeTree = false;    ///< the joint's limits carry their whole load, as its rigid rows do
    bool settling = false;      ///< a pass that finds loads: it moves no body, and what it gives is no joint's load
};

/// The rate at which joints of free trees come back from beyond a limit, over that of errors of their rigid rows.
/// Limits that carry their whole load need no more; at the whole rate limbs that lie on something chatter (of 100
/// dropped humans 10 are awake after 5 s, 2 to 3 at any share from 0.06 to 0.35).
inline constexpr float kStopRate = 0.25f;

/// What the memory of a joint has beside numbers T, of the size of one.
template <class T>
struct JointTypes;
template <>
struct JointTypes<float> {
    using Bits = std::uint32_t;
    using Count = std::int32_t;
    using Stop = ragtop::Stop;
};

/// What a row asks for in one pass. A rigid row is to reach a speed; a compliant one gives λ = push − drag u.
template <class T>
struct RowAimOf {
    T target = T(0.0f);
    T push = T(0.0f), drag = T(-1.0f);  ///< N s, N s per m/s; a negative drag: rigid
    T lower = T(-kNoForceLimit), upper = T(kNoForceLimit);
    TestOf<T> soft{};        ///< rigid rows that recover from an error, with the softness of joints
    bool compliant = false;  ///< `drag` is that of a row
    bool always = false;     ///< a stop that may act in any case
};
using RowAim = RowAimOf<float>;
/// The change of a row's impulse where it acts.
template <class T>
RAGTOP_INLINE T solveRow(T& impulse, const RowAimOf<T>& aim, const T& speed, const T& inverseMass,
                         const JointContext& context, const TestOf<T>& acts) {
    const T old = impulse;
    T solved;
    if (aim.compliant) {
        solved = (aim.push - aim.drag * (speed - inverseMass * old)) / (1 + inverseMass * aim.drag);
    } else {
        const T massScale = select(aim.soft, T(context.softness.massScale), T(1.0f));
        const T impulseScale = select(aim.soft, T(context.softness.impulseScale), T(0.0f));
        solved = old - massScale * (speed - aim.target) / inverseMass - impulseScale * old;
    }
    impulse = select(acts, clamp(solved, aim.lower, aim.upper), old);
    return impulse - old;
}

/// Drags of a spring or damper for the passes that move positions and the one after it, as shares q = 1/(1 + w drag)
/// of a speed that they leave.
template <class T>
struct SpringSharesOf {
    T moving = T(1.0f), resting = T(1.0f);
};
using SpringShares = SpringSharesOf<float>;
/// With λ = (−h k C − drag u)/(1 + w drag) in both passes, speeds before and after a substep are related as
///   h v₁ = q₁ (h v − z C),  v₂ = q₂ (v − z C/h),  z = h² k w,
/// so that rest is exact whatever the shares are; they are chosen so that the two eigenvalues are those of the damped
/// oscillator: q₂ = e^{−2a}, z q₁ = (1 − e^{−a})² + 4 e^{−a} sin²(b/2) with a = ζωh, b = √(1 − ζ²) ωh. Beyond ωh = 1,
/// where neighbours would make that unstable, the excess is added as by an implicit step.
SpringShares springShares(float stiffness, float damping, float inverseMass, float h);
/// A share as the drag of a row.
template <class T>
RAGTOP_INLINE T dragOf(const T& share, const T& inverseMass) {
    return (1 / share - T(1.0f)) / inverseMass;
}
template <class T>
struct TunedSpringOf {
    T stiffness, damping;
};
using TunedSpring = TunedSpringOf<float>;
/// Stiffness and damping of a spring, by frequency and damping ratio where these are given.
template <class T>
struct SpringTuningOf {
    T stiffness{}, damping{}, frequency{}, dampingRatio{};

    RAGTOP_INLINE TunedSpringOf<T> at(const T& inverseMass) const {
        const T omega = 2 * kPi * frequency;
        const TestOf<T> isTuned = (frequency > 0) & (inverseMass > 0);
        return {select(isTuned, omega * omega / inverseMass, stiffness),
                select(isTuned, 2 * dampingRatio * omega / inverseMass, damping)};
    }
};
using SpringTuning = SpringTuningOf<float>;
inline SpringTuning tuningOf(const Spring& spring) {
    return {spring.stiffness, spring.damping, spring.frequency, spring.dampingRatio};
}

/// What hinders a motion: N or N m, N s/m or N m s, and N or N m per N of the load.
template <class T>
struct ResistanceOf {
    T friction{}, breakaway{}, viscous{}, loadFriction{};

    /// |impulse| of what slides over h seconds under the impulse of a reaction.
    RAGTOP_INLINE T kinetic(const T& h, const T& reaction) const { return h * friction + loadFriction * reaction; }
};

/// An angle with its turns, which a pose alone does not tell.
template <class T>
struct CountedAngleOf {
    T last{};                               ///< rad, in (−π, π]
    typename JointTypes<T>::Count turns{};  ///< whole turns beside it
    typename JointTypes<T>::Bits tracked{};
};
using CountedAngle = CountedAngleOf<float>;

/// A limit that is violated by much is come back from by at most so much in a substep, rad. Turning faster, bodies
/// with unequal moments would make energy of it that is not taken back.
inline constexpr float kTurnRecovery = 0.01f;

inline constexpr float kArrives = 1, kLeaves = 2;  ///< of StopSide::meets

/// One end of a range. Its coordinate is the margin, which is negative beyond the end.
template <class T>
struct StopSideOf {
    T impulse{};                    ///< N s or N m s, carried
    T margin{}, startMargin{};      ///< now, and when the substep began
    T rebound{};                    ///< speed after an impact in this substep; 0: none
    T landing{};                    ///< speed that brings it to where the rebound leads
    T lastSpeed{};                  ///< of the margin when the substep before began
    T wasSeen{};                    ///< 1 where lastSpeed holds
    T recovery = T(kNoForceLimit);  ///< m or rad per substep, the fastest recovery
    T share{};                      ///< of the substep in which a soft stop that is met on the way acts
    T pressed{};                    ///< 1 when it was in touch before this substep already
    T due{};                        ///< N s, what a soft stop that has let go still gives
    T meets{};                      ///< a soft stop on the way, kArrives or kLeaves, with `landing` and `leaving`
    T leaving{};                    ///< speed after the substep
};
using StopSide = StopSideOf<float>;
/// When a substep begins; `speed` is that of the margin before the rows of the joint act. True when something ran into
/// the stop in the substep before: an impact does not last, so that its impulses are no guess for those to come.
bool beginStop(StopSide& side, const Stop& stop, float speed, const StopTrajectory& course, float h, float bend = 0);
/// The same of a hard stop alone. With the restitution e it is left at −e u from the time within the substep when it
/// is met; what may reach it does so in this substep, as it would be at rest in the next if it were stopped there.
template <class T>
RAGTOP_INLINE TestOf<T> beginHardStop(StopSideOf<T>& side, const T& restitution, bool rebounds, const T& speed,
                                      float h) {
    const T zero(0.0f), one(1.0f);
    const TestOf<T> loaded = side.impulse > zero, wasFree = !(side.pressed > zero);
    if (!rebounds) {
        const TestOf<T> struck = loaded & wasFree;
        side.pressed = select(loaded, one, zero);
        side.impulse = select(struck, zero, side.impulse);
        return struck;
    }
    const TestOf<T> rebounded = side.rebound > zero, struck = loaded & (rebounded | wasFree);
    const TestOf<T> presses = loaded & (!rebounded), seen = (side.wasSeen > zero) & (!rebounded);
    side.pressed = select(presses, one, zero);
    side.impulse = select(struck, zero, side.impulse);
    const T gained = select(seen, speed - side.lastSpeed, zero);
    side.lastSpeed = speed;
    side.wasSeen = one;
    // Some forces have acted on this speed already and some have not: half of what they give is nearest to both.
    const T approach = -(speed + 0.5f * gained), change = select(gained < zero, -gained, gained);
    const TestOf<T> meets = (!presses) & (restitution > zero) & (approach > kRestingRebound * change) &
                            (!(side.margin >= h * (approach + change)));
    const T toEnd = select(side.margin > zero, side.margin / approach, zero), before = min(toEnd, T(h));
    const T rebound = restitution * approach;
    side.rebound = select(meets, rebound, zero);
    side.landing = select(meets, (rebound * (T(h) - before) - side.margin) / T(h), side.landing);
    return struck;
}
RowAim aimAtStop(const StopSide& side, const Stop& stop, float inverseMass, const JointContext& context, bool moving);
/// The same of a hard stop alone. With the leak of soft rows a limit under weight would stand passed by λ/(m h ω²),
/// which those of free trees are spared.
template <class T>
RAGTOP_INLINE RowAimOf<T> aimAtHardStop(const StopSideOf<T>& side, bool rebounds, const TestOf<T>& ofFreeTree,
                                        const JointContext& context, bool moving) {
    const T zero(0.0f), all(kNoForceLimit);
    const TestOf<T> apart = side.margin > zero;
    RowAimOf<T> aim;
    aim.lower = zero;
    if (moving) {
        const float soft = context.softness.biasRate;
        const T rate = select(ofFreeTree, T(kStopRate * soft), T(soft));
        const T recovery = -rate * side.margin, fastest = context.inverseH * side.recovery;
        aim.target = select(apart, context.inverseH * -side.margin, min(recovery, fastest));
        aim.soft = !(apart | ofFreeTree);
    } else {
        // What was not stopped while it moved has its speed still; the next substep stops it where it is to stop.
        aim.upper = select(apart & (!(side.impulse > zero)), zero, all);
        aim.soft = zero > zero;
    }
    if (rebounds) {
        const TestOf<T> jumps = side.rebound > zero;
        aim.target = select(jumps, moving ? side.landing : side.rebound, aim.target);
        aim.soft = aim.soft & (!jumps);
        aim.upper = select(jumps, all, aim.upper);
    }
    return aim;
}
/// False where the row of a stop would leave an impulse of zero as it is.
template <class T>
RAGTOP_INLINE TestOf<T> mayAct(const StopSideOf<T>& side, const RowAimOf<T>& aim, const T& speed) {
    return (side.impulse > 0) | ((aim.upper > 0) & (speed < aim.target));
}

/// An impulse over another substep. Times 0 nothing is left of it, be it a number or not.
inline void rescale(float& impulse, float ratio) { impulse = ratio == 0 ? 0.0f : ratio * impulse; }
inline void rescale(Vec3& impulse, float ratio) { impulse = ratio == 0 ? Vec3{} : ratio * impulse; }

/// Dry friction that knows whether it slides. What slides through a whole substep acts half before the motion and half
/// after it, as a constant force should: then its path is exact.
template <class T>
struct DryFrictionOf {
    T bound{};   ///< N s or N m s, of this substep
    T slides{};  ///< 1 or 0
    /// `size` is that of the impulse carried over, which must be halved where this returns true.
    RAGTOP_INLINE TestOf<T> begin(const T& size, const T& kinetic, const T& breakaway) {
        const T zero(0.0f);
        const TestOf<T> sliding = (bound > zero) & (size >= kAtBound * bound);
        slides = select(sliding, T(1.0f), zero);
        bound = kinetic + select(sliding, zero, breakaway);
        return sliding;
    }
    RAGTOP_INLINE T boundOf(bool moving) const { return moving ? select(slides > 0, 0.5f * bound, bound) : bound; }
};
using DryFriction = DryFrictionOf<float>;

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

template <class T>
struct AxisRowsOf {
    /// Bits of `features`; coupled: other joints push along this coordinate.
    static constexpr std::uint32_t kLimit = 1, kLocked = 2, kMotor = 4, kSpring = 8, kFriction = 16, kViscous = 32,
                                   kCoupled = 64;
    typename JointTypes<T>::Bits features{};
    T lower{}, upper{};  ///< m or rad
    typename JointTypes<T>::Stop stop{};
    struct Motor {
        T targetSpeed{}, maxForward{}, maxReverse{};
    };
    Motor motor;
    struct Spring {
        SpringTuningOf<T> tuning;
        T target{}, speed{}, feedForward{}, most{};
    };
    Spring spring;
    ResistanceOf<T> resistance;

    // Carried from substep to substep, N s or N m s.
    T springImpulse{}, viscousImpulse{}, frictionImpulse{}, motorImpulse{};
    T coupledImpulse{};  ///< of couplings with other joints, which carry it themselves
    StopSideOf<T> atLower, atUpper;
    DryFrictionOf<T> dry;
    T motorStalls{};          ///< 1: forward, −1: in reverse, as far as it can
    T springStart{};          ///< m/s or rad/s, when the last substep began and forces had acted
    T springLoad{};           ///< N s or N m s, what else than the spring pushed in the last substep of the step
    CountedAngleOf<T> angle;  ///< where it is one

    // Of the current substep.
    T inverseMass{};  ///< speed per impulse through the block; 0: the axis cannot move
    T springError{};  ///< displacement from the target when the substep began
    T springStiffness{};
    SpringSharesOf<T> springShare, viscousShare;

    bool has(AxisSlot slot) const {
        constexpr std::uint32_t kOf[kAxisSlots] = {kSpring, kViscous, kFriction, kMotor, kLimit | kLocked, kLimit};
        return (features & kOf[static_cast<int>(slot)]) != 0;
    }
    bool isStop(AxisSlot slot) const { return slot >= AxisSlot::lower && (features & kLimit) != 0; }
    bool keepsRange() const { return (features & (kLimit | kLocked)) != 0; }
    RAGTOP_INLINE StopSideOf<T>& stopAt(AxisSlot slot) { return slot == AxisSlot::upper ? atUpper : atLower; }
    const StopSideOf<T>& stopAt(AxisSlot slot) const { return slot == AxisSlot::upper ? atUpper : atLower; }
    RAGTOP_INLINE T& impulse(AxisSlot slot) {
        switch (slot) {
            case AxisSlot::spring:
                return springImpulse;
            case AxisSlot::viscous:
                return viscousImpulse;
            case AxisSlot::friction:
                return frictionImpulse;
            case AxisSlot::motor:
                return motorImpulse;
            case AxisSlot::lower:
            case AxisSlot::upper:
                break;
        }
        return stopAt(slot).impulse;
    }
    T impulse(AxisSlot slot) const { return const_cast<AxisRowsOf*>(this)->impulse(slot); }
};
using AxisRows = AxisRowsOf<float>;
/// Takes a definition over and keeps the impulses of the rows that remain.
void compile(AxisRows& rows, const AxisSettings& settings);
/// Of all rows together, but for what couplings carry.
template <class T>
RAGTOP_INLINE T ownImpulse(const AxisRowsOf<T>& rows) {
    return rows.springImpulse + rows.viscousImpulse + rows.frictionImpulse + rows.motorImpulse + rows.atLower.impulse -
           rows.atUpper.impulse;
}
inline float axisImpulse(const AxisRows& rows) { return ownImpulse(rows) + rows.coupledImpulse; }
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

/// What the rows but stops are given when a substep begins; `error` is the displacement of the spring.
template <class T>
RAGTOP_INLINE void beginRows(AxisRowsOf<T>& rows, std::uint32_t features, const T& error, const T& speed,
                             const T& reaction, const T& inverseMass, float h) {
    const T zero(0.0f);
    if (features & AxisRows::kSpring) {
        const TunedSpringOf<T> spring = rows.spring.tuning.at(inverseMass);
        rows.springStiffness = spring.stiffness;
        rows.springError = error;
        rows.springShare = springShares(spring.stiffness, spring.damping, inverseMass, h);
        rows.springStart = speed;
    }
    if (features & AxisRows::kViscous) rows.viscousShare = springShares(zero, rows.resistance.viscous, inverseMass, h);
    if (features & AxisRows::kFriction) {
        const T impulse = rows.frictionImpulse, size = select(impulse < zero, -impulse, impulse);
        const TestOf<T> slides =
            rows.dry.begin(size, rows.resistance.kinetic(T(h), reaction), h * rows.resistance.breakaway);
        rows.frictionImpulse = select(slides, 0.5f * impulse, impulse);
    }
    if (features & AxisRows::kMotor) {
        const T impulse = rows.motorImpulse, bound(kAtBound * h);
        const TestOf<T> forward = (impulse >= bound * rows.motor.maxForward) & (rows.motor.maxForward > zero);
        const TestOf<T> reverse =
            (impulse <= -bound * rows.motor.maxReverse) & (rows.motor.maxReverse > zero) & (!forward);
        rows.motorStalls = select(forward, T(1.0f), select(reverse, T(-1.0f), zero));
        rows.motorImpulse = select(forward | reverse, 0.5f * impulse, impulse);
    }
}

/// What a row but a stop asks for:
///   spring   λ = −h k C − drag u;  viscous  λ = −drag u;  friction  u = 0, |λ| ≤ h F;  motor  u = target, |λ| ≤ h F;
///   a locked coordinate (`lower`)  u = −β C.
template <class T>
RAGTOP_INLINE RowAimOf<T> aimOfRow(const AxisRowsOf<T>& rows, AxisSlot slot, const T& inverseMass,
                                   const JointContext& context, bool moving) {
    const float h = context.h;
    RowAimOf<T> aim;
    switch (slot) {
        case AxisSlot::spring:
            aim.compliant = true;
            aim.drag = dragOf(moving ? rows.springShare.moving : rows.springShare.resting, inverseMass);
            aim.push =
                h * (rows.spring.feedForward - rows.springStiffness * rows.springError) + aim.drag * rows.spring.speed;
            aim.upper = h * rows.spring.most;
            aim.lower = -aim.upper;
            break;
        case AxisSlot::viscous:
            aim.compliant = true;
            aim.drag = dragOf(moving ? rows.viscousShare.moving : rows.viscousShare.resting, inverseMass);
            break;
        case AxisSlot::friction:
            aim.upper = rows.dry.boundOf(moving);
            aim.lower = -aim.upper;
            break;
        case AxisSlot::motor: {
            const T half(moving ? 0.5f : 1.0f), one(1.0f);
            aim.target = rows.motor.targetSpeed;
            aim.upper = h * rows.motor.maxForward * select(rows.motorStalls > 0, half, one);
            aim.lower = -h * rows.motor.maxReverse * select(rows.motorStalls < 0, half, one);
            break;
        }
        case AxisSlot::lower:
        case AxisSlot::upper:
            if (!moving) break;
            aim.soft = aim.upper > 0;
            aim.target = -context.softness.biasRate * rows.atLower.margin;
            break;
    }
    return aim;
}
RowAim aimOf(const AxisRows& rows, AxisSlot slot, const JointContext& context, bool moving);

/// The rows along a coordinate while they are solved in turn.
template <class T>
struct AxisPassOf {
    AxisRowsOf<T>& rows;
    std::uint32_t features;
    const JointContext& context;
    bool moving;
    T inverseMass, speed, bend;
    TestOf<T> movable;
    T total = T(0.0f);  ///< of the impulses added

    RAGTOP_INLINE void solve(AxisSlot slot, const RowAimOf<T>& aim, const T& along, float side, const TestOf<T>& acts) {
        const T change = side * solveRow<T>(rows.impulse(slot), aim, along, inverseMass, context, acts);
        total = total + change;
        speed = speed + inverseMass * change;
    }
    RAGTOP_INLINE void row(std::uint32_t feature, AxisSlot slot) {
        if (!(features & feature)) return;
        const T along = moving && slot == AxisSlot::lower ? speed + bend : speed;
        solve(slot, aimOfRow<T>(rows, slot, inverseMass, context, moving), along, 1.0f, movable);
    }
    /// All but stops.
    RAGTOP_INLINE void drive() {
        row(AxisRows::kSpring, AxisSlot::spring);
        row(AxisRows::kViscous, AxisSlot::viscous);
        row(AxisRows::kFriction, AxisSlot::friction);
        row(AxisRows::kMotor, AxisSlot::motor);
    }
    /// What keeps it in its range; aim(side) says what a stop asks for.
    template <class Aim>
    RAGTOP_INLINE void keep(Aim&& aim) {
        row(AxisRows::kLocked, AxisSlot::lower);
        if (!(features & AxisRows::kLimit)) return;
        stop(AxisSlot::lower, 1.0f, aim(rows.atLower));
        stop(AxisSlot::upper, -1.0f, aim(rows.atUpper));
    }
    RAGTOP_INLINE void stop(AxisSlot slot, float side, const RowAimOf<T>& aim) {
        const T along = side * (moving ? speed + bend : speed);
        TestOf<T> acts = movable;
        if (!aim.always) acts = acts & mayAct(rows.stopAt(slot), aim, along);
        if (any(acts)) solve(slot, aim, along, side, acts);
    }
};
/// Solves all rows in turn, limits last, and returns the sum of the impulses added. Where positions are to move, what
/// is to stay within a range counts `bend`, by which its mean rate differs from its speed; springs, dampers and motors
/// know how their own motion goes on.
float solveAxis(AxisRows& rows, float speed, const JointContext& context, bool moving, float bend = 0);
/// The same of what keeps it in its range alone.
float solveStops(AxisRows& rows, float speed, const JointContext& context, bool moving, float bend);

}  // namespace ragtop
