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

constexpr float clamp(float value, float lower, float upper) {
    return value < lower ? lower : value > upper ? upper : value;
}

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

bool AxisRows::has(AxisSlot slot) const {
    switch (slot) {
        case AxisSlot::spring:
            return (features & kSpring) != 0;
        case AxisSlot::viscous:
            return (features & kViscous) != 0;
        case AxisSlot::friction:
            return (features & kFriction) != 0;
        case AxisSlot::motor:
            return (features & kMotor) != 0;
        case AxisSlot::lower:
            return (features & (kLimit | kLocked)) != 0;
        case AxisSlot::upper:
            break;
    }
    return (features & kLimit) != 0;
}

float& AxisRows::impulse(AxisSlot slot) {
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
            return atLower.impulse;
        case AxisSlot::upper:
            break;
    }
    return atUpper.impulse;
}

void compile(AxisRows& rows, const AxisSettings& settings) {
    const AxisRows old = rows;
    rows = {};
    rows.features = featuresOf(settings);
    rows.lastAngle = old.lastAngle;
    rows.turns = old.turns;
    rows.tracked = old.tracked;
    rows.features |= old.features & AxisRows::kCoupled;
    rows.coupledImpulse = old.coupledImpulse;
    rows.stop = settings.stop;
    if (settings.turns) rows.atLower.recovery = rows.atUpper.recovery = kTurnRecovery;
    if (settings.limit) {
        rows.lower = settings.limit->lower;
        rows.upper = settings.limit->upper;
    }
    if (settings.motor) {
        rows.targetSpeed = settings.motor->targetSpeed;
        rows.maxForward = settings.motor->maxForce;
        rows.maxReverse = settings.motor->maxReverse.value_or(settings.motor->maxForce);
    }
    if (const auto& spring = settings.spring) {
        rows.stiffness = spring->stiffness;
        rows.damping = spring->damping;
        rows.frequency = spring->frequency;
        rows.dampingRatio = spring->dampingRatio;
        rows.springSpeed = spring->speed;
        rows.feedForward = spring->feedForward;
        rows.maxSpring = spring->maxForce;
        rows.target = settings.target;
    }
    rows.friction = settings.friction;
    if (const auto& bearing = settings.bearing) {
        rows.breakaway = bearing->breakaway;
        rows.viscous = bearing->viscous;
        rows.loadFriction = bearing->coefficient * (settings.turns ? bearing->pinRadius : 1);
    }
    if (((old.features ^ rows.features) & (AxisRows::kLimit | AxisRows::kLocked)) == 0) {
        rows.atLower.impulse = old.atLower.impulse;
        rows.atUpper.impulse = old.atUpper.impulse;
    }
    for (const AxisSlot slot : {AxisSlot::spring, AxisSlot::viscous, AxisSlot::friction, AxisSlot::motor})
        if (rows.has(slot)) rows.impulse(slot) = old.impulse(slot);
}

float axisImpulse(const AxisRows& rows) {
    return rows.springImpulse + rows.viscousImpulse + rows.frictionImpulse + rows.motorImpulse + rows.atLower.impulse -
           rows.atUpper.impulse + rows.coupledImpulse;
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
    std::int32_t turns = rows.turns;
    if (!rows.tracked) {
        turns = turnsInto(rows, static_cast<double>(angle));
    } else if (angle - rows.lastAngle > kPi) {
        --turns;
    } else if (angle - rows.lastAngle < -kPi) {
        ++turns;
    }
    return static_cast<double>(angle) + kTurn * turns;
}

void track(AxisRows& rows, float angle) {
    const double turns = (unwrapped(rows, angle) - static_cast<double>(angle)) / kTurn;
    rows.turns = static_cast<std::int32_t>(turns + (turns < 0 ? -0.5 : 0.5));
    rows.lastAngle = angle;
    rows.tracked = 1;
}

void setMargins(AxisRows& rows, double coordinate) {
    rows.atLower.margin = static_cast<float>(coordinate - static_cast<double>(rows.lower));
    rows.atUpper.margin = static_cast<float>(static_cast<double>(rows.upper) - coordinate);
}

bool DryFriction::begin(float size, float kinetic, float breakaway) {
    slides = bound > 0 && size >= kAtBound * bound ? 1.0f : 0.0f;
    bound = kinetic + (slides > 0 ? 0.0f : breakaway);
    return slides > 0;
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
    const float w = rows.inverseMass, h = context.h;
    if (rows.features & AxisRows::kSpring) {
        const TunedSpring spring = tuned({rows.stiffness, rows.damping}, rows.frequency, rows.dampingRatio, w);
        rows.springStiffness = spring.stiffness;
        rows.springError = static_cast<float>(coordinate - static_cast<double>(rows.target));
        rows.springShare = springShares(spring.stiffness, spring.damping, w, h);
        rows.springStart = speed;
    }
    if (rows.features & AxisRows::kViscous) rows.viscousShare = springShares(0, rows.viscous, w, h);
    if (rows.features & AxisRows::kFriction) {
        const float size = rows.frictionImpulse < 0 ? -rows.frictionImpulse : rows.frictionImpulse;
        const float kinetic = h * rows.friction + rows.loadFriction * reaction;
        if (rows.dry.begin(size, kinetic, h * rows.breakaway)) rows.frictionImpulse *= 0.5f;
    }
    if (rows.features & AxisRows::kMotor) {
        const bool forward = rows.motorImpulse >= kAtBound * h * rows.maxForward && rows.maxForward > 0;
        const bool reverse = rows.motorImpulse <= -kAtBound * h * rows.maxReverse && rows.maxReverse > 0;
        rows.motorStalls = forward ? 1.0f : reverse ? -1.0f : 0.0f;
        if (rows.motorStalls != 0) rows.motorImpulse *= 0.5f;
    }
    return (rows.features & AxisRows::kLimit) != 0 && beginStops(rows, speed, h, bend);
}

