// Stops, friction and the rows along one coordinate, in lanes: the operations of constraints/axis_rows.cpp.
// Included by wide_joints.inl.

namespace ragtop {
namespace {

template <int N>
struct WideMargins {
    Lanes<N> lower, upper;
};

/// As jointAngle.
template <int N>
RAGTOP_INLINE Lanes<N> jointAngle(Lanes<N> y, Lanes<N> x) {
    const Lanes<N> zero(0.0f), ax = select(x < zero, -x, x), ay = select(y < zero, -y, y);
    const Mask<N> isFlat = ax > ay;
    const Lanes<N> large = select(isFlat, ax, ay), small = select(isFlat, ay, ax);
    const Mask<N> beyond = small > arc_tangent::kTanOfEighth * large;
    const Lanes<N> t = divideOrZero(select(beyond, small - large, small), select(beyond, small + large, large)),
                   s = t * t;
    const Lanes<N> c9(arc_tangent::kC9), c7(arc_tangent::kC7), c5(arc_tangent::kC5), c3(arc_tangent::kC3);
    const Lanes<N> series = (((c9 * s + c7) * s + c5) * s + c3) * s * t + t;
    Lanes<N> angle = select(beyond, 0.25f * kPi + series, series);
    angle = select(ay > ax, 0.5f * kPi - angle, angle);
    angle = select(x < zero, kPi - angle, angle);
    return select(y < zero, -angle, angle);
}
template <int N>
RAGTOP_INLINE Lanes<N> angleAboutX(const WideQuat<N>& q) {
    const Mask<N> far = q.w < 0.0f;
    const Lanes<N> angle = 2.0f * jointAngle(select(far, -q.x, q.x), select(far, -q.w, q.w));
    return select(angle > -kPi, angle, Lanes<N>(kPi));
}

template <int N>
RAGTOP_INLINE Lanes<N> clamp(Lanes<N> value, Lanes<N> lower, Lanes<N> upper) {
    return select(value < lower, lower, select(value > upper, upper, value));
}
template <int N>
RAGTOP_INLINE Lanes<N> oneWhere(Mask<N> m) {
    return select(m, Lanes<N>(1.0f), Lanes<N>(0.0f));
}

constexpr int stopField(std::size_t offset) { return static_cast<int>(offset / sizeof(float)); }
#define RAGTOP_STOP_FIELD(member) stopField(offsetof(StopSide, member))

/// As beginStop, for hard stops: a margin that grows with `speed`. Stores the margin.
template <int N>
RAGTOP_INLINE Mask<N> beginStop(JointFields<N>& j, int side, int stop, Lanes<N> margin, Lanes<N> speed, float substep) {
    const Lanes<N> zero(0.0f), h(substep);
    const int impulseField = side + RAGTOP_STOP_FIELD(impulse), pressedField = side + RAGTOP_STOP_FIELD(pressed);
    j.set(side + RAGTOP_STOP_FIELD(margin), margin);
    const Lanes<N> impulse = j.at(impulseField);
    const Mask<N> loaded = impulse > zero, wasFree = !(j.at(pressedField) > zero);
    if (!j.bundle.rebounds) {
        const Mask<N> struck = loaded & wasFree;
        j.set(pressedField, oneWhere(loaded));
        j.set(impulseField, select(struck, zero, impulse));
        return struck;
    }
    const int reboundField = side + RAGTOP_STOP_FIELD(rebound), landingField = side + RAGTOP_STOP_FIELD(landing),
              lastField = side + RAGTOP_STOP_FIELD(lastSpeed), seenField = side + RAGTOP_STOP_FIELD(wasSeen);
    const Mask<N> rebounded = j.at(reboundField) > zero;
    const Mask<N> struck = loaded & (rebounded | wasFree), presses = loaded & (!rebounded);
    j.set(pressedField, oneWhere(presses));
    j.set(impulseField, select(struck, zero, impulse));
    const Mask<N> seen = (j.at(seenField) > zero) & (!rebounded);
    const Lanes<N> gained = select(seen, speed - j.at(lastField), zero);
    j.set(lastField, speed);
    j.set(seenField, Lanes<N>(1.0f));
    const Lanes<N> approach = -(speed + 0.5f * gained), change = select(gained < zero, -gained, gained);
    const Lanes<N> restitution = j.at(stop);
    const Mask<N> meets = (!presses) & (restitution > zero) & (approach > kRestingRebound * change) &
                          (!(margin >= h * (approach + change)));
    const Lanes<N> toEnd = select(margin > zero, margin / approach, zero), before = min(toEnd, h);
    const Lanes<N> rebound = restitution * approach;
    j.set(reboundField, select(meets, rebound, zero));
    j.set(landingField, select(meets, (rebound * (h - before) - margin) / h, j.at(landingField)));
    return struck;
}

/// What the row of a hard stop aims at, as aimAtStop, and where it may act, as mayAct.
template <int N>
struct WideStopAim {
    Lanes<N> impulse, target, massScale, impulseScale, upper;
    Mask<N> acts;

