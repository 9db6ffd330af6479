#include "constraints/joint_ball_stops.h"
#include "constraints/joint_constants.h"
#include "constraints/joint_geometry.h"
#include "constraints/joint_types.h"
#include "constraints/stop_trajectory.h"

namespace ragtop {
namespace {

float largest(const Vec3& a) {
    const float xy = a.x > a.y ? a.x : a.y;
    return xy > a.z ? xy : a.z;
}

/// Drags of a spring that turns a body whose inverse inertia differs about its axes: those of the axis that follows
/// most quickly, which are near to the damping for the others.
void setDrags(float (&drags)[2], float stiffness, float damping, float inverseInertia, float h) {
    const SpringShares shares = springShares(stiffness, damping, inverseInertia, h);
    drags[0] = inverseInertia > 0 ? dragOf(shares.moving, inverseInertia) : 0.0f;
    drags[1] = inverseInertia > 0 ? dragOf(shares.resting, inverseInertia) : 0.0f;
}

}  // namespace

SwingTwist swingTwist(const Quat& a, const Quat& b) {
    const Quat q = conjugate(a) * b;
    SwingTwist s;
    s.cosHalfSwing = std::sqrt(q.x * q.x + q.w * q.w);
    s.swing = 2 * arcTan2(std::sqrt(q.y * q.y + q.z * q.z), s.cosHalfSwing);
    s.twist = angleAboutX(q);
    return s;
}

float easiest(const RigidBlock& block) {
    const float most = largest(diagonal(block.mass.rest));
    return most > block.noise ? most : 0.0f;
}

Vec3 turningImpulse(const BallRows& rows) {
    Vec3 sum = rows.springImpulse + rows.viscousImpulse + rows.frictionImpulse +
               (rows.twistLower.impulse - rows.twistUpper.impulse) * rows.twistAxis;
    if (rows.hasTilt()) sum += rows.twistLower.impulse * rows.lowerTilt + rows.twistUpper.impulse * rows.upperTilt;
    for (int i = 0; i < sidesOf(rows.swingLimit.shape); ++i) sum += rows.swing[i].impulse * rows.swingAxis[i];
    return sum;
}

namespace {

void compileSwing(SwingLimit& limit, const BallDef& def) {
    limit = {};
    if (def.swingLimit) {
        limit.shape = SwingShape::circle;
        limit.y = limit.z = *def.swingLimit;
    } else if (def.swingEllipse) {
        // Equal half angles are a circle, which has no axes to choose between.
        limit.shape = def.swingEllipse->y == def.swingEllipse->z ? SwingShape::circle : SwingShape::ellipse;
        limit.y = def.swingEllipse->y;
        limit.z = def.swingEllipse->z;
    } else if (def.swingPyramid) {
        limit.shape = SwingShape::pyramid;
        limit.rangeY = def.swingPyramid->y;
        limit.rangeZ = def.swingPyramid->z;
    } else if (def.reach) {
        compile(limit, *def.reach);
    }
}

bool limitsTwist(const std::optional<Range>& range) { return range && range->upper - range->lower < 2 * kPi; }

}  // namespace

void compile(BallRows& rows, const BallDef& def) {
    const BallRows old = rows;
    rows = {};
    compileSwing(rows.swingLimit, def);
    rows.stop = def.stop;
    for (StopSide* side : {&rows.swing[0], &rows.swing[1], &rows.twistLower, &rows.twistUpper})
        side->recovery = kTurnRecovery;
    if (rows.swingLimit.shape != SwingShape::free) {
        rows.features |= BallRows::kSwing;
        for (int i = 0; i < sidesOf(rows.swingLimit.shape); ++i) rows.swing[i].impulse = old.swing[i].impulse;
    }
    if (def.twistLimit) rows.twistLimit = *def.twistLimit;
    if (def.reach || limitsTwist(def.twistLimit)) {
        rows.features |= BallRows::kTwist;
        rows.twistLower.impulse = old.twistLower.impulse;
        rows.twistUpper.impulse = old.twistUpper.impulse;
    }
    if (const auto& spring = def.spring) {
        rows.features |= BallRows::kSpring;
        rows.spring.tuning = tuningOf(*spring);
        rows.target = normalized(def.target);
        rows.spring.most = def.maxSpringTorque < spring->maxForce ? def.maxSpringTorque : spring->maxForce;
        rows.springImpulse = old.springImpulse;
    }
    if (needsDrives(def)) {
        rows.features = (rows.features & ~BallRows::kSpring) | BallRows::kDrives;
        rows.target = normalized(def.target);
        rows.spring.most = def.maxSpringTorque;
        for (const std::optional<Spring>* spring : {&def.spring, &def.twistSpring})
            if (*spring && (*spring)->maxForce < rows.spring.most) rows.spring.most = (*spring)->maxForce;
        rows.springImpulse = old.springImpulse;
    }
    const Bearing bearing = def.bearing.value_or(Bearing{});
    rows.resistance.friction = def.friction;
    rows.resistance.breakaway = bearing.breakaway;
    rows.resistance.loadFriction = bearing.coefficient * bearing.pinRadius;
    if (rows.resistance.friction > 0 || rows.resistance.breakaway > 0 || rows.resistance.loadFriction > 0) {
        rows.features |= BallRows::kFriction;
        rows.frictionImpulse = old.frictionImpulse;
    }
    if (bearing.viscous > 0) {
        rows.features |= BallRows::kViscous;
        rows.resistance.viscous = bearing.viscous;
        rows.viscousImpulse = old.viscousImpulse;
    }
}

void rescale(BallRows& rows, float ratio) {
    for (Vec3* impulse : {&rows.springImpulse, &rows.viscousImpulse, &rows.frictionImpulse}) rescale(*impulse, ratio);
    for (StopSide* side : {&rows.swing[0], &rows.swing[1], &rows.twistLower, &rows.twistUpper})
        rescale(side->impulse, ratio);
    rescale(rows.dry.bound, ratio);
}

Range twistRange(const BallRows& rows, const Vec3& d) {
    return rows.swingLimit.shape == SwingShape::polygon ? twistAt(rows.swingLimit, d) : rows.twistLimit;
}

void refreshLimits(BallRows& rows, const JointPlace& place) {
    const Vec3 xA = axisX(place.a), xB = axisX(place.b);
    const Vec3 d = inverseRotate(place.a, xB);
    if (rows.features & BallRows::kSwing) {
        SwingMargin sides[SwingLimit::kSides];
        swingMargins(rows.swingLimit, d, sides);
        for (int i = 0; i < sidesOf(rows.swingLimit.shape); ++i) {
            rows.swing[i].margin = sides[i].margin;
            rows.swingAxis[i] = rotate(place.a, sides[i].axis);
        }
    }
    if (rows.features & BallRows::kTwist) {
        const TwistOf<float> now = twistBetween(place.a, place.b);
        const float c = now.cosHalfSwing;
        rows.twistAxis = now.axis;
        const Range range = twistRange(rows, d);
        const float twist = wrapAbout(now.angle, 0.5f * (range.lower + range.upper));
        rows.twistLower.margin = c * (twist - range.lower);
        rows.twistUpper.margin = c * (range.upper - twist);
        if (rows.swingLimit.shape == SwingShape::polygon) {
            const TwistTilt tilt = c > kNoTwist ? twistTiltAt(rows.swingLimit, d, range) : TwistTilt{};
            rows.lowerTilt = rotate(place.a, -c * tilt.lower);
            rows.upperTilt = rotate(place.a, c * tilt.upper);
        } else {
            rows.lowerTilt = rows.upperTilt = {};
        }
        if (rows.stop.stiffness > 0 && c > kNoTwist) {
            // ∇c of c = cos(θ/2), with |xA × xB| = 2 c sin(θ/2) and θ' = n · ω.
            const Vec3 across = (-0.25f / c) * cross(xA, xB);
            rows.lowerTilt += (twist - range.lower) * across;
            rows.upperTilt += (range.upper - twist) * across;
        }
    }
}

namespace {

void beginBall(JointSim& joint, const JointPlace& place, const BodyPair& pair, const JointContext& context) {
    BallRows& rows = joint.ball;
    const float h = context.h, inverseInertia = easiest(joint.block);
    if (rows.features & BallRows::kSpring) {
        rows.springError = turnVector(place.b * conjugate(place.a * rows.target));
        const TunedSpring spring = rows.spring.tuning.at(inverseInertia);
        rows.springStiffness = spring.stiffness;
        setDrags(rows.springDrag, spring.stiffness, spring.damping, inverseInertia, h);
    }
    if (rows.features & BallRows::kDrives) beginDrives(joint, place, inverseInertia, h);
    if (rows.features & BallRows::kViscous) setDrags(rows.viscousDrag, 0, rows.resistance.viscous, inverseInertia, h);
    if (rows.features & BallRows::kFriction) {
        const float kinetic = rows.resistance.kinetic(h, length(joint.block.impulseFirst));
        if (rows.dry.begin(length(rows.frictionImpulse), kinetic, h * rows.resistance.breakaway))
            rows.frictionImpulse *= 0.5f;
    }
    const Vec3 spin = pair.velocity(joint.arms).angular;
    if (rows.features & (BallRows::kSpring | BallRows::kDrives) || rows.stop.stiffness > 0) rows.springStart = spin;
    const StopTrajectory noTrajectory;
    bool hadImpact = false;
    for (int i = 0; i < sidesOf(rows.swingLimit.shape); ++i)
        hadImpact |= beginStop(rows.swing[i], rows.stop, dot(rows.swingAxis[i], spin), noTrajectory, h);
    if (rows.features & BallRows::kTwist) {
        hadImpact |= beginStop(rows.twistLower, rows.stop, dot(rows.lowerTwistAxis(), spin), noTrajectory, h);
        hadImpact |= beginStop(rows.twistUpper, rows.stop, -dot(-rows.upperTwistAxis(), spin), noTrajectory, h);
    }
    beginBlock(joint.block, hadImpact);
}

}  // namespace

void refreshBall(JointSim& joint, const JointPlace& place, const BodyPair& pair, const Refresh& refresh) {
    RigidBlock& block = joint.block;
    BallRows& rows = joint.ball;
    block.errorFirst = place.gap;
    if (!refresh.places)
        refreshMass(block, pair.mass(joint.arms), rows.features != 0 ? BlockMass::whole : BlockMass::first);
    if (rows.features & (BallRows::kSwing | BallRows::kTwist)) refreshLimits(rows, place);
    if (refresh.begins && rows.features != 0) beginBall(joint, place, pair, refresh.context);
}

void solveBall(JointSim& joint, BodyPair& pair, const JointContext& context, bool useBias) {
    RigidBlock& block = joint.block;
    BallRows& rows = joint.ball;
    solveRigid(joint, pair, context, useBias);
    if (rows.features == 0) return;
    BallTurn turn{block, pair.velocity(joint.arms).angular, {}};
    const int pass = useBias ? 0 : 1;
    if (rows.features & BallRows::kSpring)
        turn.comply(rows.springImpulse, -context.h * rows.springStiffness * rows.springError, rows.springDrag[pass],
                    context.h * rows.spring.most);
    if (rows.features & BallRows::kDrives) turn.add(solveDrives(joint, turn.speed, pass, context.h * rows.spring.most));
    if (rows.features & BallRows::kViscous) turn.comply(rows.viscousImpulse, {}, rows.viscousDrag[pass], kNoForceLimit);
    if (rows.features & BallRows::kFriction) turn.rub(rows.frictionImpulse, rows.dry.boundOf(useBias));
    if (rows.features & (BallRows::kTwist | BallRows::kSwing)) solveBallStops(joint, turn, pair, context, useBias);
    const Vec3 force = -(block.mass.gain * turn.total);
    block.impulseFirst += force;
    pair.apply(joint.arms, {force, turn.total});
}

}  // namespace ragtop
