// The rows that turn a ball's bodies, in lanes: the operations of constraints/joint_ball.cpp.
// Included by wide_joints.inl.

namespace ragtop {
namespace {

/// The axes of a frame, as axisX and axisY.
template <int N>
RAGTOP_INLINE WideVec3<N> axisX(const WideQuat<N>& q) {
    const Lanes<N> y = 2.0f * q.y, z = 2.0f * q.z;
    return {1.0f - (q.y * y + q.z * z), q.x * y + q.w * z, q.x * z - q.w * y};
}
template <int N>
RAGTOP_INLINE WideVec3<N> axisY(const WideQuat<N>& q) {
    const Lanes<N> x = 2.0f * q.x, z = 2.0f * q.z;
    return {q.y * x - q.w * z, 1.0f - (q.x * x + q.z * z), q.y * z + q.w * x};
}
template <int N>
RAGTOP_INLINE WideQuat<N> conjugate(const WideQuat<N>& q) {
    return {-q.x, -q.y, -q.z, q.w};
}
template <int N>
RAGTOP_INLINE WideVec3<N> clampLength(const WideVec3<N>& a, Lanes<N> longest) {
    const Lanes<N> l = length(a);
    return select(l > longest, (longest / l) * a, a);
}

/// How far a ball's rows are from their ends, and their axes.
template <int N>
struct WideTurns {
    Lanes<N> swing, twistLower, twistUpper;
    WideVec3<N> swingAxis, twistAxis;
};

template <int N>
RAGTOP_INLINE void findSwing(const WideJoint<N>& j, const WideQuat<N>& a, const WideVec3<N>& xB, WideTurns<N>& turns) {
    const WideVec3<N> d = inverseRotate(a, xB);
    const Lanes<N> zero(0.0f), across = sqrt(d.y * d.y + d.z * d.z);
    turns.swing = j.at(RAGTOP_JOINT_FIELD(ball.swingLimit.y)) - jointAngle(across, d.x);
    const Mask<N> defined = across > kNoDirection;
    const WideVec3<N> half{zero, zero, select(d.x < zero, Lanes<N>(-1.0f), zero)};
    turns.swingAxis = rotate(a, select(defined, WideVec3<N>{zero, d.z / across, -d.y / across}, half));
}
template <int N>
RAGTOP_INLINE void findTwist(const WideJoint<N>& j, const WideQuat<N>& a, const WideQuat<N>& b, const WideVec3<N>& xB,
                             WideTurns<N>& turns) {
    const WideQuat<N> q = conjugate(a) * b;
    const Lanes<N> c = sqrt(q.x * q.x + q.w * q.w);
    turns.twistAxis = select(c > kNoTwist, unitOr(axisX(a) + xB, nothing<N>()), nothing<N>());
    const Lanes<N> lower = j.at(RAGTOP_JOINT_FIELD(ball.twistLimit.lower)),
                   upper = j.at(RAGTOP_JOINT_FIELD(ball.twistLimit.upper)), angle = angleAboutX(q);
    const Lanes<N> off = angle - 0.5f * (lower + upper), turn(2 * kPi);
    const Lanes<N> twist = select(off > kPi, angle - turn, select(off <= Lanes<N>(-kPi), angle + turn, angle));
    turns.twistLower = c * (twist - lower);
    turns.twistUpper = c * (upper - twist);
}
template <int N>
RAGTOP_INLINE WideTurns<N> findTurns(const WideJoint<N>& j) {
    WideTurns<N> turns;
    const WideQuat<N> a = j.frameA(), b = j.frameB();
    const WideVec3<N> xB = axisX(b);
    if (j.bundle.features & BallRows::kSwing) findSwing(j, a, xB, turns);
    if (j.bundle.features & BallRows::kTwist) findTwist(j, a, b, xB, turns);
    return turns;
}
template <int N>
RAGTOP_INLINE void storeTurns(WideJoint<N>& j, const WideTurns<N>& turns) {
    if (j.bundle.features & BallRows::kSwing) {
        j.set(RAGTOP_JOINT_FIELD(ball.swing[0].margin), turns.swing);
        j.set(RAGTOP_JOINT_FIELD(ball.swingAxis[0]), turns.swingAxis);
    }
    if (j.bundle.features & BallRows::kTwist) {
        j.set(RAGTOP_JOINT_FIELD(ball.twistLower.margin), turns.twistLower);
        j.set(RAGTOP_JOINT_FIELD(ball.twistUpper.margin), turns.twistUpper);
        j.set(RAGTOP_JOINT_FIELD(ball.twistAxis), turns.twistAxis);
    }
}

/// As turningImpulse.
template <int N>
RAGTOP_INLINE WideVec3<N> turningImpulse(const WideJoint<N>& j) {
    WideVec3<N> sum =
        j.vector(RAGTOP_JOINT_FIELD(ball.springImpulse)) + j.vector(RAGTOP_JOINT_FIELD(ball.viscousImpulse)) +
        j.vector(RAGTOP_JOINT_FIELD(ball.frictionImpulse)) +
        (j.at(RAGTOP_JOINT_FIELD(ball.twistLower.impulse)) - j.at(RAGTOP_JOINT_FIELD(ball.twistUpper.impulse))) *
            j.vector(RAGTOP_JOINT_FIELD(ball.twistAxis));
    if (j.bundle.features & BallRows::kSwing)
        sum = sum + j.at(RAGTOP_JOINT_FIELD(ball.swing[0].impulse)) * j.vector(RAGTOP_JOINT_FIELD(ball.swingAxis[0]));
    return sum;
}

/// As turnVector.
template <int N>
RAGTOP_INLINE WideVec3<N> turnVector(const WideQuat<N>& q) {
    const WideVec3<N> v{q.x, q.y, q.z};
    const Lanes<N> sine = sqrt(q.x * q.x + q.y * q.y + q.z * q.z);
    const Mask<N> far = q.w < 0.0f;
    const Lanes<N> angle = jointAngle(sine, select(far, -q.w, q.w)), half = select(far, -angle, angle);
    return select(sine > 0.0f, (2.0f * half / sine) * v, nothing<N>());
}

template <int N>
RAGTOP_INLINE void setDrags(WideJoint<N>& j, int drags, Lanes<N> stiffness, Lanes<N> damping, Lanes<N> inverseInertia,
                            float h) {
    const WideShares<N> shares = springShares(stiffness, damping, inverseInertia, h);
    j.set(drags, dragOf(shares.moving, inverseInertia));
    j.set(drags + 1, dragOf(shares.resting, inverseInertia));
}

/// As beginBall. `rest`: inverse inertia while the point is held, and what it cannot tell from zero.
template <int N>
RAGTOP_INLINE Mask<N> beginBall(WideJoint<N>& j, const WideTurns<N>& turns, const SymmetricMatrix<N>& rest,
                                Lanes<N> noise, const JointContext& context) {
    const std::uint32_t features = j.bundle.features;
    const Lanes<N> zero(0.0f), h(context.h), most = max(max(rest.xx, rest.yy), rest.zz),
                                             inverseInertia = select(most > noise, most, zero);
    if (features & BallRows::kSpring) {
        const WideQuat<N> wanted = j.frameA() * j.quaternion(RAGTOP_JOINT_FIELD(ball.target));
        j.set(RAGTOP_JOINT_FIELD(ball.springError), turnVector(j.frameB() * conjugate(wanted)));
        const WideSpring<N> spring(j, RAGTOP_JOINT_FIELD(ball.stiffness), inverseInertia);
        j.set(RAGTOP_JOINT_FIELD(ball.springStiffness), spring.stiffness);
        setDrags(j, RAGTOP_JOINT_FIELD(ball.springDrag[0]), spring.stiffness, spring.damping, inverseInertia,
                 context.h);
    }
    if (features & BallRows::kViscous)
        setDrags(j, RAGTOP_JOINT_FIELD(ball.viscousDrag[0]), zero, j.at(RAGTOP_JOINT_FIELD(ball.viscous)),
                 inverseInertia, context.h);
    if (features & BallRows::kFriction) {
        const WideVec3<N> impulse = j.vector(RAGTOP_JOINT_FIELD(ball.frictionImpulse));
        const Lanes<N> kinetic =
            h * j.at(RAGTOP_JOINT_FIELD(ball.friction)) +
            j.at(RAGTOP_JOINT_FIELD(ball.loadFriction)) * length(j.vector(RAGTOP_JOINT_FIELD(block.impulseFirst)));
        const Mask<N> slides = beginFriction(j, RAGTOP_JOINT_FIELD(ball.dry), length(impulse), kinetic,
                                             h * j.at(RAGTOP_JOINT_FIELD(ball.breakaway)));
        j.set(RAGTOP_JOINT_FIELD(ball.frictionImpulse), select(slides, Lanes<N>(0.5f) * impulse, impulse));
    }
    const WideVec3<N> spin = j.angularVelocity();
    if (features & BallRows::kSpring) j.set(RAGTOP_JOINT_FIELD(ball.springStart), spin);
    constexpr int kRestitution = RAGTOP_JOINT_FIELD(ball.stop.restitution);
    Mask<N> hadImpact = zero < zero;
    if (features & BallRows::kSwing)
        hadImpact = beginStop(j, RAGTOP_JOINT_FIELD(ball.swing[0]), kRestitution, turns.swing,
                              dot(turns.swingAxis, spin), context.h);
    if (features & BallRows::kTwist) {
        const Lanes<N> twisting = dot(turns.twistAxis, spin);
        hadImpact = hadImpact | beginStop(j, RAGTOP_JOINT_FIELD(ball.twistLower), kRestitution, turns.twistLower,
                                          twisting, context.h);
        hadImpact = hadImpact | beginStop(j, RAGTOP_JOINT_FIELD(ball.twistUpper), kRestitution, turns.twistUpper,
                                          -twisting, context.h);
    }
    return hadImpact;
}

/// The ball's rotation while its rows are solved in turn, as BallTurn.
template <int N>
struct WideBallTurn {
    JointFields<N> j;
    const SymmetricMatrix<N>& rest;
    Lanes<N> noise;
    WideVec3<N> speed, total;

