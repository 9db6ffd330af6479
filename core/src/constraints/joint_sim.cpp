#include "constraints/joint_sim.h"

#include "constraints/joint_types.h"

namespace ragtop {
namespace {

const JointBodies& bodiesOf(const JointDef& def) {
    return std::visit([](const auto& d) -> const JointBodies& { return d.bodies; }, def);
}

/// A whole turn is no limit.
std::optional<Range> angleLimit(const std::optional<Range>& limit) {
    return limit && limit->upper - limit->lower < 2 * kPi ? limit : std::nullopt;
}

void compileBall(const BallDef& def, BallRows& rows) {
    const BallRows old = rows;
    rows = {};
    if (def.swingLimit) {
        rows.features |= BallRows::kSwing;
        rows.swingLimit = *def.swingLimit;
        rows.swingImpulse = old.swingImpulse;
    }
    if (angleLimit(def.twistLimit)) {
        rows.features |= BallRows::kTwist;
        rows.twistLimit = *def.twistLimit;
        rows.twistLowerImpulse = old.twistLowerImpulse;
        rows.twistUpperImpulse = old.twistUpperImpulse;
    }
    if (def.spring) {
        rows.features |= BallRows::kSpring;
        rows.stiffness = def.spring->stiffness;
        rows.damping = def.spring->damping;
        rows.target = normalized(def.target);
        rows.maxSpringTorque = def.maxSpringTorque;
        rows.springImpulse = old.springImpulse;
    }
    if (def.friction > 0) {
        rows.features |= BallRows::kFriction;
        rows.friction = def.friction;
        rows.frictionImpulse = old.frictionImpulse;
    }
}

JointPlace locate(JointSim& joint, const BodyPair& pair) {
    const BodyState &a = pair.stateA(), &b = pair.stateB();
    const Vec3 anchorA = rotate(a.dq, joint.anchorA), anchorB = rotate(b.dq, joint.anchorB);
    const Vec3 gap = joint.centerOffset + (b.dp - a.dp) + (anchorB - anchorA);
    joint.arms = {anchorA + 0.5f * gap, anchorB - 0.5f * gap};
    return {a.dq * joint.frameA, b.dq * joint.frameB, gap};
}

void refresh(JointSim& joint, const JointPlace& now, const BodyPair& pair, bool begins) {
    switch (joint.kind) {
        case JointKind::none:
            break;
        case JointKind::ball:
            refreshBall(joint, now, pair, begins);
            break;
        case JointKind::hinge:
            refreshHinge(joint, now, pair, begins);
            break;
        case JointKind::slider:
            refreshSlider(joint, now, pair, begins);
            break;
        case JointKind::fixed:
            refreshFixed(joint, now, pair);
            break;
        case JointKind::distance:
            refreshDistance(joint, now, pair, begins);
            break;
    }
}

}  // namespace

void refreshJoint(JointSim& joint, const BodyPair& pair, bool begins) {
    refresh(joint, locate(joint, pair), pair, begins);
}

void setMargins(AxisRows& rows, float coordinate, bool isAngle) {
    if (!(rows.features & (AxisRows::kLimit | AxisRows::kLocked))) return;
    const float x = isAngle ? wrapAbout(coordinate, 0.5f * (rows.lower + rows.upper)) : coordinate;
    rows.lowerMargin = x - rows.lower;
    rows.upperMargin = rows.upper - x;
}

void compileJoint(const JointDef& def, const Vec3& centerA, const Vec3& centerB, JointSim& into) {
    const auto kind = static_cast<JointKind>(def.index() + 1);
    if (into.kind != kind) {
        const std::uint32_t a = into.stateA, b = into.stateB;
        into = {};
        into.stateA = a;
        into.stateB = b;
        into.kind = kind;
        // A distance has no direction yet; a ball's rows stay in world axes.
        if (kind == JointKind::distance) into.block.basis.cz = {};
    }
    const JointBodies& bodies = bodiesOf(def);
    into.localA = {bodies.frameA.position - centerA, normalized(bodies.frameA.rotation)};
    into.localB = {bodies.frameB.position - centerB, normalized(bodies.frameB.rotation)};
    into.block.linearFirst = kind == JointKind::slider ? 0 : 1;
    into.block.rigidRows = kind == JointKind::fixed ? 3 : kind == JointKind::hinge || kind == JointKind::slider ? 2 : 0;
    if (const auto* ball = std::get_if<BallDef>(&def)) {
        compileBall(*ball, into.ball);
    } else if (const auto* hinge = std::get_if<HingeDef>(&def)) {
        compile(into.axis, angleLimit(hinge->limit), hinge->motor, hinge->spring, hinge->target, hinge->friction);
    } else if (const auto* slider = std::get_if<SliderDef>(&def)) {
        compile(into.axis, slider->limit, slider->motor, slider->spring, slider->target, slider->friction);
    } else if (const auto* distance = std::get_if<DistanceDef>(&def)) {
        compile(into.axis, distance->limit, {}, distance->spring, distance->rest, 0);
    }
}

void prepareJoint(JointSim& joint, const JointBodiesAtStep& bodies, const BodyState*, const BodyInertia*,
                  const JointContext&) {
    joint.centerOffset = bodies.centerOffset;
    joint.anchorA = rotate(bodies.rotationA, joint.localA.position);
    joint.anchorB = rotate(bodies.rotationB, joint.localB.position);
    joint.frameA = bodies.rotationA * joint.localA.rotation;
    joint.frameB = bodies.rotationB * joint.localB.rotation;
}

PairVector carriedImpulse(const JointSim& joint) {
    PairVector sum = blockImpulse(joint.block);
    const Vec3 alongAxis = axisImpulse(joint.axis) * joint.block.basis.cz;
    switch (joint.kind) {
        case JointKind::hinge:
            sum.angular += alongAxis;
            break;
        case JointKind::slider:
        case JointKind::distance:
            sum.linear += alongAxis;
            break;
        case JointKind::ball:
            sum.angular += turningImpulse(joint.ball);
            break;
        case JointKind::fixed:
        case JointKind::none:
            break;
    }
    return sum;
}

void warmStartJoint(JointSim& joint, BodyState* states, const BodyInertia* inertia, const JointContext& context) {
    BodyPair pair(states, inertia, joint.stateA, joint.stateB, joint.taut);
    const JointPlace now = locate(joint, pair);
    pair.stiffen(joint.arms, carriedImpulse(joint).linear, context.h, joint.taut);
    refresh(joint, now, pair, true);
    pair.apply(joint.arms, carriedImpulse(joint));
    pair.store();
}

void solveBlockAndAxis(JointSim& joint, BodyPair& pair, const JointContext& context, bool useBias) {
    RigidBlock& block = joint.block;
    solveBlock(block, pair, joint.arms, useBias ? context.softness : kRigid);
    const float mass = block.second.inverse[2];
    if (joint.axis.features == 0 || !(mass > 0)) return;
    const PairVector u = pair.velocity(joint.arms);
    const float speed = dot(block.basis.cz, block.linearFirst ? u.angular : u.linear);
    const float amount = solveAxis(joint.axis, speed, 1 / mass, context, useBias);
    pair.apply(joint.arms, freeImpulse(block, amount));
}

void solveJoint(JointSim& joint, BodyState* states, const BodyInertia* inertia, const JointContext& context,
                bool useBias) {
    BodyPair pair(states, inertia, joint.stateA, joint.stateB, joint.taut);
    if (!useBias) refreshJoint(joint, pair, false);
    switch (joint.kind) {
        case JointKind::none:
            break;
        case JointKind::ball:
            solveBall(joint, pair, context, useBias);
            break;
        case JointKind::hinge:
        case JointKind::slider:
            solveBlockAndAxis(joint, pair, context, useBias);
            break;
        case JointKind::fixed:
            solveBlock(joint.block, pair, joint.arms, useBias ? context.softness : kRigid);
            break;
        case JointKind::distance:
            solveDistance(joint, pair, context, useBias);
            break;
    }
    pair.store();
}

void rescaleJoint(JointSim& joint, float ratio) {
    joint.block.impulseFirst *= ratio;
    joint.block.impulseSecond *= ratio;
    rescale(joint.axis, ratio);
    BallRows& ball = joint.ball;
    ball.springImpulse *= ratio;
    ball.frictionImpulse *= ratio;
    ball.swingImpulse *= ratio;
    ball.twistLowerImpulse *= ratio;
    ball.twistUpperImpulse *= ratio;
}

}  // namespace ragtop
