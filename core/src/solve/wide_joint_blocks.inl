// What each kind of joint adds to its rigid rows, in lanes, and where it keeps them between the passes. The rows are
// those of constraints/rows.h and joint_hinge.h. Included by wide_joints.inl.

namespace ragtop {
namespace {

/// As Softness, by lane.
template <int N>
struct WideSoftness {
    Lanes<N> biasRate, massScale, impulseScale;
};
/// A block while one pass works on it: what is carried is in memory, masses and errors only from pass to pass.
template <int N>
struct WideBlock : RigidBlockOf<Lanes<N>> {
    RAGTOP_INLINE void loadCarried(const JointFields<N>& j) {
        this->impulseFirst = j.vector(RAGTOP_JOINT_FIELD(block.impulseFirst));
        this->impulseSecond = j.vector(RAGTOP_JOINT_FIELD(block.impulseSecond));
    }
    RAGTOP_INLINE void storeCarried(JointFields<N>& j) const {
        j.set(RAGTOP_JOINT_FIELD(block.impulseFirst), this->impulseFirst);
        j.set(RAGTOP_JOINT_FIELD(block.impulseSecond), this->impulseSecond);
    }
    /// When a substep begins.
    RAGTOP_INLINE void begin(JointFields<N>& j, Mask<N> hadImpact) {
        this->startFirst = j.vector(RAGTOP_JOINT_FIELD(block.startFirst));
        this->startSecond = j.vector(RAGTOP_JOINT_FIELD(block.startSecond));
        beginBlock(*this, hadImpact);
        storeCarried(j);
        j.set(RAGTOP_JOINT_FIELD(block.startFirst), this->startFirst);
        j.set(RAGTOP_JOINT_FIELD(block.startSecond), this->startSecond);
    }
};

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
    block.storeCarried(j);
}
/// As closeJoint.
template <int N>
RAGTOP_INLINE void closeJoint(WideJoint<N>& j, const WideBlock<N>& block, Lanes<N> squaredTurn, float h) {
    const Mask<N> rigid = ofFreeTrees(j);
    if (!any(rigid)) return;
    const Lanes<N> share = openShare<Lanes<N>>(j.arms, j.turns(), dot(j.gap, j.gap), squaredTurn, h);
    const Mask<N> open = rigid & (share > 0.0f);
    if (any(open)) j.moveWhere(open, closingMove<Lanes<N>>(block, share));
}

/// Hinges and fixed joints.
template <int N>
RAGTOP_INLINE void storeBlock(JointFields<N>& j, const WideBlock<N>& block) {
    j.set(RAGTOP_JOINT_FIELD(block.impulseSecond), block.impulseSecond);
    j.set(RAGTOP_JOINT_FIELD(block.errorFirst), block.errorFirst);
    j.set(RAGTOP_JOINT_FIELD(block.errorSecond), block.errorSecond);
    j.set(RAGTOP_JOINT_FIELD(block.mass.first), block.mass.first);
    j.set(RAGTOP_JOINT_FIELD(block.mass.gain), block.mass.gain);
    j.set(RAGTOP_JOINT_FIELD(block.second), block.second);
}
template <int N>
RAGTOP_INLINE WideBlock<N> loadBlock(WideJoint<N>& j, std::uint32_t rigidRows) {
    WideBlock<N> block;
    block.loadCarried(j);
    block.rigidRows = rigidRows;
    block.errorFirst = j.gap = j.vector(RAGTOP_JOINT_FIELD(block.errorFirst));
    block.errorSecond = j.vector(RAGTOP_JOINT_FIELD(block.errorSecond));
    block.mass.first = j.factor(RAGTOP_JOINT_FIELD(block.mass.first));
    block.mass.gain = j.matrix(RAGTOP_JOINT_FIELD(block.mass.gain));
    block.second = j.factor(RAGTOP_JOINT_FIELD(block.second));
    if (rigidRows == 2) block.basis = j.matrix(RAGTOP_JOINT_FIELD(block.basis));
    return block;
}

// ---- balls

/// Features whose rows need the inverse of P.
constexpr std::uint32_t kSolvesTurn = BallRows::kFriction | BallRows::kSwing | BallRows::kTwist;

template <int N>
RAGTOP_INLINE WideBlock<N> refreshBall(const WideJoint<N>& j) {
    WideBlock<N> block;
    block.loadCarried(j);
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
    j.set(RAGTOP_JOINT_FIELD(block.errorFirst), j.gap);
    j.set(RAGTOP_JOINT_FIELD(block.mass.first), block.mass.first);
    if (j.bundle.features == 0) return;
    j.set(RAGTOP_JOINT_FIELD(block.mass.gain), block.mass.gain);
    j.set(RAGTOP_JOINT_FIELD(block.mass.rest), block.mass.rest);
    j.set(RAGTOP_JOINT_FIELD(block.noise), block.noise);
    if (j.bundle.features & kSolvesTurn) j.set(RAGTOP_JOINT_FIELD(block.second), block.second);
    const WideTurns<N> turns = findTurns(j);
    storeTurns(j, turns);
    block.begin(j, beginBall(j, turns, block.mass.rest, block.noise, context));
}
template <int N>
RAGTOP_INLINE WideBlock<N> loadBall(WideJoint<N>& j) {
    WideBlock<N> block;
    block.loadCarried(j);
    block.errorFirst = j.gap = j.vector(RAGTOP_JOINT_FIELD(block.errorFirst));
    block.mass.first = j.factor(RAGTOP_JOINT_FIELD(block.mass.first));
    if (j.bundle.features == 0) return block;
    block.mass.gain = j.matrix(RAGTOP_JOINT_FIELD(block.mass.gain));
    block.mass.rest = j.symmetric(RAGTOP_JOINT_FIELD(block.mass.rest));
    block.noise = j.at(RAGTOP_JOINT_FIELD(block.noise));
    if (j.bundle.features & kSolvesTurn) block.second = j.factor(RAGTOP_JOINT_FIELD(block.second));
    return block;
}
template <int N>
RAGTOP_INLINE WideTurns<N> loadTurns(const WideJoint<N>& j) {
    WideTurns<N> turns;
    if (j.bundle.features & BallRows::kSwing) turns.swingAxis = j.vector(RAGTOP_JOINT_FIELD(ball.swingAxis[0]));
    if (j.bundle.features & BallRows::kTwist) turns.twistAxis = j.vector(RAGTOP_JOINT_FIELD(ball.twistAxis));
    return turns;
}
template <int N>
RAGTOP_INLINE void solveBall(WideJoint<N>& j, WideBlock<N>& block, const WideTurns<N>& turns,
                             const JointContext& context, bool moving) {
    const WideSoftness<N> soft = softnessOf(j, Lanes<N>(0.0f), context, moving);
    solveRigid(j, block, meanVelocity(j, j.turns(), context, moving), soft);
    if (j.bundle.features == 0) return;
    WideBallTurn<N> turn{j, block.mass.rest, block.noise, j.velocity(j.arms).angular, WideVec3<N>{}};
    turn.solve(j, turns, block.mass.first, block.second, context, moving);
    const WideVec3<N> force = -(block.mass.gain * turn.total);
    j.set(RAGTOP_JOINT_FIELD(block.impulseFirst), block.impulseFirst + force);
    j.apply(j.arms, {force, turn.total});
}
template <int N>
RAGTOP_INLINE void relaxBall(WideJoint<N>& j, const JointContext& context) {
    WideBlock<N> block = refreshBall(j);
    closeJoint(j, block, Lanes<N>(0.0f), context.h);
    WideTurns<N> turns{};
    if (j.bundle.features != 0) {
        turns = findTurns(j);
        storeTurns(j, turns);
    }
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
        const Lanes<N> change = angle - rows.lastAngle;
        const typename Mask<N>::V turns = rows.turns + (change > kPi).v - (change < -kPi).v;
        rows.lastAngle = angle;
        rows.turns = turns;
        if (j.bundle.features == 0) return;
        const WideDouble<N> whole =
            WideDouble<N>(angle) + kTurn * WideDouble<N>(__builtin_convertvector(turns, typename WideDouble<N>::V));
        margins = {(whole - WideDouble<N>(rows.lower)).rounded(), (WideDouble<N>(rows.upper) - whole).rounded()};
        springError = (whole - WideDouble<N>(rows.target)).rounded();
    }
};