    RAGTOP_INLINE WideStopAim(const JointFields<N>& j, int side, Lanes<N> speed, const JointContext& context,
                              bool moving) {
        const Lanes<N> zero(0.0f), one(1.0f);
        impulse = j.at(side + RAGTOP_STOP_FIELD(impulse));
        const Lanes<N> margin = j.at(side + RAGTOP_STOP_FIELD(margin));
        const Mask<N> apart = margin > zero, loaded = impulse > zero;
        upper = Lanes<N>(kNoForceLimit);
        massScale = one;
        impulseScale = target = zero;
        if (moving) {
            const Softness& soft = context.softness;
            const Mask<N> carried = j.at(RAGTOP_JOINT_FIELD(ofFreeTree)) > zero, whole = apart | carried;
            const Lanes<N> rate = select(carried, Lanes<N>(kStopRate * soft.biasRate), Lanes<N>(soft.biasRate));
            const Lanes<N> recovery = -rate * margin,
                           fastest = j.at(side + RAGTOP_STOP_FIELD(recovery)) * Lanes<N>(context.inverseH);
            target = select(apart, -margin * Lanes<N>(context.inverseH), min(recovery, fastest));
            massScale = select(whole, one, Lanes<N>(soft.massScale));
            impulseScale = select(whole, zero, Lanes<N>(soft.impulseScale));
        } else {
            upper = select(apart & (!loaded), zero, upper);
        }
        if (j.bundle.rebounds) {
            const Mask<N> rebounds = j.at(side + RAGTOP_STOP_FIELD(rebound)) > zero;
            target = select(rebounds, j.at(side + (moving ? RAGTOP_STOP_FIELD(landing) : RAGTOP_STOP_FIELD(rebound))),
                            target);
            massScale = select(rebounds, one, massScale);
            impulseScale = select(rebounds, zero, impulseScale);
            upper = select(rebounds, Lanes<N>(kNoForceLimit), upper);
        }
        acts = loaded | ((upper > zero) & (speed < target));
    }
    /// The impulse after the row was solved; stores it.
    RAGTOP_INLINE Lanes<N> solve(JointFields<N>& j, int side, Lanes<N> speed, Lanes<N> inverseMass,
                                 Mask<N> lanes) const {
        const Lanes<N> solved = impulse - massScale * (speed - target) / inverseMass - impulseScale * impulse;
        const Lanes<N> result = select(lanes, clamp(solved, Lanes<N>(0.0f), upper), impulse);
        j.set(side + RAGTOP_STOP_FIELD(impulse), result);
        return result;
    }
};

/// As DryFriction::begin: where friction slides, its impulse is to be halved.
template <int N>
RAGTOP_INLINE Mask<N> beginFriction(JointFields<N>& j, int dry, Lanes<N> size, Lanes<N> kinetic, Lanes<N> breakaway) {
    const Lanes<N> bound = j.at(dry);
    const Mask<N> slides = (bound > 0.0f) & (size >= kAtBound * bound);
    j.set(dry, kinetic + select(slides, Lanes<N>(0.0f), breakaway));
    j.set(dry + 1, oneWhere(slides));
    return slides;
}
template <int N>
RAGTOP_INLINE Lanes<N> frictionBound(const JointFields<N>& j, int dry, bool moving) {
    const Lanes<N> bound = j.at(dry);
    return moving ? select(j.at(dry + 1) > 0.0f, 0.5f * bound, bound) : bound;
}

/// What the rows along a coordinate do to its speed.
template <int N>
struct WideAxis {
    JointFields<N> j;
    const JointContext& context;
    bool moving;
    Lanes<N> inverseMass, speed, total;
    Lanes<N> bend;  ///< of the mean rate, which rows that keep a range count
    Mask<N> movable;

    RAGTOP_INLINE WideAxis(JointFields<N>& joint, Lanes<N> mass, const JointContext& c, bool moves)
        : j(joint), context(c), moving(moves), inverseMass(mass), total(0.0f), bend(0.0f), movable(mass > 0.0f) {}

