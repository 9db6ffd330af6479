// The rows that turn a ball's bodies, in lanes: the operations of constraints/joint_ball.cpp.
// Included by wide_joints.inl.

namespace ragtop {
namespace {

/// How far a ball's rows are from their ends, and their axes.
template <int N>
struct WideTurns {
    Lanes<N> swing, twistLower, twistUpper;
    WideVec3<N> swingAxis, twistAxis;
};

template <int N>
RAGTOP_INLINE WideTurns<N> findTurns(const WideJoint<N>& j) {
    WideTurns<N> turns;
    if (j.bundle.features == 0) return turns;
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
    const auto& resistance = partAt<ResistanceOf<Lanes<N>>>(j, RAGTOP_JOINT_FIELD(ball.resistance));
    if (features & BallRows::kSpring) {
        const WideQuat<N> wanted = j.frameA() * j.quaternion(RAGTOP_JOINT_FIELD(ball.target));
        j.set(RAGTOP_JOINT_FIELD(ball.springError), turnVector(j.frameB() * conjugate(wanted)));
        const TunedSpringOf<Lanes<N>> spring =
            partAt<SpringTuningOf<Lanes<N>>>(j, RAGTOP_JOINT_FIELD(ball.spring)).at(inverseInertia);
        j.set(RAGTOP_JOINT_FIELD(ball.springStiffness), spring.stiffness);
        setDrags(j, RAGTOP_JOINT_FIELD(ball.springDrag[0]), spring.stiffness, spring.damping, inverseInertia,
                 context.h);
    }
    if (features & BallRows::kViscous)
        setDrags(j, RAGTOP_JOINT_FIELD(ball.viscousDrag[0]), zero, resistance.viscous, inverseInertia, context.h);
    if (features & BallRows::kFriction) {
        const WideVec3<N> impulse = j.vector(RAGTOP_JOINT_FIELD(ball.frictionImpulse));
        const Lanes<N> kinetic = resistance.kinetic(h, length(j.vector(RAGTOP_JOINT_FIELD(block.impulseFirst))));
        const Mask<N> slides = ballFriction(j).begin(length(impulse), kinetic, h * resistance.breakaway);
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

/// A ball's rows in turn: solveBall and solveBallStops.
template <int N>
struct WideBallTurn : BallTurnOf<Lanes<N>> {
    JointFields<N> j;
    const JointContext& context;
    bool moving;

    RAGTOP_INLINE WideVec3<N>& vector(int field) { return partAt<WideVec3<N>>(j, field); }
    RAGTOP_INLINE void stopAt(int field, const WideVec3<N>& axis) {
        StopSideOf<Lanes<N>>& side = ballStop(j, field);
        const Lanes<N> along = dot(axis, this->speed);
        const RowAimOf<Lanes<N>> aim =
            aimAtHardStop<Lanes<N>>(side, j.bundle.rebounds != 0, ofFreeTrees(j), context, moving);
        const Mask<N> acts = mayAct(side, aim, along);
        if (any(acts)) this->stop(side, axis, aim, along, context, acts);
    }
    /// As recordEnergy.
    RAGTOP_INLINE void recordEnergy(const WideJoint<N>& joint, const WideTurns<N>& turns) {
        const std::uint32_t features = j.bundle.features;
        const Lanes<N> all(kNoForceLimit);
        Lanes<N> most = all;
        Mask<N> recovers = all < all, twists = recovers, swings = recovers;
        const auto consider = [&](int field, Mask<N>& acts) __attribute__((always_inline)) {
            const Mask<N> pushes = ballStop(j, field).impulse > 0.0f;
            acts = acts | pushes;
            recovers = recovers | (pushes & (ballStop(j, field).margin < 0.0f));
        };
        if (features & BallRows::kTwist) consider(kLowerStop, twists), consider(kUpperStop, twists);
        if (features & BallRows::kSwing) consider(kSwingStop, swings);
        if (any(recovers)) {
            HeldRotationOf<Lanes<N>> held(*this, joint, joint.arms);
            held.hold(turns.twistAxis, twists);
            if (features & BallRows::kSwing) held.hold(turns.swingAxis, swings);
            most = select(recovers, held.energy(), all);
        }
        j.set(RAGTOP_JOINT_FIELD(ball.mostEnergy), most);
    }
    RAGTOP_INLINE void solveRows(const WideJoint<N>& joint, const WideTurns<N>& turns) {
        const std::uint32_t features = j.bundle.features;
        const Lanes<N> h(context.h);
        const int pass = moving ? 0 : 1;
        if (features & BallRows::kSpring)
            this->comply(
                vector(RAGTOP_JOINT_FIELD(ball.springImpulse)),
                (-h * j.at(RAGTOP_JOINT_FIELD(ball.springStiffness))) * j.vector(RAGTOP_JOINT_FIELD(ball.springError)),
                j.at(RAGTOP_JOINT_FIELD(ball.springDrag[0]) + pass), h * j.at(RAGTOP_JOINT_FIELD(ball.spring.most)));
        if (features & BallRows::kViscous)
            this->comply(vector(RAGTOP_JOINT_FIELD(ball.viscousImpulse)), WideVec3<N>{},
                         j.at(RAGTOP_JOINT_FIELD(ball.viscousDrag[0]) + pass), Lanes<N>(kNoForceLimit));
        if (features & BallRows::kFriction)
            this->rub(vector(RAGTOP_JOINT_FIELD(ball.frictionImpulse)), ballFriction(j).boundOf(moving));
        if (features & BallRows::kTwist) stopAt(kLowerStop, turns.twistAxis), stopAt(kUpperStop, -turns.twistAxis);
        if (features & BallRows::kSwing) stopAt(kSwingStop, turns.swingAxis);
        if (!(features & (BallRows::kSwing | BallRows::kTwist))) return;
        if (moving)
            recordEnergy(joint, turns);
        else
            this->shed(j.at(RAGTOP_JOINT_FIELD(ball.mostEnergy)));
    }
};

}  // namespace
}  // namespace ragtop
