// A joint in the solver: compiled from its definition, refreshed and warm started once per substep, solved in the
// soft and the relaxing pass. What depends on the kind of joint is in joint_<kind>.cpp; the switches over the kinds
// are here.

#include "constraints/joint_sim.h"

#include <utility>

#include "constraints/joint_constants.h"
#include "constraints/joint_types.h"

namespace ragtop {
namespace {

const JointBodies& bodiesOf(const JointDef& def) {
    return std::visit([](const auto& d) -> const JointBodies& { return d.bodies; }, def);
}

template <class Def>
AxisSettings settingsOf(const Def& def, bool turns) {
    return {def.limit, def.stop, def.motor, def.spring, def.target, def.friction, def.bearing, turns};
}

void refreshAt(JointSim& joint, const JointPlace& now, const BodyPair& pair, const Refresh& refresh) {
    switch (joint.kind) {
        case JointKind::none:
            break;
        case JointKind::ball:
            refreshBall(joint, now, pair, refresh);
            break;
        case JointKind::hinge:
            refreshHinge(joint, now, pair, refresh);
            break;
        case JointKind::slider:
            refreshSlider(joint, now, pair, refresh);
            break;
        case JointKind::fixed:
            refreshFixed(joint, now, pair);
            break;
        case JointKind::distance:
            refreshDistance(joint, now, pair, refresh);
            break;
        default:
            refreshAxes(joint, now, pair, refresh);
            break;
    }
}

}  // namespace

namespace {

/// A turn by h |ω|, as far as tan(θ/2) = θ/2 (1 + θ²/12 + θ⁴/120) goes: 1e-4 at a radian.
Quat turned(const Vec3& w, float h) {
    const Vec3 turn = h * w;
    const float square = dot(turn, turn);
    const Vec3 half = (0.5f + square * (1.0f / 24 + square * (1.0f / 240))) * turn;
    return normalized(Quat{half.x, half.y, half.z, 1});
}
/// R r − r
Vec3 displaced(const Quat& q, const Vec3& r) {
    const Vec3 axis{q.x, q.y, q.z}, across = cross(axis, r);
    return 2 * (q.w * across + cross(axis, across));
}

}  // namespace

JointPlace locate(JointSim& joint, const BodyPair& pair) {
    const BodyState &a = pair.stateA(), &b = pair.stateB();
    const Vec3 anchorA = rotate(a.dq, joint.anchorA), anchorB = rotate(b.dq, joint.anchorB);
    const Vec3 gap = joint.centerOffset + (b.dp - a.dp) + (anchorB - anchorA);
    joint.arms = {anchorA + 0.5f * gap, anchorB - 0.5f * gap};
    return {a.dq * joint.frameA, b.dq * joint.frameB, gap};
}

JointPlace placeAhead(const JointPlace& now, const Arms& arms, const BodyPair& pair, float h) {
    const Turning w = pair.turns();
    const Quat a = turned(w.a, h), b = turned(w.b, h);
    const Arms anchors{arms.a - 0.5f * now.gap, arms.b + 0.5f * now.gap};
    const Vec3 gap = now.gap + h * pair.velocity({}).linear + (displaced(b, anchors.b) - displaced(a, anchors.a));
    return {a * now.a, b * now.b, gap};
}

void refreshJoint(JointSim& joint, const BodyPair& pair, const Refresh& refresh) {
    refreshAt(joint, locate(joint, pair), pair, refresh);
}

void compileJoint(const JointDef& def, const Vec3& centerA, const Vec3& centerB, JointSim& into) {
    const JointKind kind = kindOf(def);
    if (into.kind != kind) {
        const std::uint32_t a = into.stateA, b = into.stateB;
        into = {};
        if (hasAxes(kind)) withAxes(into) = {};
        into.stateA = a;
        into.stateB = b;
        into.kind = kind;
        // A distance has no direction yet; a ball's rows stay in world axes.
        if (kind == JointKind::distance) into.block.basis.cz = {};
    }
    into.ledger = {};
    into.leads = 0;
    const JointBodies& bodies = bodiesOf(def);
    into.localA = {bodies.frameA.position - centerA, normalized(bodies.frameA.rotation)};
    into.localB = {bodies.frameB.position - centerB, normalized(bodies.frameB.rotation)};
    into.block.linearFirst = kind == JointKind::slider ? 0 : 1;
    into.block.rigidRows = kind == JointKind::fixed ? 3 : kind == JointKind::hinge || kind == JointKind::slider ? 2 : 0;
    into.breakable = bodies.breakForce < kNoForceLimit || bodies.breakTorque < kNoForceLimit ? 1 : 0;
    if (hasAxes(kind)) {
        compileAxes(def, into);
    } else if (const auto* ball = std::get_if<BallDef>(&def)) {
        compile(into.ball, *ball);
        into.drives = compileDrives(*ball);
    } else if (const auto* hinge = std::get_if<HingeDef>(&def)) {
        compile(into.axis, settingsOf(*hinge, true));
    } else if (const auto* slider = std::get_if<SliderDef>(&def)) {
        compile(into.axis, settingsOf(*slider, false));
    } else if (const auto* distance = std::get_if<DistanceDef>(&def)) {
        compile(into.axis, {distance->limit, distance->stop, {}, distance->spring, distance->rest, 0, {}, false});
    }
}

void prepareJoint(JointSim& joint, const JointBodiesAtStep& bodies, const BodyState*, const BodyInertia*,
                  const JointContext&) {
    joint.stepImpulse = {};
    joint.centerOffset = bodies.centerOffset;
    joint.anchorA = rotate(bodies.rotationA, joint.localA.position);
    joint.anchorB = rotate(bodies.rotationB, joint.localB.position);
    joint.frameA = bodies.rotationA * joint.localA.rotation;
    joint.frameB = bodies.rotationB * joint.localB.rotation;
    // The turns that a range asks for are found before any pass, which then only counts them on.
    if (joint.kind == JointKind::hinge && !joint.axis.angle.tracked)
        track(joint.axis, hingeAngle(joint.frameA, joint.frameB));
}

void placeJoint(JointSim& joint, const JointBodiesAtStep& bodies, const BodyState* states, const BodyInertia* inertia) {
    prepareJoint(joint, bodies, states, inertia, {});
    // Nothing is written without BodyPair::store.
    const BodyPair pair(const_cast<BodyState*>(states), inertia, joint.stateA, joint.stateB);
    refreshJoint(joint, pair, {{}, false});
}

PairVector warmStartImpulse(const JointSim& joint) {
    if (hasAxes(joint.kind)) return warmStartImpulse(withAxes(joint).axes);
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
        default:
            break;
    }
    return sum;
}