RowAim aimOf(const AxisRows& rows, AxisSlot slot, const JointContext& context, bool moving) {
    const float h = context.h;
    RowAim aim;
    switch (slot) {
        case AxisSlot::spring:
            aim.drag = dragOf(moving ? rows.springShare.moving : rows.springShare.resting, rows.inverseMass);
            aim.push = h * (rows.feedForward - rows.springStiffness * rows.springError) + aim.drag * rows.springSpeed;
            aim.upper = h * rows.maxSpring;
            aim.lower = -aim.upper;
            break;
        case AxisSlot::viscous:
            aim.drag = dragOf(moving ? rows.viscousShare.moving : rows.viscousShare.resting, rows.inverseMass);
            break;
        case AxisSlot::friction:
            aim.upper = rows.dry.boundOf(moving);
            aim.lower = -aim.upper;
            break;
        case AxisSlot::motor:
            aim.target = rows.targetSpeed;
            aim.upper = h * rows.maxForward * (moving && rows.motorStalls > 0 ? 0.5f : 1.0f);
            aim.lower = -h * rows.maxReverse * (moving && rows.motorStalls < 0 ? 0.5f : 1.0f);
            break;
        case AxisSlot::lower:
            if (rows.features & AxisRows::kLocked) {
                aim.soft = moving;
                aim.target = moving ? -context.softness.biasRate * rows.atLower.margin : 0.0f;
                break;
            }
            return aimAtStop(rows.atLower, rows.stop, rows.inverseMass, context, moving);
        case AxisSlot::upper:
            return aimAtStop(rows.atUpper, rows.stop, rows.inverseMass, context, moving);
    }
    return aim;
}

/// A spring that acts at the beginning of each substep leaves the speed that was half a substep ago, v + h k C w/2.
/// Within a swing that is of no consequence; what leaves a damped stop leaves it at C = −c v/k and would miss that part
/// for good.
static float dueOnRelease(const StopSide& side, const Stop& stop, float h) {
    const bool letsGo = side.pressed > 0 && !(side.impulse > 0) && !(side.due > 0) && side.startMargin < 0;
    return letsGo ? -0.5f * h * stop.stiffness * side.startMargin : 0.0f;
}

bool beginStop(StopSide& side, const Stop& stop, float speed, const StopTrajectory& course, float h, float bend) {
    const bool jumped = side.rebound > 0 || side.meets > 0;
    const bool struck = jumped ? side.impulse != 0 : side.impulse > 0 && !(side.pressed > 0);
    const float due = jumped ? 0.0f : dueOnRelease(side, stop, h);
    const bool met = side.meets == kArrives;
    side.pressed = met || (side.impulse > 0 && !jumped && !(side.due > 0)) ? 1.0f : 0.0f;
    side.due = due;
    side.meets = 0;
    if (struck) side.impulse = 0;
    if (jumped) side.wasSeen = 0;
    side.rebound = 0;
    side.startMargin = side.margin;
    if (!(stop.stiffness > 0) && !(stop.restitution > 0)) return struck;
    const float gained = side.wasSeen > 0 ? speed - side.lastSpeed : 0.0f;
    side.lastSpeed = speed;
    side.wasSeen = 1;
    side.share = 0;
    // Some forces have acted on this speed already and some have not: half of what they give is nearest to both.
    const float approach = -(speed + 0.5f * gained), change = gained < 0 ? -gained : gained;
    if (stop.stiffness > 0) {
        const float along = bend + (side.margin < 0 ? speed : -approach);
        const SoftMeeting meeting = course.meet(side.margin, along, side.pressed > 0);
        if (meeting.meets) {
            side.meets = meeting.crosses ? kCrosses : meeting.leaves ? kLeaves : kArrives;
            side.due = 0;
            side.landing = meeting.mean, side.leaving = meeting.last + bend;
            return struck;
        }
        // A soft stop that is reached on the way acts for the rest of the substep.
        if (side.margin >= 0 && side.margin < h * approach) side.share = 1 - side.margin / (h * approach);
        return struck;
    }
    if (side.pressed > 0 || !(stop.restitution > 0)) return struck;
    // What may reach the end does so in this substep: stopped there without a rebound, it would be at rest in the next.
    if (!(approach > kRestingRebound * change) || side.margin >= h * (approach + change)) return struck;
    const float toEnd = side.margin > 0 ? side.margin / approach : 0.0f, before = toEnd < h ? toEnd : h;
    side.rebound = stop.restitution * approach;
    side.landing = (side.rebound * (h - before) - side.margin) / h;
    return struck;
}

