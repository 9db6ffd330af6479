// What each kind of joint adds to its rigid rows, in lanes, and where it keeps them between the passes. The rows are
// those of constraints/rows.h and joint_hinge.h. Included by wide_joints.inl.

namespace ragtop {
namespace {

/// Features of balls whose rows need the inverse of P.
constexpr std::uint32_t kSolvesTurn = BallRows::kFriction | BallRows::kSwing | BallRows::kTwist;

/// As Softness, by lane.
template <int N>
struct WideSoftness {
    Lanes<N> biasRate, massScale, impulseScale;
};
/// A block while one pass works on it, and the one in memory: what is carried, and what is kept from pass to pass.
template <int N>
using WideBlock = RigidBlockOf<Lanes<N>>;
template <int N>
RAGTOP_INLINE WideBlock<N>& blockAt(const JointFields<N>& j) {
    static_assert(offsetof(WideBlock<N>, noise) == N * offsetof(RigidBlock, noise));
    return partAt<WideBlock<N>>(j, RAGTOP_JOINT_FIELD(block));
}
template <int N>
RAGTOP_INLINE WideBlock<N> carriedBlock(const JointFields<N>& j, std::uint32_t rigidRows) {
    const WideBlock<N>& kept = blockAt(j);
    WideBlock<N> block;
    block.rigidRows = rigidRows;
    block.impulseFirst = kept.impulseFirst, block.impulseSecond = kept.impulseSecond;
    block.startFirst = kept.startFirst, block.startSecond = kept.startSecond;
    return block;
}
/// Takes over what one pass keeps for the next, of balls only what their features need.
template <int N>
RAGTOP_INLINE void keep(WideBlock<N>& to, const WideBlock<N>& from, const JointBundle& bundle) {
    const bool ball = bundle.kind == JointKind::ball;
    to.errorFirst = from.errorFirst;
    to.mass.first = from.mass.first;
    if (ball && bundle.features == 0) return;
    to.mass.gain = from.mass.gain;
    if (ball) {
        to.mass.rest = from.mass.rest;
        to.noise = from.noise;
    } else {
        to.errorSecond = from.errorSecond;
    }
    if (!ball || (bundle.features & kSolvesTurn)) to.second = from.second;
    if (bundle.kind == JointKind::hinge) to.basis = from.basis;
}
template <int N>
RAGTOP_INLINE WideBlock<N> loadBlock(const JointFields<N>& j, std::uint32_t rigidRows) {
    WideBlock<N> block = carriedBlock(j, rigidRows);
    keep(block, blockAt(j), j.bundle);
    return block;
}
template <int N>
RAGTOP_INLINE void storeCarried(const JointFields<N>& j, const WideBlock<N>& block) {
    blockAt(j).impulseFirst = block.impulseFirst;
    blockAt(j).impulseSecond = block.impulseSecond;
}
/// When a substep begins.
template <int N>
RAGTOP_INLINE void begin(const JointFields<N>& j, WideBlock<N>& block, Mask<N> hadImpact) {
    beginBlock(block, hadImpact);
    storeCarried(j, block);
    blockAt(j).startFirst = block.startFirst;
    blockAt(j).startSecond = block.startSecond;
}
/// As softnessOf in the moving pass, rigid in the other.
template <int N>
RAGTOP_INLINE WideSoftness<N> softnessOf(const WideJoint<N>& j, Lanes<N> squaredTurn, const JointContext& context,
                                         bool moving) {
    const Lanes<N> zero(0.0f), one(1.0f);
    if (!moving) return {zero, one, zero};
    const Softness& soft = context.softness;
    const Lanes<N> rate(soft.biasRate), mass(soft.massScale), impulse(soft.impulseScale);
    const Mask<N> rigid = ofFreeTrees(j);
    if (!any(rigid)) return {rate, mass, impulse};
    const Lanes<N> share = openShare<Lanes<N>>(j.arms, j.turns(), dot(j.gap, j.gap), squaredTurn, context.h);
    return {select(rigid, rate * (one - share), rate), select(rigid, one, mass), select(rigid, zero, impulse)};
}
/// The velocity that rigid rows are to undo: the mean of the substep where positions move, w being how the bodies turn.
template <int N>
RAGTOP_INLINE PairVectorOf<Lanes<N>> meanVelocity(const WideJoint<N>& j, const TurningOf<Lanes<N>>& w,
                                                  const JointContext& context, bool moving) {
    PairVectorOf<Lanes<N>> u = j.velocity(j.arms);
    if (moving) u.linear = u.linear + curvingArms(w, j.arms, context.h);
    return u;
}
template <int N>
RAGTOP_INLINE void solveRigid(WideJoint<N>& j, WideBlock<N>& block, const PairVectorOf<Lanes<N>>& u,
                              const WideSoftness<N>& soft, const ReactionOf<Lanes<N>>& held = {}) {
    solveBlock<Lanes<N>>(block, j, j.arms, u, soft, held);
    storeCarried(j, block);
}
/// As closeJoint.
template <int N>
RAGTOP_INLINE void closeJoint(WideJoint<N>& j, const WideBlock<N>& block, Lanes<N> squaredTurn,
                              const JointContext& context) {
    const Mask<N> rigid = ofFreeTrees(j);
    if (context.settling || !any(rigid)) return;
    const Lanes<N> share = openShare<Lanes<N>>(j.arms, j.turns(), dot(j.gap, j.gap), squaredTurn, context.h);
    const Mask<N> open = rigid & (share > 0.0f);
    if (any(open)) j.moveWhere(open, closingMove<Lanes<N>>(block, share));
}

// ---- balls

template <int N>
RAGTOP_INLINE WideBlock<N> refreshBall(const WideJoint<N>& j) {
    WideBlock<N> block = carriedBlock(j, 0);
    block.errorFirst = j.gap;
    const std::uint32_t features = j.bundle.features;
    refreshMass<Lanes<N>>(block, j.mass(j.arms),
                          features == 0            ? BlockMass::first
                          : features & kSolvesTurn ? BlockMass::whole
                                                   : BlockMass::moving);
    return block;
}
template <int N>
RAGTOP_INLINE void beginBallJoint(WideJoint<N>& j, const JointContext& context) {
    WideBlock<N> block = refreshBall(j);
    keep(blockAt(j), block, j.bundle);
    if (j.bundle.features == 0) return;
    const WideTurns<N> turns = findTurns(j);
    storeTurns(j, turns);
    begin(j, block, beginBall(j, turns, block.mass.rest, block.noise, context));
}
template <int N>
RAGTOP_INLINE WideTurns<N> loadTurns(const WideJoint<N>& j) {
    WideTurns<N> turns;
    if (j.bundle.features == 0) return turns;
    if (j.bundle.features & BallRows::kSwing) turns.swingAxis = j.vector(RAGTOP_JOINT_FIELD(ball.swingAxis[0]));
    turns.twistAxis =
        j.bundle.features & BallRows::kTwist ? j.vector(RAGTOP_JOINT_FIELD(ball.twistAxis)) : WideVec3<N>{};
    return turns;
}
template <int N>
RAGTOP_INLINE void solveBall(WideJoint<N>& j, WideBlock<N>& block, const WideTurns<N>& turns,
                             const JointContext& context, bool moving) {
    const WideSoftness<N> soft = softnessOf(j, Lanes<N>(0.0f), context, moving);
    solveRigid(j, block, meanVelocity(j, j.turns(), context, moving), soft);
    if (j.bundle.features == 0) return;
    WideBallTurn<N> turn{{block, j.velocity(j.arms).angular, WideVec3<N>{}}, j, context, moving};
    turn.solveRows(j, turns);
    const WideVec3<N> force = -(block.mass.gain * turn.total);
    blockAt(j).impulseFirst = block.impulseFirst + force;
    j.apply(j.arms, {force, turn.total});
}
template <int N>
RAGTOP_INLINE void relaxBall(WideJoint<N>& j, const JointContext& context) {
    WideBlock<N> block = refreshBall(j);
    closeJoint(j, block, Lanes<N>(0.0f), context);
    const WideTurns<N> turns = findTurns(j);
    storeTurns(j, turns);
    solveBall(j, block, turns, context, false);
}

// ---- hinges

/// The angle with its turns: notes it and gives the margins of its range and the error of its spring.
template <int N>
struct WideAngle {
    WideMargins<N> margins;
    Lanes<N> springError;