    RAGTOP_INLINE void add(const WideVec3<N>& impulse) {
        total = total + impulse;
        speed = speed + rest * impulse;
    }
    RAGTOP_INLINE void compliant(int field, const WideVec3<N>& push, Lanes<N> drag, Lanes<N> longest) {
        const SymmetricMatrix<N> k{1.0f + drag * rest.xx, drag * rest.xy, drag * rest.xz,
                                   1.0f + drag * rest.yy, drag * rest.yz, 1.0f + drag * rest.zz};
        const WideVec3<N> old = j.vector(field);
        const WideVec3<N> wanted = solveFor(factorize(k, diagonal(k)), push - drag * (speed - rest * old));
        const WideVec3<N> impulse = clampLength(wanted, longest);
        j.set(field, impulse);
        add(impulse - old);
    }
    RAGTOP_INLINE void friction(const WideFactor<N>& second, bool moving) {
        constexpr int kImpulse = RAGTOP_JOINT_FIELD(ball.frictionImpulse);
        const WideVec3<N> old = j.vector(kImpulse);
        const WideVec3<N> impulse =
            clampLength(old - solveFor(second, speed), frictionBound(j, RAGTOP_JOINT_FIELD(ball.dry), moving));
        j.set(kImpulse, impulse);
        add(impulse - old);
    }
    /// A stop whose margin grows with the speed about `axis`.
    RAGTOP_INLINE void stop(int side, const WideVec3<N>& axis, const JointContext& context, bool moving) {
        const Lanes<N> along = dot(axis, speed);
        const WideStopAim<N> aim(j, side, along, context, moving);
        if (!any(aim.acts)) return;
        const Lanes<N> inverseMass = dot(axis, rest * axis);
        const Mask<N> lanes = aim.acts & (inverseMass > noise);
        const WideVec3<N> impulse = (aim.solve(j, side, along, inverseMass, lanes) - aim.impulse) * axis;
        total = select(lanes, total + impulse, total);
        speed = select(lanes, speed + rest * impulse, speed);
    }
    /// As HeldAxes::hold of the twist and of the swing after it.
    RAGTOP_INLINE WideVec3<N> heldRotation(const WideTurns<N>& turns, Mask<N> twists, Mask<N> swings,
                                           WideVec3<N> rotation) const {
        if (j.bundle.features & BallRows::kTwist) {
            const WideVec3<N> response = rest * turns.twistAxis;
            const Lanes<N> inverseMass = dot(turns.twistAxis, response);
            twists = twists & (inverseMass > noise);
            rotation =
                select(twists, rotation - (dot(turns.twistAxis, rotation) / inverseMass) * response, rotation);
            if (!(j.bundle.features & BallRows::kSwing)) return rotation;
            const WideVec3<N> across =
                turns.swingAxis - (dot(turns.swingAxis, response) / inverseMass) * turns.twistAxis;
            return heldSwing(select(twists, across, turns.swingAxis), swings, rotation);
        }
        return heldSwing(turns.swingAxis, swings, rotation);
    }
    RAGTOP_INLINE WideVec3<N> heldSwing(const WideVec3<N>& axis, Mask<N> swings, const WideVec3<N>& rotation) const {
        const WideVec3<N> response = rest * axis;
        const Lanes<N> inverseMass = dot(axis, response);
        return select(swings & (inverseMass > noise), rotation - (dot(axis, rotation) / inverseMass) * response,
                      rotation);
    }
    RAGTOP_INLINE void recordEnergy(const WideJoint<N>& joint, const WideTurns<N>& turns, const WideFactor<N>& first,
                                  const WideFactor<N>& second) {
        constexpr int kMost = RAGTOP_JOINT_FIELD(ball.mostEnergy);
        const Lanes<N> all(kNoForceLimit);
        Mask<N> recovers = all < all, twists = recovers, swings = recovers;
        const auto consider = [&](int side, Mask<N>& acts) {
            const Mask<N> pushes = j.at(side + RAGTOP_STOP_FIELD(impulse)) > 0.0f;
            acts = acts | pushes;
            recovers = recovers | (pushes & (j.at(side + RAGTOP_STOP_FIELD(margin)) < 0.0f));
        };
        if (j.bundle.features & BallRows::kTwist) {
            consider(RAGTOP_JOINT_FIELD(ball.twistLower), twists);
            consider(RAGTOP_JOINT_FIELD(ball.twistUpper), twists);
        }
        if (j.bundle.features & BallRows::kSwing) consider(RAGTOP_JOINT_FIELD(ball.swing[0]), swings);
        j.set(kMost, all);
        if (!any(recovers)) return;
        const WideVec3<N> held = joint.angularVelocityAfter(-solveFor(first, joint.linearVelocity()), nothing<N>());
        const WideVec3<N> closed = speed + (held - joint.angularVelocity());
        const WideVec3<N> rotation = heldRotation(turns, twists, swings, closed);
        j.set(kMost, select(recovers, 0.5f * dot(rotation, solveFor(second, rotation)), all));
    }
    RAGTOP_INLINE void shedEnergy(const WideFactor<N>& second) {
        const Lanes<N> most = j.at(RAGTOP_JOINT_FIELD(ball.mostEnergy));
        const Mask<N> limited = most < Lanes<N>(kNoForceLimit);
        if (!any(limited)) return;
        const WideVec3<N> momentum = solveFor(second, speed);
        const Lanes<N> energy = 0.5f * dot(speed, momentum);
        const Mask<N> lanes = limited & (energy > most);
        const WideVec3<N> impulse = (sqrt(most / energy) - Lanes<N>(1.0f)) * momentum;
        total = select(lanes, total + impulse, total);
        speed = select(lanes, speed + rest * impulse, speed);
    }
    RAGTOP_INLINE void solve(const WideJoint<N>& joint, const WideTurns<N>& turns, const WideFactor<N>& first,
                             const WideFactor<N>& second, const JointContext& context, bool moving) {
        const std::uint32_t features = j.bundle.features;
        const Lanes<N> zero(0.0f), h(context.h);
        const int pass = moving ? 0 : 1;
        if (features & BallRows::kSpring)
            compliant(RAGTOP_JOINT_FIELD(ball.springImpulse),
                      (Lanes<N>(-context.h) * j.at(RAGTOP_JOINT_FIELD(ball.springStiffness))) *
                          j.vector(RAGTOP_JOINT_FIELD(ball.springError)),
                      j.at(RAGTOP_JOINT_FIELD(ball.springDrag[0]) + pass),
                      h * j.at(RAGTOP_JOINT_FIELD(ball.maxSpring)));
        if (features & BallRows::kViscous)
            compliant(RAGTOP_JOINT_FIELD(ball.viscousImpulse), nothing<N>(),
                      j.at(RAGTOP_JOINT_FIELD(ball.viscousDrag[0]) + pass), Lanes<N>(kNoForceLimit));
        if (features & BallRows::kFriction) friction(second, moving);
        if (features & BallRows::kTwist) {
            stop(RAGTOP_JOINT_FIELD(ball.twistLower), turns.twistAxis, context, moving);
            stop(RAGTOP_JOINT_FIELD(ball.twistUpper), -turns.twistAxis, context, moving);
        }
        if (features & BallRows::kSwing) stop(RAGTOP_JOINT_FIELD(ball.swing[0]), turns.swingAxis, context, moving);
        if (!(features & (BallRows::kSwing | BallRows::kTwist))) return;
        if (moving)
            recordEnergy(joint, turns, first, second);
        else
            shedEnergy(second);
    }
};

}  // namespace
}  // namespace ragtop
