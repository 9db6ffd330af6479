// Scalar rows along one free coordinate x of a joint: limits, spring, friction, damping and motor. Each says what it
// asks for in a pass as a RowAim, a speed or λ = push − drag u between bounds; iteration solves it at once, direct
// solvers make a row of theirs of it.
//   hard limit   u ≥ −margin/h;  with restitution e it is left at −e u₀ from the time within the substep when it is met
//   soft limit   the damped spring beyond the end, for the part of the substep that it is pressed (stop_trajectory.h)
//   spring       λ = −h k C − drag u, the drags of both passes from springShares
//   friction     |λ| ≤ h F, F dry friction, breakaway at rest and a share of the reaction;  viscous: λ = −drag u
//   motor        u = target with |λ| ≤ h F

#include "constraints/axis_rows.h"

#include <cmath>

#include "constraints/joint_constants.h"
#include "constraints/rows.h"
#include "constraints/stop_trajectory.h"

namespace ragtop {
namespace {

std::uint32_t featuresOf(const AxisSettings& settings) {
    std::uint32_t features = 0;
    if (settings.limit)
        features |= settings.limit->lower == settings.limit->upper ? AxisRows::kLocked : AxisRows::kLimit;
    if (settings.motor) features |= AxisRows::kMotor;
    if (settings.spring) features |= AxisRows::kSpring;
    const Bearing bearing = settings.bearing.value_or(Bearing{});
    if (settings.friction > 0 || bearing.breakaway > 0 || bearing.coefficient > 0) features |= AxisRows::kFriction;
    if (bearing.viscous > 0) features |= AxisRows::kViscous;
    return features;
}

}  // namespace

void compile(AxisRows& rows, const AxisSettings& settings) {
    const AxisRows old = rows;
    rows = {};
    rows.features = featuresOf(settings);
    rows.angle = old.angle;
    rows.features |= old.features & AxisRows::kCoupled;
    rows.coupledImpulse = old.coupledImpulse;
    rows.stop = settings.stop;
    if (settings.turns) rows.atLower.recovery = rows.atUpper.recovery = kTurnRecovery;
    if (settings.limit) {
        rows.lower = settings.limit->lower;
        rows.upper = settings.limit->upper;
    }
    if (settings.motor) {
        const Motor& motor = *settings.motor;
        rows.motor = {motor.targetSpeed, motor.maxForce, motor.maxReverse.value_or(motor.maxForce)};
    }
    if (const auto& spring = settings.spring) {
        rows.spring = {tuningOf(*spring), settings.target, spring->speed, spring->feedForward, spring->maxForce};
    }
    rows.resistance.friction = settings.friction;
    if (const auto& bearing = settings.bearing) {
        rows.resistance.breakaway = bearing->breakaway;
        rows.resistance.viscous = bearing->viscous;
        rows.resistance.loadFriction = bearing->coefficient * (settings.turns ? bearing->pinRadius : 1);
    }
    if (((old.features ^ rows.features) & (AxisRows::kLimit | AxisRows::kLocked)) == 0) {
        rows.atLower.impulse = old.atLower.impulse;
        rows.atUpper.impulse = old.atUpper.impulse;
    }
    for (const AxisSlot slot : {AxisSlot::spring, AxisSlot::viscous, AxisSlot::friction, AxisSlot::motor})
        if (rows.has(slot)) rows.impulse(slot) = old.impulse(slot);
}

void rescale(AxisRows& rows, float ratio) {
    for (int slot = 0; slot < kAxisSlots; ++slot) rescale(rows.impulse(static_cast<AxisSlot>(slot)), ratio);
    rescale(rows.dry.bound, ratio);
    rescale(rows.coupledImpulse, ratio);
}

/// The turns that bring an angle nearest to its range, none where it is within.
static std::int32_t turnsInto(const AxisRows& rows, double angle) {
    if (!(rows.features & (AxisRows::kLimit | AxisRows::kLocked))) return 0;
    const double lower = rows.lower, upper = rows.upper;
    const auto beyond = [&](double x) { return x < lower ? lower - x : x > upper ? x - upper : 0.0; };
    const double wanted = angle < lower ? lower : upper;
    if (beyond(angle) == 0) return 0;
    const auto below = static_cast<std::int32_t>(std::floor((wanted - angle) / kTurn));
    return beyond(angle + kTurn * below) <= beyond(angle + kTurn * (below + 1)) ? below : below + 1;
}

double unwrapped(const AxisRows& rows, float angle) {
    std::int32_t turns = rows.angle.turns;
    if (!rows.angle.tracked) {
        turns = turnsInto(rows, static_cast<double>(angle));
    } else if (angle - rows.angle.last > kPi) {
        --turns;
    } else if (angle - rows.angle.last < -kPi) {
        ++turns;
    }
    return static_cast<double>(angle) + kTurn * turns;
}

void track(AxisRows& rows, float angle) {
    const double turns = (unwrapped(rows, angle) - static_cast<double>(angle)) / kTurn;
    rows.angle.turns = static_cast<std::int32_t>(turns + (turns < 0 ? -0.5 : 0.5));
    rows.angle.last = angle;
    rows.angle.tracked = 1;
}

void setMargins(AxisRows& rows, double coordinate) {
    rows.atLower.margin = static_cast<float>(coordinate - static_cast<double>(rows.lower));
    rows.atUpper.margin = static_cast<float>(static_cast<double>(rows.upper) - coordinate);
}

/// kLeaves, and what is left leads into the stop at the other end.
static constexpr float kCrosses = 3;

/// What is held by one stop meets the other where its trajectory leads, not where the speed of now would; and what the
/// one has given to that speed goes on for no longer than it holds.
static void leadTo(StopSide& other, StopSide& held) {
    const bool crosses = held.meets == kCrosses;
    if (crosses) held.meets = kLeaves;
    other.share = other.wasSeen = 0;
    other.meets = crosses ? kArrives : 0.0f;
    other.landing = -held.landing, other.leaving = -held.leaving;
}

static bool beginStops(AxisRows& rows, float speed, float h, float bend) {
    StopSide &lower = rows.atLower, &upper = rows.atUpper;
    StopTrajectory course;
    if (rows.stop.stiffness > 0) course = {rows.stop, rows.inverseMass, h, rows.upper - rows.lower};
    const bool struckLower = beginStop(lower, rows.stop, speed, course, h, bend);
    const bool struckUpper = beginStop(upper, rows.stop, -speed, course, h, -bend);
    const auto held = [&](const StopSide& side) {
        return course.follows() && side.margin < 0 && (side.meets > 0 || side.pressed > 0);
    };
    if (held(lower)) {
        leadTo(upper, lower);
    } else if (held(upper)) {
        leadTo(lower, upper);
    }
    return struckLower || struckUpper;
}

bool beginAxis(AxisRows& rows, double coordinate, float speed, float reaction, const JointContext& context,
               float bend) {
    const auto error = static_cast<float>(coordinate - static_cast<double>(rows.spring.target));
    beginRows(rows, rows.features, error, speed, reaction, rows.inverseMass, context.h);
    return (rows.features & AxisRows::kLimit) != 0 && beginStops(rows, speed, context.h, bend);
}

RowAim aimOf(const AxisRows& rows, AxisSlot slot, const JointContext& context, bool moving) {
    if (rows.isStop(slot)) return aimAtStop(rows.stopAt(slot), rows.stop, rows.inverseMass, context, moving);
    return aimOfRow(rows, slot, rows.inverseMass, context, moving);
}

/// A spring that acts at the beginning of each substep leaves the speed that was half a substep ago, v + h k C w/2.
/// Within a swing that is of no consequence; what leaves a damped stop leaves it at C = −c v/k and would miss that part
/// for good.
static float dueOnRelease(const StopSide& side, const Stop& stop, float h) {
    const bool letsGo = side.pressed > 0 && !(side.impulse > 0) && !(side.due > 0) && side.startMargin < 0;
    return letsGo ? -0.5f * h * stop.stiffness * side.startMargin : 0.0f;
}

static bool beginSoftStop(StopSide& side, const Stop& stop, float speed, const StopTrajectory& course, float h,
                          float bend) {
    const bool jumped = side.meets > 0;
    const bool struck = jumped ? side.impulse != 0 : side.impulse > 0 && !(side.pressed > 0);
    const float due = jumped ? 0.0f : dueOnRelease(side, stop, h);
    const bool met = side.meets == kArrives;
    side.pressed = met || (side.impulse > 0 && !jumped && !(side.due > 0)) ? 1.0f : 0.0f;
    side.due = due;
    side.meets = 0;
    if (struck) side.impulse = 0;
    if (jumped) side.wasSeen = 0;
    side.startMargin = side.margin;
    const float gained = side.wasSeen > 0 ? speed - side.lastSpeed : 0.0f, approach = -(speed + 0.5f * gained);
    side.lastSpeed = speed;
    side.wasSeen = 1;
    side.share = 0;
    const SoftMeeting meeting = course.meet(side.margin, bend + speed, side.pressed > 0);
    if (meeting.meets) {
        side.meets = meeting.crosses ? kCrosses : meeting.leaves ? kLeaves : kArrives;
        side.due = 0;
        side.landing = meeting.mean, side.leaving = meeting.last + bend;
    } else if (!course.follows() && side.margin >= 0 && side.margin < h * approach) {
        // A soft stop that is reached on the way acts for the rest of the substep.
        side.share = 1 - side.margin / (h * approach);
    }
    return struck;
}

bool beginStop(StopSide& side, const Stop& stop, float speed, const StopTrajectory& course, float h, float bend) {
    if (stop.stiffness > 0) return beginSoftStop(side, stop, speed, course, h, bend);
    side.startMargin = side.margin;
    return beginHardStop(side, stop.restitution, stop.restitution > 0, speed, h);
}

namespace {

/// A damped spring beyond the end: for the whole substep, or from where it is reached on the way.
RowAim aimAtSoftStop(const StopSide& side, const Stop& stop, float inverseMass, float h, bool moving) {
    RowAim aim;
    aim.lower = 0;
    aim.always = true;
    if (side.meets > 0) {
        aim.target = moving ? side.landing : side.leaving;
        // Rows lag behind their place: what has just met a stop is to leave faster than it came.
        if (!moving && side.meets == kArrives) aim.lower = -kNoForceLimit;
    } else if (side.due > 0) {
        aim.push = side.due;
        aim.drag = 0;
        aim.compliant = true;
    } else if (side.startMargin < 0) {
        const SpringShares shares = springShares(stop.stiffness, stop.damping, inverseMass, h);
        aim.push = -h * stop.stiffness * side.startMargin;
        aim.drag = dragOf(moving ? shares.moving : shares.resting, inverseMass);
        aim.compliant = true;
    } else if (side.share > 0) {
        const SpringShares shares = springShares(stop.stiffness, stop.damping, inverseMass, side.share * h);
        aim.drag = dragOf(moving ? 1 - side.share * (1 - shares.moving) : shares.resting, inverseMass);
        aim.compliant = true;
    } else {
        aim.upper = 0;
    }
    return aim;
}

}  // namespace

RowAim aimAtStop(const StopSide& side, const Stop& stop, float inverseMass, const JointContext& context, bool moving) {
    if (stop.stiffness > 0) return aimAtSoftStop(side, stop, inverseMass, context.h, moving);
    return aimAtHardStop(side, true, context.ofFreeTree, context, moving);
}

static float solveRows(AxisRows& rows, bool drives, float speed, const JointContext& context, bool moving, float bend) {
    const float w = rows.inverseMass;
    if (!(w > 0) || rows.features == 0) return 0;
    AxisPassOf<float> pass{rows, rows.features, context, moving, w, speed, bend, true};
    if (drives) pass.drive();
    pass.keep([&](const StopSide& side) { return aimAtStop(side, rows.stop, w, context, moving); });
    return pass.total;
}

float solveAxis(AxisRows& rows, float speed, const JointContext& context, bool moving, float bend) {
    return solveRows(rows, true, speed, context, moving, bend);
}

float solveStops(AxisRows& rows, float speed, const JointContext& context, bool moving, float bend) {
    return solveRows(rows, false, speed, context, moving, bend);
}

}  // namespace ragtop