void warmStartJoint(JointSim& joint, BodyState* states, const BodyInertia* inertia, const JointContext& context) {
    BodyPair pair(states, inertia, joint.stateA, joint.stateB);
    const JointPlace now = locate(joint, pair);
    pair.recordPull(joint.arms, warmStartImpulse(joint).linear, context.h);
    refreshAt(joint, now, pair, {context, true});
    openLedger(joint, pair, context.h);
    pair.apply(joint.arms, warmStartImpulse(joint));
    recordOwn(joint, pair, LedgerPass::warmStart);
    pair.store();
}

/// Of rows across a slider's axis, which turns with A, Coriolis' share is counted too.
static PairVector meanVelocity(const JointSim& joint, const BodyPair& pair, float h) {
    PairVector u = pair.velocity(joint.arms);
    const bool hinged = joint.kind == JointKind::hinge;
    const Turning w = hinged                          ? pair.turnsAbout(joint.block.basis.cz)
                      : joint.kind == JointKind::ball ? pair.turns()
                                                      : pair.turnsTogether();
    if (hinged) u.angular += curvingAxes(w, joint.block.basis.cz, h);
    Vec3 bend = curvingArms(w, joint.arms, h);
    if (joint.kind == JointKind::slider) {
        bend -= (h / (1 + h * h * dot(w.a, w.a))) * cross(w.a, u.linear);
    }
    u.linear += bend;
    return u;
}

