#include "constraints/joint_types.h"

namespace ragtop {
namespace {

// Below this cosine of half the swing, within 0.1° of a half turn, the twist has no axis.
constexpr float kNoTwist = 1e-3f;

Vec3 clampLength(const Vec3& a, float longest) {
    const float l = length(a);
    return l > longest ? (longest / l) * a : a;
}

Vec3 swingAxis(const Vec3& xA, const Vec3& xB) {
    const Vec3 axis = cross(xA, xB);
    if (lengthSquared(axis) > 1e-12f) return normalized(axis);
    return dot(xA, xB) > 0 ? Vec3{} : perpendicular(xA);
}

}  // namespace

/// q = swing · twist with the twist about x and the swing axis perpendicular to x:
///   q ∝ (…, x, w) gives tan(twist/2) = x/w,  cos(swing/2) = √(x² + w²),
/// regular everywhere but at a half turn of swing, where x = w = 0 and no twist is defined.
SwingTwist swingTwist(const Quat& a, const Quat& b) {
    const Quat q = conjugate(a) * b;
    SwingTwist s;
    s.cosHalfSwing = std::sqrt(q.x * q.x + q.w * q.w);
    s.swing = 2 * arcTan2(std::sqrt(q.y * q.y + q.z * q.z), s.cosHalfSwing);
    s.twist = angleAboutX(q);
    return s;
}

/// ω of the twist is ω · (xA + xB)/(1 + xA · xB) = (ω · u)/cos(swing/2). The row is scaled by that cosine, margin and
/// rate alike, so that it stays a unit vector and fades where the twist loses its meaning.
Vec3 twistAxis(const Vec3& xA, const Vec3& xB) { return normalized(xA + xB, {}); }

Vec3 turningImpulse(const BallRows& rows) {
    return rows.springImpulse + rows.frictionImpulse +
           (rows.twistLowerImpulse - rows.twistUpperImpulse) * rows.twistAxis - rows.swingImpulse * rows.swingAxis;
}

void refreshBall(JointSim& joint, const JointPlace& place, const BodyPair& pair, bool begins) {
    RigidBlock& block = joint.block;
    BallRows& rows = joint.ball;
    block.errorFirst = place.gap;
    refreshMass(block, pair.mass(joint.arms), rows.features != 0);
    if (rows.features & (BallRows::kSwing | BallRows::kTwist)) {
        const Vec3 xA = rotate(place.a, {1, 0, 0}), xB = rotate(place.b, {1, 0, 0});
        const SwingTwist angles = swingTwist(place.a, place.b);
        rows.swingAxis = swingAxis(xA, xB);
        rows.swingMargin = rows.swingLimit - angles.swing;
        const float c = angles.cosHalfSwing;
        rows.twistAxis = c > kNoTwist ? twistAxis(xA, xB) : Vec3{};
        const float twist = wrapAbout(angles.twist, 0.5f * (rows.twistLimit.lower + rows.twistLimit.upper));
        rows.twistLowerMargin = c * (twist - rows.twistLimit.lower);
        rows.twistUpperMargin = c * (rows.twistLimit.upper - twist);
    }
    if (begins && (rows.features & BallRows::kSpring)) {
        rows.springError = rotationVector(place.b * conjugate(place.a * rows.target));
    }
}

namespace {

/// The ball's rotation while its rows are solved in turn: torques come with the force that keeps the point together,
/// so the inverse inertia is the block's P.
struct BallTurn {
    const RigidBlock& block;
    Vec3 speed, total;

    void add(const Vec3& impulse) {
        total += impulse;
        speed += block.mass.rest * impulse;
    }
};

/// (P + γ E) Δλ = −(ω + β φ + γ λ), φ the rotation vector from the target.
void solveSpring(BallRows& rows, BallTurn& turn, float h) {
    const SpringRow spring = makeSpring(rows.stiffness, rows.damping, h);
    if (!spring.active) return;
    Sym3 k = turn.block.mass.rest;
    k.xx += spring.gamma;
    k.yy += spring.gamma;
    k.zz += spring.gamma;
    const Vec3 old = rows.springImpulse;
    const Vec3 right = turn.speed + spring.beta * rows.springError + spring.gamma * old;
    rows.springImpulse = clampLength(old - solve(factorize(k, diagonal(k)), right), rows.maxSpringTorque * h);
    turn.add(rows.springImpulse - old);
}

void solveFriction(BallRows& rows, BallTurn& turn, float h) {
    const Vec3 old = rows.frictionImpulse;
    rows.frictionImpulse = clampLength(old - solve(turn.block.second, turn.speed), rows.friction * h);
    turn.add(rows.frictionImpulse - old);
}

/// A limit whose margin grows with the speed about `axis`.
void solveTurnLimit(float& impulse, float margin, const Vec3& axis, BallTurn& turn, const JointContext& context,
                    bool useBias) {
    const float inverseMass = dot(axis, turn.block.mass.rest * axis);
    if (!(inverseMass > turn.block.noise)) return;
    turn.add(solveLimit(impulse, margin, dot(axis, turn.speed), inverseMass, context, useBias) * axis);
}

}  // namespace

void solveBall(JointSim& joint, BodyPair& pair, const JointContext& context, bool useBias) {
    RigidBlock& block = joint.block;
    BallRows& rows = joint.ball;
    solveBlock(block, pair, joint.arms, useBias ? context.softness : kRigid);
    if (rows.features == 0) return;
    BallTurn turn{block, pair.velocity(joint.arms).angular, {}};
    if (rows.features & BallRows::kSpring) solveSpring(rows, turn, context.h);
    if (rows.features & BallRows::kFriction) solveFriction(rows, turn, context.h);
    if (rows.features & BallRows::kTwist) {
        solveTurnLimit(rows.twistLowerImpulse, rows.twistLowerMargin, rows.twistAxis, turn, context, useBias);
        solveTurnLimit(rows.twistUpperImpulse, rows.twistUpperMargin, -rows.twistAxis, turn, context, useBias);
    }
    if (rows.features & BallRows::kSwing) {
        solveTurnLimit(rows.swingImpulse, rows.swingMargin, -rows.swingAxis, turn, context, useBias);
    }
    const Vec3 force = -(block.mass.gain * turn.total);
    block.impulseFirst += force;
    pair.apply(joint.arms, {force, turn.total});
}

}  // namespace ragtop