namespace {

/// A damped spring beyond the end: for the whole substep, or from where it is reached on the way.
RowAim aimAtSoftStop(const StopSide& side, const Stop& stop, float inverseMass, float h, bool moving) {
    RowAim aim;
    aim.lower = 0;
    if (side.meets > 0) {
        aim.target = moving ? side.landing : side.leaving;
    } else if (side.due > 0) {
        aim.push = side.due;
        aim.drag = 0;
    } else if (side.startMargin < 0) {
        const SpringShares shares = springShares(stop.stiffness, stop.damping, inverseMass, h);
        aim.push = -h * stop.stiffness * side.startMargin;
        aim.drag = dragOf(moving ? shares.moving : shares.resting, inverseMass);
    } else if (side.share > 0) {
        const SpringShares shares = springShares(stop.stiffness, stop.damping, inverseMass, side.share * h);
        aim.drag = dragOf(moving ? 1 - side.share * (1 - shares.moving) : shares.resting, inverseMass);
    } else {
        aim.upper = 0;
    }
    return aim;
}

}  // namespace

RowAim aimAtStop(const StopSide& side, const Stop& stop, float inverseMass, const JointContext& context, bool moving) {
    RowAim aim;
    aim.lower = 0;
    if (stop.stiffness > 0) return aimAtSoftStop(side, stop, inverseMass, context.h, moving);
    if (side.rebound > 0) {
        aim.target = moving ? side.landing : side.rebound;
    } else if (moving && side.margin > 0) {
        aim.target = -side.margin * context.inverseH;
    } else if (moving) {
        // With the leak of soft rows a limit under weight would stand passed by λ/(m h ω²).
        aim.soft = !context.ofFreeTree;
        const float rate = context.ofFreeTree ? kStopRate * context.softness.biasRate : context.softness.biasRate;
        const float recovery = -rate * side.margin, fastest = side.recovery * context.inverseH;
        aim.target = recovery < fastest ? recovery : fastest;
    } else if (side.margin > 0 && !(side.impulse > 0)) {
        // What was not stopped while it moved has its speed still; the next substep stops it where it is to stop.
        aim.upper = 0;
    }
    return aim;
}

bool mayAct(const StopSide& side, const Stop& stop, float speed, const JointContext& context, bool moving) {
    if (stop.stiffness > 0 || side.impulse > 0) return true;
    const RowAim aim = aimAtStop(side, stop, 0, context, moving);
    return aim.upper > 0 && speed < aim.target;
}

float solveRow(float& impulse, const RowAim& aim, float speed, float inverseMass, const JointContext& context) {
    const float old = impulse;
    float solved;
    if (aim.drag >= 0) {
        solved = (aim.push - aim.drag * (speed - inverseMass * old)) / (1 + inverseMass * aim.drag);
    } else {
        const Softness soft = aim.soft ? context.softness : kRigid;
        solved = old - soft.massScale * (speed - aim.target) / inverseMass - soft.impulseScale * old;
    }
    impulse = clamp(solved, aim.lower, aim.upper);
    return impulse - old;
}

static float solveSlots(AxisRows& rows, AxisSlot first, float speed, const JointContext& context, bool moving,
                        float bend) {
    const float w = rows.inverseMass;
    if (!(w > 0) || rows.features == 0) return 0;
    float total = 0;
    for (int i = static_cast<int>(first); i < kAxisSlots; ++i) {
        const auto slot = static_cast<AxisSlot>(i);
        if (!rows.has(slot)) continue;
        const float side = slot == AxisSlot::upper ? -1.0f : 1.0f;
        const float along = side * (moving && slot >= AxisSlot::lower ? speed + bend : speed);
        if (rows.isStop(slot) && !mayAct(rows.stopAt(slot), rows.stop, along, context, moving)) continue;
        const float delta = side * solveRow(rows.impulse(slot), aimOf(rows, slot, context, moving), along, w, context);
        total += delta;
        speed += w * delta;
    }
    return total;
}

float solveAxis(AxisRows& rows, float speed, const JointContext& context, bool moving, float bend) {
    return solveSlots(rows, AxisSlot::spring, speed, context, moving, bend);
}

float solveStops(AxisRows& rows, float speed, const JointContext& context, bool moving, float bend) {
    return solveSlots(rows, AxisSlot::lower, speed, context, moving, bend);
}

float wrapAbout(float angle, float center) {
    const float x = angle - center;
    if (x > kPi) return angle - 2 * kPi;
    if (x <= -kPi) return angle + 2 * kPi;
    return angle;
}

}  // namespace ragtop