static float openShare(const JointSim& joint, const BodyPair& pair, float h) {
    float linear = 0, angular = 0;
    if (hasAxes(joint.kind)) {
        const AxesBlock& axes = withAxes(joint).axes;
        for (std::uint32_t i = 0; i < axes.rigidRows; ++i)
            (lengthSquared(axes.rigid[i].linear) > 0 ? linear : angular) += axes.error[i] * axes.error[i];
    } else {
        const RigidBlock& block = joint.block;
        const Vec3& e = block.errorSecond;
        linear = lengthSquared(block.errorFirst);
        angular = block.rigidRows == 0 ? 0.0f : block.rigidRows == 2 ? e.x * e.x + e.y * e.y : lengthSquared(e);
        if (!block.linearFirst) std::swap(linear, angular);
    }
    return openShare(joint.arms, pair.turns(), linear, angular, h);
}

/// Rows that carry their whole load and come back from an error as soft ones do.
static Softness withoutLeak(const Softness& soft) { return {soft.biasRate, 1, 0}; }

/// Joints of a free tree carry their whole load: the iteration nearly solves it, and the leak of soft rows is for what
/// they do not.
static Softness softnessOf(const JointSim& joint, const BodyPair& pair, const JointContext& context) {
    if (joint.ofFreeTree == 0) return context.softness;
    return {context.softness.biasRate * (1 - openShare(joint, pair, context.h)), 1, 0};
}

/// Closes what is open by moving the bodies. That they are moved gives them no speed, so nothing is fed that other rows
/// would have to take back.
static void closeJoint(const JointSim& joint, const BodyPair& pair, const JointContext& context) {
    if (context.settling || joint.ofFreeTree == 0 || joint.kind == JointKind::distance) return;
    const float share = openShare(joint, pair, context.h);
    if (!(share > 0)) return;
    if (hasAxes(joint.kind))
        closeAxes(withAxes(joint).axes, pair, joint.arms, share);
    else
        pair.move(joint.arms, closingMove(joint.block, share));
}

/// The travel s along the slide x of bodies that turn together:  s'' = x · ω × (ω × (rB − rA)), with the arms to the
/// shared point, which hold the travel.
static float slidingBend(const JointSim& joint, const BodyPair& pair, float h) {
    return dot(joint.block.basis.cz, curvingArms(pair.turnsTogether(), joint.arms, h));
}

float bendOf(const JointSim& joint, std::uint32_t coordinate, const BodyPair& pair, float h) {
    if (hasAxes(joint.kind)) return withAxes(joint).axes.freeBend[coordinate];
    if (joint.kind == JointKind::slider) return slidingBend(joint, pair, h);
    if (joint.kind != JointKind::distance) return 0;
    const float speed = dot(joint.block.basis.cz, pair.velocity(joint.arms).linear);
    return pair.receding(joint.arms, joint.block.errorFirst, speed, h);
}

void solveRigid(JointSim& joint, BodyPair& pair, const JointContext& context, bool moving) {
    const PairVector u = moving ? meanVelocity(joint, pair, context.h) : pair.velocity(joint.arms);
    const bool pushed = moving && joint.axis.features != 0;
    const Reaction held = pushed ? reactionTo(joint.block, axisImpulse(joint.axis)) : Reaction{};
    solveBlock(joint.block, pair, joint.arms, u, moving ? softnessOf(joint, pair, context) : kRigid, held);
}

void solveBlockAndAxis(JointSim& joint, BodyPair& pair, const JointContext& context, bool useBias) {
    RigidBlock& block = joint.block;
    solveRigid(joint, pair, context, useBias);
    if (joint.axis.features == 0 || !(joint.axis.inverseMass > 0)) return;
    const PairVector u = pair.velocity(joint.arms);
    const float speed = dot(block.basis.cz, block.linearFirst ? u.angular : u.linear);
    const float bend = useBias && joint.axis.keepsRange() ? bendOf(joint, 0, pair, context.h) : 0.0f;
    pair.apply(joint.arms, freeImpulse(block, solveAxis(joint.axis, speed, context, useBias, bend)));
}

/// What is isolated is solved at once: it carries its whole load, and takes an impact on a stop whole. What is held
/// beyond its limits would not come back from where it gave way, and stays soft.
static void solveAxes(JointSim& joint, BodyPair& pair, const JointContext& context, bool moving) {
    AxesBlock& axes = withAxes(joint).axes;
    const Softness whole = withoutLeak(context.softness);
    const bool isolated = axes.isIsolated != 0;
    const Softness& rigid = isolated && axes.isAbrupt == 0 ? whole : context.softness;
    JointContext own = context;
    if (isolated && !isHeld(axes)) own.softness = whole;
    solveAxes(axes, pair, joint.arms, moving ? rigid : kRigid, own, moving);
}

