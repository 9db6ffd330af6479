// Friction, twist and rolling of a bundle. Included by wide_kernels.inl.

namespace ragtop {
namespace {

/// The tangential impulse that the cone lets through of a wanted one under the load Σ λ: at most μ Σ λ while the surfaces
/// stick, a share of that once they slide; against the wanted one in any case. Across the grain the cone has another
/// width, and is an ellipse.
template <int N, int L, bool kGround>
RAGTOP_INLINE WideVec3<N> intoCone(const ContactBundle<N, L, kGround>& c, const WideVec3<N>& wanted, Lanes<N> load, Lanes<N>& sliding) {
    Lanes<N> squared = dot(wanted, wanted);
    if ((c.traits & contact::kUneven) != 0) {
        const Lanes<N> cross = c.field(contact::kCross);
        const Lanes<N> across = dot(wanted, c.vector(contact::kAcross));
        squared = squared + cross * across * across;
    }
    const Lanes<N> size = sqrt(squared), zero(0.0f), one(1.0f);
    const Lanes<N> atRest = c.field(contact::kFriction) * load, moving = c.field(contact::kSlidingShare) * atRest;
    const Mask<N> slides = size > select(sliding > zero, moving, atRest);
    sliding = select(slides, one, zero);
    return select(slides, moving / max(size, Lanes<N>(1e-30f)), one) * wanted;
}

/// The impulse about an axis, or vector of axes, that keeps below a limit.
template <int N>
RAGTOP_INLINE WideVec3<N> intoBall(const WideVec3<N>& wanted, Lanes<N> limit) {
    const Lanes<N> size = sqrt(dot(wanted, wanted));
    return select(size > limit, limit / max(size, Lanes<N>(1e-30f)), Lanes<N>(1.0f)) * wanted;
}

/// −K⁻¹ s for a slip s, in the tangent plane.
template <int N, int L, bool kGround>
RAGTOP_INLINE WideVec3<N> stoppingImpulse(const ContactBundle<N, L, kGround>& c, const WideVec3<N>& slip) {
    const auto mass = [&](int entry) { return c.field(contact::kFrictionMass + entry); };
    return -(SymmetricMatrix<N>{mass(0), mass(1), mass(2), mass(3), mass(4), mass(5)} * slip);
}

/// Twist: |λ| ≤ Σ (μ lever + ρ_spin) λn about the normal. Rolling: |λ| ≤ ρ_roll Σ λn.
template <int N, int L, bool kGround>
RAGTOP_INLINE void solveTurning(ContactBundle<N, L, kGround>& c, Lanes<N> total, Lanes<N> leverTotal) {
    const Lanes<N> mu = c.field(contact::kFriction);
    const Lanes<N> old = c.field(contact::kTwistImpulse), limit = mu * leverTotal + c.rare(contact::kSpinning, contact::kSpins) * total;
    const Lanes<N> wanted = old - c.field(contact::kTwistMass) * dot(c.normal, c.relativeSpin());
    const Lanes<N> twist = min(max(wanted, -limit), limit), change = twist - old;
    c.set(contact::kTwistImpulse, twist);
    // What does not wait for the change comes first: rows are bound by how long one waits for the other.
    c.applyAngular(change, c.normal);

    if ((c.traits & contact::kRolls) == 0) return;
    const Lanes<N> rolling = c.field(contact::kRolling);
    const WideVec3<N> before = c.vector(contact::kRollImpulse);
    const WideVec3<N> stopping = before - c.field(contact::kRollMass) * c.relativeSpin();
    const WideVec3<N> roll = select(rolling > 0.0f, intoBall(stopping, rolling * total), before);
    c.set(contact::kRollImpulse, roll);
    c.applyAngular(roll - before);
}

/// How far B has slipped on A in this step, with the displacement that moveArms has counted, and whether it has turned
/// little enough against A for that to be known. What rolls goes as far as the arc that it turns by, and what both turn by
/// together is no slip, however far: arms in the middle of the way make it so.
template <int N>
struct Slip {
    WideVec3<N> way, turnA;
    Mask<N> known;
};
template <int N, int L, bool kGround>
RAGTOP_INLINE Slip<N> slipOf(const ContactBundle<N, L, kGround>& c, const WideVec3<N>& dp,
                             const WideVec3<N>& displacement, const WideQuat<N>& dqA, const WideQuat<N>& dqB,
                             float elapsed) {
    const WideVec3<N> rA = c.arm(contact::kCenter), rB = c.armB(rA);
    const Lanes<N> middle(0.5f);
    const WideVec3<N> turnB = turnOf(dqB);
    WideVec3<N> way = dp, turn = turnB, turnA{};
    if constexpr (kGround) {
        way = way + cross(turnB, rB);
    } else {
        turnA = turnOf(dqA);
        const WideVec3<N> half = middle * c.shift;
        way = way + (cross(turnB, rB + (middle * displacement - half)) - cross(turnA, rA - half));
        turn = turn - turnA;
    }
    if ((c.traits & contact::kMovingSurface) != 0) way = way + Lanes<N>(elapsed) * c.vector(contact::kSurface);
    return {way - dot(way, c.normal) * c.normal, turnA, dot(turn, turn) < Lanes<N>(kFirstOrderTurn * kFirstOrderTurn)};
}

/// What turning adds by the end of the substep to the speed at which B slips: the point goes on with B, by kFollow, and with
/// it the arms, d/dt (ωB × rB − ωA × rA) = −(f ωA + (1 − f) ωB) × (vB − vA). Without it what stands on a carousel would
/// leave its circle along the tangent in every substep.
template <int N, int L>
RAGTOP_INLINE WideVec3<N> slipAhead(const ContactBundle<N, L, false>& c, Lanes<N> h) {
    const WideVec3<N> turn = h * (c.wB + c.field(contact::kFollow) * (c.wA - c.wB));
    const Lanes<N> most(contact::kAhead * contact::kAhead);
    return cross(c.vB - c.vA, select(dot(turn, turn) < most, Lanes<N>(1.0f), Lanes<N>(0.0f)) * turn);
}

/// Friction about the centre, inside the cone. The soft pass also takes back what has slipped since the surfaces stick,
/// at the rate at which it pushes out; where they slide, or roll fast, the place is let go. What is kept turns with A.
template <bool kBias, int N, int L, bool kGround>
RAGTOP_INLINE void solveFriction(ContactBundle<N, L, kGround>& c, Lanes<N> total, Lanes<N> rate, const Slip<N>& slip,
                                 const SolverContext& context) {
    const Lanes<N> zero(0.0f), one(1.0f);
    const WideVec3<N> rA = c.arm(contact::kCenter), rB = c.armB(rA);
    WideVec3<N> speed = c.relativeVelocity(rA, rB);
    if ((c.traits & contact::kMovingSurface) != 0) speed = speed + c.vector(contact::kSurface);
    const WideVec3<N> kept = c.vector(contact::kStick);
    Lanes<N> sliding = c.field(contact::kSliding);
    if constexpr (kBias && !kGround) speed = speed + slipAhead(c, Lanes<N>(context.h));
    if constexpr (kBias)
        speed = speed + select(slip.known & (sliding <= zero), rate, zero) * (kept + slip.way);
    const WideVec3<N> old = c.vector(contact::kFrictionImpulse);
    const WideVec3<N> friction = intoCone(c, old + stoppingImpulse(c, speed), total, sliding);
    c.set(contact::kFrictionImpulse, friction);
    c.set(contact::kSliding, sliding);
    c.applyImpulse(friction - old, rA, rB);
    if constexpr (!kBias) {
        const Lanes<N> holds = select(slip.known & (sliding <= zero) & (total > zero), one, zero);
        const WideVec3<N> place = holds * kept - (one - holds) * slip.way;
        if (!context.lastSubstep) return c.set(contact::kStick, place);
        WideVec3<N> next = holds * (kept + slip.way);
        if constexpr (!kGround) next = next + cross(slip.turnA, next);
        c.set(contact::kStick, next + WideVec3<N>{zero, zero, zero});
    }
}

}  // namespace
}  // namespace ragtop