    RAGTOP_INLINE WideAngle(WideJoint<N>& j, Lanes<N> angle) {
        AxisRowsOf<Lanes<N>>& rows = axisRows(j);
        const Lanes<N> change = angle - rows.angle.last;
        const typename Mask<N>::V turns = rows.angle.turns + (change > kPi).v - (change < -kPi).v;
        rows.angle.last = angle;
        rows.angle.turns = turns;
        if (j.bundle.features == 0) return;
        const WideDouble<N> whole =
            WideDouble<N>(angle) + kTurn * WideDouble<N>(__builtin_convertvector(turns, typename WideDouble<N>::V));
        margins = {(whole - WideDouble<N>(rows.lower)).rounded(), (WideDouble<N>(rows.upper) - whole).rounded()};
        springError = (whole - WideDouble<N>(rows.spring.target)).rounded();
    }
};

template <int N>
RAGTOP_INLINE WideBlock<N> refreshHinge(const WideJoint<N>& j, const WideQuat<N>& a, const WideQuat<N>& b) {
    WideBlock<N> block = carriedBlock(j, 2);
    placeHinge<Lanes<N>>(block, a, b, j.gap, j.mass(j.arms));
    return block;
}
template <int N>
RAGTOP_INLINE void beginHinge(WideJoint<N>& j, const JointContext& context) {
    const WideQuat<N> a = j.frameA(), b = j.frameB();
    WideBlock<N> block = refreshHinge(j, a, b);
    keep(blockAt(j), block, j.bundle);
    blockAt(j).impulseSecond = block.impulseSecond;
    const Lanes<N> mass = freeMass(block);
    axisRows(j).inverseMass = mass;
    const WideAngle<N> angle(j, angleAboutX(conjugate(a) * b));
    const Lanes<N> zero(0.0f);
    if (j.bundle.features == 0) return begin(j, block, zero < zero);
    const WideVec3<N> xB = block.basis.cz, load = block.impulseFirst - dot(block.impulseFirst, xB) * xB;
    begin(j, block,
          beginAxis<N>(j, angle.margins, angle.springError, mass, dot(xB, j.velocity(j.arms).angular), length(load),
                       context.h));
}
template <int N>
RAGTOP_INLINE Lanes<N> squaredTurn(const WideBlock<N>& hinge) {
    return hinge.errorSecond.x * hinge.errorSecond.x + hinge.errorSecond.y * hinge.errorSecond.y;
}
template <int N>
RAGTOP_INLINE void solveHinge(WideJoint<N>& j, WideBlock<N>& block, Lanes<N> freeInverseMass,
                              const JointContext& context, bool moving) {
    const WideVec3<N> x = block.basis.cz;
    const WideSoftness<N> soft = softnessOf(j, squaredTurn(block), context, moving);
    const TurningOf<Lanes<N>> w = j.turnsAbout(x);
    PairVectorOf<Lanes<N>> u = meanVelocity(j, w, context, moving);
    if (moving) u.angular = u.angular + curvingAxes(w, x, context.h);
    ReactionOf<Lanes<N>> held{};
    if (moving && j.bundle.features != 0) held = reactionTo<Lanes<N>>(block, ownImpulse(axisRows(j)));
    solveRigid(j, block, u, soft, held);
    if (j.bundle.features == 0) return;

    const AxisPassOf<Lanes<N>> axis =
        solveAxis<N>(j, freeInverseMass, dot(x, j.velocity(j.arms).angular), context, moving, Lanes<N>(0.0f));
    const WideVec3<N> oldFirst = block.impulseFirst, oldSecond = block.impulseSecond;
    j.applyWhere(axis.movable, freeImpulse<Lanes<N>>(block, axis.total));
    block.impulseFirst = select(axis.movable, block.impulseFirst, oldFirst);
    block.impulseSecond = select(axis.movable, block.impulseSecond, oldSecond);
    storeCarried(j, block);
}
template <int N>
RAGTOP_INLINE void relaxHinge(WideJoint<N>& j, const JointContext& context) {
    const WideQuat<N> a = j.frameA(), b = j.frameB();
    WideBlock<N> block = refreshHinge(j, a, b);
    const WideAngle<N> angle(j, angleAboutX(conjugate(a) * b));
    blockAt(j).basis.cz = block.basis.cz;
    if (j.bundle.features != 0) storeMargins(j, angle.margins);
    closeJoint(j, block, squaredTurn(block), context);
    solveHinge(j, block, freeMass(block), context, false);
}

// ---- fixed joints

template <int N>
RAGTOP_INLINE WideBlock<N> refreshFixed(const WideJoint<N>& j) {
    WideBlock<N> block = carriedBlock(j, 3);
    block.errorFirst = j.gap;
    block.errorSecond = rotationError(j.frameA(), j.frameB());
    refreshMass<Lanes<N>>(block, j.mass(j.arms), BlockMass::whole);
    return block;
}
template <int N>
RAGTOP_INLINE void solveFixed(WideJoint<N>& j, WideBlock<N>& block, const JointContext& context, bool moving) {
    const WideSoftness<N> soft = softnessOf(j, dot(block.errorSecond, block.errorSecond), context, moving);
    solveRigid(j, block, meanVelocity(j, j.turnsTogether(), context, moving), soft);
}
template <int N>
RAGTOP_INLINE void relaxFixed(WideJoint<N>& j, const JointContext& context) {
    WideBlock<N> block = refreshFixed(j);
    closeJoint(j, block, dot(block.errorSecond, block.errorSecond), context);
    solveFixed(j, block, context, false);
}

// ---- distances

/// Stores the direction and gives the distance.
template <int N>
RAGTOP_INLINE Lanes<N> refreshDistance(WideJoint<N>& j, WideVec3<N>& direction) {
    const Lanes<N> distance = length(j.gap);
    const WideVec3<N> last = blockAt(j).basis.cz;
    direction = (1.0f / distance) * j.gap;
    const Mask<N> apart = distance > 0.0f;
    if (any(!apart)) direction = select(apart, direction, select(dot(last, last) > 0.0f, last, axisX(j.frameA())));
    blockAt(j).basis.cz = direction;
    return distance;
}
template <int N>
RAGTOP_INLINE WideMargins<N> marginsOf(const WideJoint<N>& j, Lanes<N> coordinate) {
    return {coordinate - axisRows(j).lower, axisRows(j).upper - coordinate};
}
template <int N>
RAGTOP_INLINE void beginDistance(WideJoint<N>& j, const JointContext& context) {
    WideVec3<N> direction;
    const Lanes<N> distance = refreshDistance(j, direction), mass = j.mass(j.arms, direction);
    axisRows(j).inverseMass = mass;
    blockAt(j).errorFirst = j.gap;
    beginAxis<N>(j, marginsOf(j, distance), distance - axisRows(j).spring.target, mass,
                 dot(direction, j.velocity(j.arms).linear), Lanes<N>(0.0f), context.h);
}
template <int N>
RAGTOP_INLINE void solveDistance(WideJoint<N>& j, const WideVec3<N>& direction, Lanes<N> mass,
                                 const JointContext& context, bool moving) {
    const Lanes<N> speed = dot(direction, j.velocity(j.arms).linear);
    Lanes<N> bend(0.0f);
    constexpr std::uint32_t kRange = AxisRows::kLimit | AxisRows::kLocked;
    if (moving && (j.bundle.features & kRange)) bend = j.receding(j.arms, j.gap, speed, context.h);
    j.apply(j.arms, {solveAxis<N>(j, mass, speed, context, moving, bend).total * direction, WideVec3<N>{}});
}
template <int N>
RAGTOP_INLINE void relaxDistance(WideJoint<N>& j, const JointContext& context) {
    WideVec3<N> direction;
    const Lanes<N> distance = refreshDistance(j, direction);
    storeMargins(j, marginsOf(j, distance));
    solveDistance(j, direction, j.mass(j.arms, direction), context, false);
}

}  // namespace
}  // namespace ragtop