template <int N>
RAGTOP_INLINE WideBlock<N> refreshHinge(const WideJoint<N>& j, const WideQuat<N>& a, const WideQuat<N>& b) {
    WideBlock<N> block;
    block.loadCarried(j);
    block.rigidRows = 2;
    placeHinge<Lanes<N>>(block, a, b, j.gap, j.mass(j.arms));
    return block;
}
template <int N>
RAGTOP_INLINE void beginHinge(WideJoint<N>& j, const JointContext& context) {
    const WideQuat<N> a = j.frameA(), b = j.frameB();
    WideBlock<N> block = refreshHinge(j, a, b);
    storeBlock(j, block);
    j.set(RAGTOP_JOINT_FIELD(block.basis), block.basis);
    const Lanes<N> mass = freeMass(block);
    axisRows(j).inverseMass = mass;
    const WideAngle<N> angle(j, angleAboutX(conjugate(a) * b));
    const Lanes<N> zero(0.0f);
    if (j.bundle.features == 0) return block.begin(j, zero < zero);
    const WideVec3<N> xB = block.basis.cz, load = block.impulseFirst - dot(block.impulseFirst, xB) * xB;
    block.begin(j, beginAxis<N>(j, angle.margins, angle.springError, mass, dot(xB, j.velocity(j.arms).angular),
                             length(load), context.h));
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

    const AxisPassOf<Lanes<N>> axis = solveAxis<N>(j, freeInverseMass, dot(x, j.velocity(j.arms).angular), context, moving,
                                                   Lanes<N>(0.0f));
    const WideVec3<N> oldFirst = block.impulseFirst, oldSecond = block.impulseSecond;
    j.applyWhere(axis.movable, freeImpulse<Lanes<N>>(block, axis.total));
    block.impulseFirst = select(axis.movable, block.impulseFirst, oldFirst);
    block.impulseSecond = select(axis.movable, block.impulseSecond, oldSecond);
    block.storeCarried(j);
}
template <int N>
RAGTOP_INLINE void relaxHinge(WideJoint<N>& j, const JointContext& context) {
    const WideQuat<N> a = j.frameA(), b = j.frameB();
    WideBlock<N> block = refreshHinge(j, a, b);
    const WideAngle<N> angle(j, angleAboutX(conjugate(a) * b));
    j.set(RAGTOP_JOINT_FIELD(block.basis.cz), block.basis.cz);
    if (j.bundle.features != 0) storeMargins(j, angle.margins);
    closeJoint(j, block, squaredTurn(block), context.h);
    solveHinge(j, block, freeMass(block), context, false);
}

// ---- fixed joints

template <int N>
RAGTOP_INLINE WideBlock<N> refreshFixed(const WideJoint<N>& j) {
    WideBlock<N> block;
    block.loadCarried(j);
    block.rigidRows = 3;
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
    closeJoint(j, block, dot(block.errorSecond, block.errorSecond), context.h);
    solveFixed(j, block, context, false);
}

// ---- distances

/// Stores the direction and gives the distance.
template <int N>
RAGTOP_INLINE Lanes<N> refreshDistance(WideJoint<N>& j, WideVec3<N>& direction) {
    constexpr int kDirection = RAGTOP_JOINT_FIELD(block.basis.cz);
    const Lanes<N> distance = length(j.gap);
    const WideVec3<N> last = j.vector(kDirection);
    direction = (1.0f / distance) * j.gap;
    const Mask<N> apart = distance > 0.0f;
    if (any(!apart)) direction = select(apart, direction, select(dot(last, last) > 0.0f, last, axisX(j.frameA())));
    j.set(kDirection, direction);
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
    j.set(RAGTOP_JOINT_FIELD(block.errorFirst), j.gap);
    beginAxis<N>(j, marginsOf(j, distance), distance - axisRows(j).target, mass,
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