    RAGTOP_INLINE void add(int field, Lanes<N> impulse) {
        const Lanes<N> old = j.at(field), solved = select(movable, impulse, old), change = solved - old;
        j.set(field, solved);
        total = total + change;
        speed = speed + inverseMass * change;
    }
    RAGTOP_INLINE void rigid(int field, Lanes<N> target, Lanes<N> lower, Lanes<N> upper, const Softness& soft) {
        const Lanes<N> old = j.at(field);
        const Lanes<N> solved =
            old - Lanes<N>(soft.massScale) * (speed - target) / inverseMass - Lanes<N>(soft.impulseScale) * old;
        add(field, clamp(solved, lower, upper));
    }
    RAGTOP_INLINE void compliant(int field, Lanes<N> push, Lanes<N> drag, Lanes<N> limit) {
        const Lanes<N> old = j.at(field);
        add(field, clamp((push - drag * (speed - inverseMass * old)) / (1.0f + inverseMass * drag), -limit, limit));
    }
    /// `sign` −1: a stop whose margin shrinks with the coordinate.
    RAGTOP_INLINE void stop(int side, float sign) {
        const Lanes<N> along = sign * (moving ? speed + bend : speed);
        const WideStopAim<N> aim(j, side, along, context, moving);
        const Mask<N> lanes = aim.acts & movable;
        if (!any(lanes)) return;
        const Lanes<N> change = sign * (aim.solve(j, side, along, inverseMass, lanes) - aim.impulse);
        total = select(lanes, total + change, total);
        speed = select(lanes, speed + inverseMass * change, speed);
    }
    RAGTOP_INLINE void motor() {
        const Lanes<N> stalls = j.at(RAGTOP_JOINT_FIELD(axis.motorStalls)), half(moving ? 0.5f : 1.0f), one(1.0f);
        const Lanes<N> forward =
            Lanes<N>(context.h) * j.at(RAGTOP_JOINT_FIELD(axis.maxForward)) * select(stalls > 0.0f, half, one);
        const Lanes<N> reverse =
            Lanes<N>(-context.h) * j.at(RAGTOP_JOINT_FIELD(axis.maxReverse)) * select(stalls < 0.0f, half, one);
        rigid(RAGTOP_JOINT_FIELD(axis.motorImpulse), j.at(RAGTOP_JOINT_FIELD(axis.targetSpeed)), reverse, forward,
              kRigid);
    }
    RAGTOP_INLINE void locked() {
        const Lanes<N> all(kNoForceLimit), margin = j.at(RAGTOP_JOINT_FIELD(axis.atLower.margin));
        if (moving) speed = speed + bend;
        rigid(RAGTOP_JOINT_FIELD(axis.atLower.impulse),
              moving ? Lanes<N>(-context.softness.biasRate) * margin : Lanes<N>(0.0f), -all, all,
              moving ? context.softness : kRigid);
    }
    RAGTOP_INLINE void spring() {
        const Lanes<N> one(1.0f), h(context.h),
            share = moving ? j.at(RAGTOP_JOINT_FIELD(axis.springShare.moving))
                           : j.at(RAGTOP_JOINT_FIELD(axis.springShare.resting));
        const Lanes<N> drag = (1.0f / share - one) / inverseMass;
        const Lanes<N> force =
            j.at(RAGTOP_JOINT_FIELD(axis.feedForward)) -
            j.at(RAGTOP_JOINT_FIELD(axis.springStiffness)) * j.at(RAGTOP_JOINT_FIELD(axis.springError));
        compliant(RAGTOP_JOINT_FIELD(axis.springImpulse), h * force + drag * j.at(RAGTOP_JOINT_FIELD(axis.springSpeed)),
                  drag, h * j.at(RAGTOP_JOINT_FIELD(axis.maxSpring)));
    }
    RAGTOP_INLINE void viscous() {
        const Lanes<N> one(1.0f), share = moving ? j.at(RAGTOP_JOINT_FIELD(axis.viscousShare.moving))
                                                 : j.at(RAGTOP_JOINT_FIELD(axis.viscousShare.resting));
        compliant(RAGTOP_JOINT_FIELD(axis.viscousImpulse), Lanes<N>(0.0f), (1.0f / share - one) / inverseMass,
                  Lanes<N>(kNoForceLimit));
    }

