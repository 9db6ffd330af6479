#include <algorithm>
#include <limits>

#include "constraints/joint_types.h"

namespace ragtop {
namespace {

constexpr float kNoLimit = std::numeric_limits<float>::infinity();

/// Distance of the coordinate to the nearer limit; of a locked one, minus its distance from where it is held.
float limitMargin(AxisRows rows, double coordinate) {
    if (!(rows.features & (AxisRows::kLimit | AxisRows::kLocked))) return kNoLimit;
    setMargins(rows, coordinate);
    return rows.atLower.margin < rows.atUpper.margin ? rows.atLower.margin : rows.atUpper.margin;
}

struct Relative {
    Vec3 gap;           // m
    Vec3 speed;         // m/s, of B's anchor relative to A's
    Vec3 angularSpeed;  // rad/s
    Quat a, b;
};

void reportBall(const BallRows& rows, const Relative& at, JointState& state) {
    const SwingTwist angles = swingTwist(at.a, at.b);
    state.coordinate = angles.twist;
    state.swing = angles.swing;
    const Vec3 axis = twistAxis(rotate(at.a, {1, 0, 0}), rotate(at.b, {1, 0, 0}));
    if (angles.cosHalfSwing > 0) state.speed = dot(axis, at.angularSpeed) / angles.cosHalfSwing;
    state.gap = length(at.gap);
    state.limitMargin = kNoLimit;
    const Vec3 d = inverseRotate(at.a, rotate(at.b, {1, 0, 0}));
    const auto reach = [&](float margin) {
        if (margin < state.limitMargin) state.limitMargin = margin;
    };
    SwingMargin sides[SwingLimit::kSides];
    swingMargins(rows.swingLimit, d, sides);
    for (const SwingMargin& side : sides) reach(side.margin);
    if (rows.features & BallRows::kTwist) {
        const Range range = twistRange(rows, d);
        const float twist = wrapAbout(angles.twist, 0.5f * (range.lower + range.upper));
        reach(twist - range.lower);
        reach(range.upper - twist);
    }
}

void reportSlider(const AxisRows& rows, const Relative& at, const Vec3& angularSpeedA, JointState& state) {
    const Vec3 x = rotate(at.a, {1, 0, 0});
    state.coordinate = dot(x, at.gap);
    // d/dt (x · gap), where x turns with A.
    state.speed = dot(x, at.speed - cross(angularSpeedA, at.gap));
    state.gap = length(at.gap - state.coordinate * x);
    state.limitMargin = limitMargin(rows, static_cast<double>(state.coordinate));
}

void reportDistance(const AxisRows& rows, const Relative& at, JointState& state) {
    state.coordinate = length(at.gap);
    state.speed = dot(normalized(at.gap, {}), at.speed);
    state.limitMargin = limitMargin(rows, static_cast<double>(state.coordinate));
    // What a rod or rope holds together has a gap only where it is stretched or pressed beyond its range.
    state.gap = state.limitMargin < 0 ? -state.limitMargin : 0.0f;
}

}  // namespace

JointState jointState(const JointSim& joint, const JointBodiesAtStep& atEnd, const BodyState* states,
                      float inverseSubstep) {
    const Vec3 anchorA = rotate(atEnd.rotationA, joint.localA.position);
    const Vec3 anchorB = rotate(atEnd.rotationB, joint.localB.position);
    const BodyState &a = states[joint.stateA], &b = states[joint.stateB];
    Relative at;
    at.gap = atEnd.centerOffset + (anchorB - anchorA);
    at.speed = (b.v + cross(b.w, anchorB)) - (a.v + cross(a.w, anchorA));
    at.angularSpeed = b.w - a.w;
    at.a = atEnd.rotationA * joint.localA.rotation;
    at.b = atEnd.rotationB * joint.localB.rotation;

    JointState state;
    const PairVector impulse = warmStartImpulse(joint);
    state.force = inverseSubstep * impulse.linear;
    // The force acts at the shared point, half the gap away from B's anchor.
    state.torque = inverseSubstep * impulse.angular - cross(0.5f * at.gap, state.force);
    state.gap = length(at.gap);
    state.limitMargin = kNoLimit;
    switch (joint.kind) {
        case JointKind::ball:
            reportBall(joint.ball, at, state);
            break;
        case JointKind::hinge: {
            const double angle = unwrapped(joint.axis, hingeAngle(at.a, at.b));
            state.coordinate = static_cast<float>(angle);
            state.speed = dot(rotate(at.b, {1, 0, 0}), at.angularSpeed);
            state.limitMargin = limitMargin(joint.axis, angle);
            break;
        }
        case JointKind::slider:
            reportSlider(joint.axis, at, a.w, state);
            break;
        case JointKind::distance:
            reportDistance(joint.axis, at, state);
            break;
        case JointKind::fixed:
        case JointKind::none:
            break;
        default: {
            const Vec3 middle = at.speed - 0.5f * cross(a.w + b.w, at.gap);
            reportAxes(joint, {at.a, at.b, at.gap}, {middle, at.angularSpeed}, state);
            break;
        }
    }
    return state;
}

float turnedApart(const JointSim& sim, const JointBodiesAtStep& at) {
    const Quat a = at.rotationA * sim.localA.rotation, b = at.rotationB * sim.localB.rotation;
    switch (sim.kind) {
        case JointKind::hinge:
            return length(axisX(b) - axisX(a));
        case JointKind::fixed:
        case JointKind::slider:
            return length(turnVector(b * conjugate(a)));
        default:
            return 0;
    }
}

Opening openingOf(const JointSim& joint, const JointState& state, const JointBodiesAtStep& at) {
    Opening opening{state.gap, turnedApart(joint, at)};
    const float beyond = std::max(0.0f, -state.limitMargin);
    float& limited = joint.kind == JointKind::hinge || joint.kind == JointKind::ball ? opening.turn : opening.way;
    limited = std::max(limited, beyond);
    return opening;
}

}  // namespace ragtop