namespace {

void solveRows(JointSim& joint, BodyPair& pair, const JointContext& context, bool useBias) {
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
            solveRigid(joint, pair, context, useBias);
            break;
        case JointKind::distance:
            solveDistance(joint, pair, context, useBias);
            break;
        default:
            if (useBias) foreseeAxes(joint, locate(joint, pair), pair, context);
            solveAxes(joint, pair, context, useBias);
            break;
    }
}

}  // namespace

static JointContext ownContext(const JointSim& joint, const JointContext& context) {
    JointContext own = context;
    own.ofFreeTree = joint.ofFreeTree != 0;
    return own;
}

void solveJoint(JointSim& joint, BodyState* states, const BodyInertia* inertia, const JointContext& context,
                bool useBias) {
    BodyPair pair(states, inertia, joint.stateA, joint.stateB);
    watchOthers(joint, pair);
    if (!useBias) {
        refreshJoint(joint, pair, {context, false});
        closeJoint(joint, pair, context);
    }
    solveRows(joint, pair, ownContext(joint, context), useBias);
    if (useBias)
        recordOwn(joint, pair, LedgerPass::moving);
    else if (!context.settling)
        settleLedger(joint, pair, context);
    pair.store();
    if (!useBias && !context.settling) recordLoad(joint);
}

void solveJointAgain(JointSim& joint, BodyState* states, const BodyInertia* inertia, const JointContext& context,
                     bool useBias) {
    BodyPair pair(states, inertia, joint.stateA, joint.stateB);
    solveRows(joint, pair, ownContext(joint, context), useBias);
    pair.store();
}

BodyPair fitted(JointSim& joint, const BodyPair& pair) {
    if (hasAxes(joint.kind)) return held(withAxes(joint).axes, pair, joint.arms, false);
    BodyPair fits = pair;
    const Vec3 first = joint.block.impulseFirst, second = joint.block.impulseSecond;
    if (joint.kind != JointKind::distance) {
        solveRigid(joint, fits, {}, false);
    } else if (joint.axis.features & AxisRows::kLocked && joint.axis.inverseMass > 0) {
        const Vec3 line = joint.block.basis.cz;
        const float speed = dot(line, pair.velocity(joint.arms).linear);
        fits.apply(joint.arms, {(-speed / joint.axis.inverseMass) * line, {}});
    }
    joint.block.impulseFirst = first;
    joint.block.impulseSecond = second;
    return fits;
}

bool fitVelocities(JointSim& joint, BodyState* states, const BodyInertia* inertia) {
    BodyPair pair(states, inertia, joint.stateA, joint.stateB);
    const BodyPair fit = fitted(joint, pair);
    const PairVector before = pair.velocity(joint.arms), after = fit.velocity(joint.arms);
    constexpr float kRounding = 1e-5f;  // of speeds: eighty roundings of a float
    const Vec3 vA = states[joint.stateA].v, wA = states[joint.stateA].w, vB = states[joint.stateB].v,
               wB = states[joint.stateB].w;
    const float turning = length(wA) + length(wB);
    const float moving = length(vA) + length(vB) + length(cross(wA, joint.arms.a)) + length(cross(wB, joint.arms.b));
    const bool fits = length(after.linear - before.linear) <= kRounding * moving &&
                      length(after.angular - before.angular) <= kRounding * turning;
    if (!fits) {
        pair = fit;
        pair.store();
    }
    beginLedger(joint, pair);
    return !fits;
}

void rescaleJoint(JointSim& joint, float ratio) {
    for (Vec3* impulse :
         {&joint.lead.linear, &joint.lead.angular, &joint.block.impulseFirst, &joint.block.impulseSecond})
        rescale(*impulse, ratio);
    rescale(joint.axis, ratio);
    rescale(joint.ball, ratio);
    if (hasAxes(joint.kind)) rescale(withAxes(joint).axes, ratio);
}

}  // namespace ragtop
