// The rows that turn a ball's bodies, in lanes: the operations of constraints/joint_ball.cpp.
// Included by wide_joints.inl.

namespace ragtop {
namespace {

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
RAGTOP_INLINE WideTurns<N> findTurns(const WideJoint<N>& j) {
    WideTurns<N> turns;
    const WideQuat<N> a = j.frameA(), b = j.frameB();
    if (j.bundle.features & BallRows::kSwing) {
        const SwingMarginOf<Lanes<N>> swing =
            circleMargin(j.at(RAGTOP_JOINT_FIELD(ball.swingLimit.y)), inverseRotate(a, axisX(b)));
        turns.swing = swing.margin;
        turns.swingAxis = rotate(a, swing.axis);
    }
    if (j.bundle.features & BallRows::kTwist) {
        const TwistOf<Lanes<N>> now = twistBetween(a, b);
        const Lanes<N> lower = j.at(RAGTOP_JOINT_FIELD(ball.twistLimit.lower)),
                       upper = j.at(RAGTOP_JOINT_FIELD(ball.twistLimit.upper));
        const Lanes<N> twist = wrapAbout<Lanes<N>>(now.angle, 0.5f * (lower + upper));
        turns.twistAxis = now.axis;
        turns.twistLower = now.cosHalfSwing * (twist - lower);
        turns.twistUpper = now.cosHalfSwing * (upper - twist);
    }
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

template <int N>
RAGTOP_INLINE void setDrags(WideJoint<N>& j, int drags, Lanes<N> stiffness, Lanes<N> damping, Lanes<N> inverseInertia,
                            float h) {
    const SpringSharesOf<Lanes<N>> shares = springShares(stiffness, damping, inverseInertia, h);
    const Mask<N> turns = inverseInertia > 0.0f;
    j.set(drags, select(turns, dragOf(shares.moving, inverseInertia), Lanes<N>(0.0f)));
    j.set(drags + 1, select(turns, dragOf(shares.resting, inverseInertia), Lanes<N>(0.0f)));
}
template <int N>
RAGTOP_INLINE DryFrictionOf<Lanes<N>>& ballFriction(const JointFields<N>& j) {
    return partAt<DryFrictionOf<Lanes<N>>>(j, RAGTOP_JOINT_FIELD(ball.dry));
}
template <int N>
RAGTOP_INLINE StopSideOf<Lanes<N>>& ballStop(const JointFields<N>& j, int field) {
    return partAt<StopSideOf<Lanes<N>>>(j, field);
}
constexpr int kSwingStop = RAGTOP_JOINT_FIELD(ball.swing[0]), kLowerStop = RAGTOP_JOINT_FIELD(ball.twistLower),
              kUpperStop = RAGTOP_JOINT_FIELD(ball.twistUpper);

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
        const TunedSpringOf<Lanes<N>> spring =
            tuned<Lanes<N>>({j.at(RAGTOP_JOINT_FIELD(ball.stiffness)), j.at(RAGTOP_JOINT_FIELD(ball.damping))},
                            j.at(RAGTOP_JOINT_FIELD(ball.frequency)), j.at(RAGTOP_JOINT_FIELD(ball.dampingRatio)),
                            inverseInertia);
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
        const Mask<N> slides =
            ballFriction(j).begin(length(impulse), kinetic, h * j.at(RAGTOP_JOINT_FIELD(ball.breakaway)));
        j.set(RAGTOP_JOINT_FIELD(ball.frictionImpulse), select(slides, Lanes<N>(0.5f) * impulse, impulse));
    }
    const WideVec3<N> spin = j.velocity(j.arms).angular;
    if (features & BallRows::kSpring) j.set(RAGTOP_JOINT_FIELD(ball.springStart), spin);
    const Lanes<N> restitution = j.at(RAGTOP_JOINT_FIELD(ball.stop.restitution));
    const auto begin = [&](int stop, Lanes<N> speed) __attribute__((always_inline)) {
        return beginHardStop<Lanes<N>>(ballStop(j, stop), restitution, j.bundle.rebounds != 0, speed, context.h);
    };
    Mask<N> hadImpact = zero < zero;
    if (features & BallRows::kSwing) hadImpact = begin(kSwingStop, dot(turns.swingAxis, spin));
    if (features & BallRows::kTwist) {
        const Lanes<N> twisting = dot(turns.twistAxis, spin);
        hadImpact = hadImpact | begin(kLowerStop, twisting);
        hadImpact = hadImpact | begin(kUpperStop, -twisting);
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
        const WideVec3<N> wanted = ragtop::solve<Lanes<N>>(factorize<Lanes<N>>(k, diagonal(k)), push - drag * (speed - rest * old));
        const WideVec3<N> impulse = clampLength(wanted, longest);
        j.set(field, impulse);
        add(impulse - old);
    }
    RAGTOP_INLINE void friction(const FactorOf<Lanes<N>>& second, bool moving) {
        constexpr int kImpulse = RAGTOP_JOINT_FIELD(ball.frictionImpulse);
        const WideVec3<N> old = j.vector(kImpulse);
        const WideVec3<N> impulse =
            clampLength(old - ragtop::solve(second, speed), ballFriction(j).boundOf(moving));
        j.set(kImpulse, impulse);
        add(impulse - old);
    }
    /// A stop whose margin grows with the speed about `axis`.
    RAGTOP_INLINE void stop(int side, const WideVec3<N>& axis, const JointContext& context, bool moving) {
        const Lanes<N> along = dot(axis, speed);
        StopSideOf<Lanes<N>>& row = ballStop(j, side);
        const RowAimOf<Lanes<N>> aim =
            aimAtHardStop<Lanes<N>>(row, j.bundle.rebounds != 0, ofFreeTrees(j), context, moving);
        const Mask<N> acts = mayAct(row, aim, along);
        if (!any(acts)) return;
        const Lanes<N> inverseMass = dot(axis, rest * axis);
        const Mask<N> lanes = acts & (inverseMass > noise);
        const WideVec3<N> impulse = solveRow<Lanes<N>>(row.impulse, aim, along, inverseMass, context, lanes) * axis;
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
    RAGTOP_INLINE void recordEnergy(const WideJoint<N>& joint, const WideTurns<N>& turns, const FactorOf<Lanes<N>>& first,
                                  const FactorOf<Lanes<N>>& second) {
        constexpr int kMost = RAGTOP_JOINT_FIELD(ball.mostEnergy);
        const Lanes<N> all(kNoForceLimit);
        Mask<N> recovers = all < all, twists = recovers, swings = recovers;
        const auto consider = [&](int side, Mask<N>& acts) {
            const Mask<N> pushes = ballStop(j, side).impulse > 0.0f;
            acts = acts | pushes;
            recovers = recovers | (pushes & (ballStop(j, side).margin < 0.0f));
        };
        if (j.bundle.features & BallRows::kTwist) {
            consider(kLowerStop, twists);
            consider(kUpperStop, twists);
        }
        if (j.bundle.features & BallRows::kSwing) consider(kSwingStop, swings);
        j.set(kMost, all);
        if (!any(recovers)) return;
        const PairVectorOf<Lanes<N>> u = joint.velocity(joint.arms);
        PairMotion<Lanes<N>> still = joint;
        still.apply(joint.arms, {-ragtop::solve(first, u.linear), WideVec3<N>{}});
        const WideVec3<N> closed = speed + (still.velocity(joint.arms).angular - u.angular);
        const WideVec3<N> rotation = heldRotation(turns, twists, swings, closed);
        j.set(kMost, select(recovers, 0.5f * dot(rotation, ragtop::solve(second, rotation)), all));
    }
    RAGTOP_INLINE void shedEnergy(const FactorOf<Lanes<N>>& second) {
        const Lanes<N> most = j.at(RAGTOP_JOINT_FIELD(ball.mostEnergy));
        const Mask<N> limited = most < Lanes<N>(kNoForceLimit);
        if (!any(limited)) return;
        const WideVec3<N> momentum = ragtop::solve(second, speed);
        const Lanes<N> energy = 0.5f * dot(speed, momentum);
        const Mask<N> lanes = limited & (energy > most);
        const WideVec3<N> impulse = (sqrt(most / energy) - Lanes<N>(1.0f)) * momentum;
        total = select(lanes, total + impulse, total);
        speed = select(lanes, speed + rest * impulse, speed);
    }
    RAGTOP_INLINE void solve(const WideJoint<N>& joint, const WideTurns<N>& turns, const FactorOf<Lanes<N>>& first,
                             const FactorOf<Lanes<N>>& second, const JointContext& context, bool moving) {
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
            compliant(RAGTOP_JOINT_FIELD(ball.viscousImpulse), WideVec3<N>{},
                      j.at(RAGTOP_JOINT_FIELD(ball.viscousDrag[0]) + pass), Lanes<N>(kNoForceLimit));
        if (features & BallRows::kFriction) friction(second, moving);
        if (features & BallRows::kTwist) {
            stop(kLowerStop, turns.twistAxis, context, moving);
            stop(kUpperStop, -turns.twistAxis, context, moving);
        }
        if (features & BallRows::kSwing) stop(kSwingStop, turns.swingAxis, context, moving);
        if (!(features & (BallRows::kSwing | BallRows::kTwist))) return;
        if (moving)
            recordEnergy(joint, turns, first, second);
        else
            shedEnergy(second);
    }
};

}  // namespace
}  // namespace ragtop
