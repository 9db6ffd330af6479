#include "constraints/soft_stops.h"

#include "constraints/spring_lead.h"
#include "constraints/stop_trajectory.h"

namespace ragtop {
namespace {

/// A spring beside it counts the stop as its load.
bool leads(const AxisRows& axis) { return hasSoftStops(axis) && (axis.features & AxisRows::kSpring) == 0; }

bool isPressed(const StopSide& side) { return side.margin < 0 && (side.impulse > 0 || side.meets == kArrives); }

/// What else acts in a substep, as far as it did when the step before ended: an impact is over.
float steadyOf(float now, float before) {
    if (!(now * before > 0)) return 0;
    return now * now < before * before ? now : before;
}
Vec3 steadyOf(const Vec3& now, const Vec3& before) {
    const float square = lengthSquared(now), along = dot(now, before);
    return !(along > 0) ? Vec3{} : along < square ? (along / square) * now : now;
}

/// By what the speed of a margin in its place exceeds that of rows, where a stop holds it: `load`, N s or N m s per
/// substep, is what presses it on.
float leadOf(const StopSide& side, const Stop& stop, float inverseMass, float speed, float load, float h) {
    if (!isPressed(side)) return 0;
    const float push = -h * stop.stiffness * side.margin, held = push + (load < 0 ? load : 0.0f);
    if (!(held > 0)) return 0;
    const StopTrajectory course(stop, inverseMass, h, 0);
    if (!course.follows()) return leadShare(stop.stiffness, stop.damping, inverseMass, h) * inverseMass * held;
    const double row = speed, fromRest = -static_cast<double>(held / (h * stop.stiffness));
    return static_cast<float>(course.speedAt(fromRest, row) - row);
}

float leadAxis(AxisRows& axis, float speed, float kick, float h) {
    const bool atLower = isPressed(axis.atLower), pressed = atLower || isPressed(axis.atUpper);
    const float w = axis.inverseMass, sign = atLower ? 1.0f : -1.0f, before = axis.springLoad;
    const StopSide& side = atLower ? axis.atLower : axis.atUpper;
    axis.springLoad = pressed ? (speed + kick - sign * side.lastSpeed) / w - sign * side.impulse : 0.0f;
    return sign * leadOf(side, axis.stop, w, sign * speed, sign * steadyOf(axis.springLoad, before), h);
}

/// Pushes of sides that are pressed together add up, as those of the half substep that they stand for.
PairVector leadBall(JointSim& joint, const BodyPair& pair, const PairVector& kick, float h) {
    const RigidBlock& block = joint.block;
    BallRows& rows = joint.ball;
    const Vec3 spin = pair.velocity(joint.arms).angular, before = rows.springLoad;
    rows.springLoad = solve(block.second, spin - rows.springStart + kick.angular);
    eachSide(rows, [&](const StopSide& side, const Vec3& axis) { rows.springLoad -= side.impulse * axis; });
    const Vec3 load = steadyOf(rows.springLoad, before);
    Vec3 torque;
    eachSide(rows, [&](const StopSide& side, const Vec3& axis) {
        const Vec3 answer = block.mass.rest * axis;
        const float inverseMass = dot(axis, answer);
        if (!(inverseMass > block.noise)) return;
        const float pressing = dot(answer, load) / inverseMass;
        const float lead = leadOf(side, rows.stop, inverseMass, dot(axis, spin), pressing, h);
        torque += (lead / inverseMass) * axis;
    });
    return {-(block.mass.gain * torque), torque};
}

}  // namespace

PairVector impulseAlong(JointSim& joint, std::uint32_t coordinate, float amount) {
    if (joint.kind == JointKind::distance) return {amount * joint.block.basis.cz, {}};
    if (hasAxes(joint.kind)) {
        AxesBlock axes = withAxes(joint).axes;
        return freeImpulse(axes, coordinate, amount);
    }
    RigidBlock& block = joint.block;
    const Vec3 first = block.impulseFirst, second = block.impulseSecond;
    const PairVector impulse = freeImpulse(block, amount);
    block.impulseFirst = first;
    block.impulseSecond = second;
    return impulse;
}

bool hasSoftStops(const JointSim& joint) {
    if (joint.kind == JointKind::ball) {
        constexpr std::uint32_t kStops = BallRows::kSwing | BallRows::kTwist;
        constexpr std::uint32_t kSprings = BallRows::kSpring | BallRows::kDrives;
        const BallRows& rows = joint.ball;
        return rows.stop.stiffness > 0 && (rows.features & kStops) != 0 && (rows.features & kSprings) == 0;
    }
    bool any = false;
    eachAxis(joint, [&](const AxisRows& axis, const PairVector&) {
        const bool soft = axis.stop.stiffness > 0 && (axis.features & AxisRows::kLimit) != 0;
        any = any || (soft && (axis.features & AxisRows::kSpring) == 0);
    });
    return any;
}

PairVector leadStops(JointSim& joint, const BodyPair& pair, const PairVector& kick, float h) {
    if (joint.kind == JointKind::ball) return leadBall(joint, pair, kick, h);
    const PairVector u = pair.velocity(joint.arms);
    PairVector total;
    std::uint32_t index = 0;
    eachAxis(joint, [&](AxisRows& axis, const PairVector& along) {
        const std::uint32_t coordinate = index++;
        if (!leads(axis)) return;
        const float speed = speedAlong(along, u), lead = leadAxis(axis, speed, speedAlong(along, kick), h);
        if (lead == 0) return;
        const PairVector impulse = impulseAlong(joint, coordinate, lead / axis.inverseMass);
        total.linear += impulse.linear;
        total.angular += impulse.angular;
    });
    return total;
}

}  // namespace ragtop