    /// Solves all rows in turn, limits last; `total` is what they add.
    RAGTOP_INLINE void solve(Lanes<N> now) {
        const std::uint32_t features = j.bundle.features;
        speed = now;
        if (features & AxisRows::kSpring) spring();
        if (features & AxisRows::kViscous) viscous();
        if (features & AxisRows::kFriction) {
            const Lanes<N> bound = frictionBound(j, RAGTOP_JOINT_FIELD(axis.dry), moving);
            rigid(RAGTOP_JOINT_FIELD(axis.frictionImpulse), Lanes<N>(0.0f), -bound, bound, kRigid);
        }
        if (features & AxisRows::kMotor) motor();
        if (features & AxisRows::kLocked) locked();
        if (features & AxisRows::kLimit) {
            stop(RAGTOP_JOINT_FIELD(axis.atLower), 1.0f);
            stop(RAGTOP_JOINT_FIELD(axis.atUpper), -1.0f);
        }
    }
};

/// As axisImpulse.
template <int N>
RAGTOP_INLINE Lanes<N> axisImpulse(const JointFields<N>& j) {
    return j.at(RAGTOP_JOINT_FIELD(axis.springImpulse)) + j.at(RAGTOP_JOINT_FIELD(axis.viscousImpulse)) +
           j.at(RAGTOP_JOINT_FIELD(axis.frictionImpulse)) + j.at(RAGTOP_JOINT_FIELD(axis.motorImpulse)) +
           j.at(RAGTOP_JOINT_FIELD(axis.atLower.impulse)) - j.at(RAGTOP_JOINT_FIELD(axis.atUpper.impulse));
}

/// As beginAxis.
template <int N>
RAGTOP_INLINE Mask<N> beginAxis(JointFields<N>& j, const WideMargins<N>& margins, Lanes<N> springError,
                                Lanes<N> inverseMass, Lanes<N> speed, Lanes<N> reaction, const JointContext& context) {
    const std::uint32_t features = j.bundle.features;
    const Lanes<N> h(context.h), zero(0.0f);
    Mask<N> hadImpact = zero < zero;
    if (features & AxisRows::kSpring) {
        const WideSpring<N> spring(j, RAGTOP_JOINT_FIELD(axis.stiffness), inverseMass);
        const WideShares<N> shares = springShares(spring.stiffness, spring.damping, inverseMass, context.h);
        j.set(RAGTOP_JOINT_FIELD(axis.springStiffness), spring.stiffness);
        j.set(RAGTOP_JOINT_FIELD(axis.springError), springError);
        j.set(RAGTOP_JOINT_FIELD(axis.springShare.moving), shares.moving);
        j.set(RAGTOP_JOINT_FIELD(axis.springShare.resting), shares.resting);
        j.set(RAGTOP_JOINT_FIELD(axis.springStart), speed);
    }
    if (features & AxisRows::kViscous) {
        const WideShares<N> shares = springShares(zero, j.at(RAGTOP_JOINT_FIELD(axis.viscous)), inverseMass, context.h);
        j.set(RAGTOP_JOINT_FIELD(axis.viscousShare.moving), shares.moving);
        j.set(RAGTOP_JOINT_FIELD(axis.viscousShare.resting), shares.resting);
    }
    if (features & AxisRows::kFriction) {
        const Lanes<N> impulse = j.at(RAGTOP_JOINT_FIELD(axis.frictionImpulse));
        const Lanes<N> kinetic =
            h * j.at(RAGTOP_JOINT_FIELD(axis.friction)) + j.at(RAGTOP_JOINT_FIELD(axis.loadFriction)) * reaction;
        const Mask<N> slides = beginFriction(j, RAGTOP_JOINT_FIELD(axis.dry), select(impulse < zero, -impulse, impulse),
                                             kinetic, h * j.at(RAGTOP_JOINT_FIELD(axis.breakaway)));
        j.set(RAGTOP_JOINT_FIELD(axis.frictionImpulse), select(slides, 0.5f * impulse, impulse));
    }
    if (features & AxisRows::kMotor) {
        const Lanes<N> impulse = j.at(RAGTOP_JOINT_FIELD(axis.motorImpulse)),
                       most = j.at(RAGTOP_JOINT_FIELD(axis.maxForward)),
                       least = j.at(RAGTOP_JOINT_FIELD(axis.maxReverse)), bound(kAtBound * context.h);
        const Mask<N> forward = (impulse >= bound * most) & (most > zero);
        const Mask<N> reverse = (impulse <= -bound * least) & (least > zero) & (!forward);
        j.set(RAGTOP_JOINT_FIELD(axis.motorStalls),
              select(forward, Lanes<N>(1.0f), select(reverse, Lanes<N>(-1.0f), zero)));
        j.set(RAGTOP_JOINT_FIELD(axis.motorImpulse), select(forward | reverse, 0.5f * impulse, impulse));
    }
    if (features & AxisRows::kLimit) {
        constexpr int kRestitution = RAGTOP_JOINT_FIELD(axis.stop.restitution);
        hadImpact = beginStop(j, RAGTOP_JOINT_FIELD(axis.atLower), kRestitution, margins.lower, speed, context.h);
        hadImpact =
            hadImpact | beginStop(j, RAGTOP_JOINT_FIELD(axis.atUpper), kRestitution, margins.upper, -speed, context.h);
    } else if (features & AxisRows::kLocked) {
        j.set(RAGTOP_JOINT_FIELD(axis.atLower.margin), margins.lower);
    }
    return hadImpact;
}

/// The same without a beginning: only where the ends are.
template <int N>
RAGTOP_INLINE void storeMargins(JointFields<N>& j, const WideMargins<N>& margins) {
    j.set(RAGTOP_JOINT_FIELD(axis.atLower.margin), margins.lower);
    j.set(RAGTOP_JOINT_FIELD(axis.atUpper.margin), margins.upper);
}

}  // namespace
}  // namespace ragtop
