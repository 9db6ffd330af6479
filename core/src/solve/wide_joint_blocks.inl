// The rigid rows of joints in lanes and what each kind adds to them: the operations of constraints/rows.cpp,
// joint_ball.cpp, joint_hinge.cpp, joint_fixed.cpp and joint_distance.cpp. Included by wide_joints.inl.

namespace ragtop {
namespace {

/// Masses and errors of a block whose linear half comes first. Kinds fill in what they have.
template <int N>
struct WideBlock {
    WideFactor<N> first, second;
    WideMat3<N> gain, basis;
    SymmetricMatrix<N> rest;
    WideVec3<N> errorSecond;
    Lanes<N> noise;
};

/// As eliminate.
template <int N>
RAGTOP_INLINE void eliminate(WideBlock<N>& block, const WideMass<N>& k) {
    const WideMat3<N>& c = k.coupling;
    const WideMat3<N> k12{{c.cx.x, c.cy.x, c.cz.x}, {c.cx.y, c.cy.y, c.cz.y}, {c.cx.z, c.cy.z, c.cz.z}};
    block.first = factorize(k.linear, diagonal(k.linear));
    block.gain = {solveFor(block.first, k12.cx), solveFor(block.first, k12.cy), solveFor(block.first, k12.cz)};
    const WideMat3<N>& g = block.gain;
    block.rest = {k.angular.xx - dot(k12.cx, g.cx), k.angular.xy - dot(k12.cx, g.cy), k.angular.xz - dot(k12.cx, g.cz),
                  k.angular.yy - dot(k12.cy, g.cy), k.angular.yz - dot(k12.cy, g.cz), k.angular.zz - dot(k12.cz, g.cz)};
}

template <int N>
RAGTOP_INLINE void beginBlock(WideJoint<N>& j, Mask<N> hadImpact) {
    constexpr int kFirst = RAGTOP_JOINT_FIELD(block.impulseFirst), kSecond = RAGTOP_JOINT_FIELD(block.impulseSecond),
                  kStartFirst = RAGTOP_JOINT_FIELD(block.startFirst),
                  kStartSecond = RAGTOP_JOINT_FIELD(block.startSecond);
    const WideVec3<N> first = select(hadImpact, j.vector(kStartFirst), j.vector(kFirst));
    const WideVec3<N> second = select(hadImpact, j.vector(kStartSecond), j.vector(kSecond));
    j.set(kFirst, first), j.set(kStartFirst, first);
    j.set(kSecond, second), j.set(kStartSecond, second);
}

/// As Reaction.
template <int N>
struct WideReaction {
    WideVec3<N> first = nothing<N>(), second = nothing<N>();
};
template <int N>
RAGTOP_INLINE WideReaction<N> reactionTo(const WideBlock<N>& block, Lanes<N> amount) {
    const WideFactor<N>& f = block.second;
    const WideMat3<N>& e = block.basis;
    const WideVec3<N> rigid = -amount * ((f.l20 - f.l10 * f.l21) * e.cx + f.l21 * e.cy);
    return {-(block.gain * (rigid + amount * e.cz)), rigid};
}

/// As Softness, by lane.
template <int N>
struct WideSoftness {
    Lanes<N> biasRate, massScale, impulseScale;
};
/// As openShare.
template <int N>
RAGTOP_INLINE Lanes<N> openShare(const WideJoint<N>& j, Lanes<N> squaredTurn, float h) {
    const Lanes<N> armA = length(j.armA), armB = length(j.armB), arms = armA + armB;
    const Lanes<N> error = sqrt(dot(j.gap, j.gap) + (arms * arms) * squaredTurn);
    const Lanes<N> near = Lanes<N>(kBending * h * h) * (armA * dot(j.wA, j.wA) + armB * dot(j.wB, j.wB));
    return select(error > near, 1.0f - near / error, Lanes<N>(0.0f));
}
template <int N>
RAGTOP_INLINE Mask<N> ofFreeTrees(const WideJoint<N>& j) {
    return j.at(RAGTOP_JOINT_FIELD(ofFreeTree)) > 0.0f;
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
    return {select(rigid, rate * (one - openShare(j, squaredTurn, context.h)), rate), select(rigid, one, mass),
            select(rigid, zero, impulse)};
}

template <int N>
struct WideHalves {
    WideVec3<N> first, second;
};
/// The end of solveBlock: softens what the rows ask for, carries and applies it.
template <int N>
RAGTOP_INLINE void addToBlock(WideJoint<N>& j, const WideHalves<N>& p, const WideSoftness<N>& soft,
                              const WideReaction<N>& held = {}) {
    constexpr int kFirst = RAGTOP_JOINT_FIELD(block.impulseFirst), kSecond = RAGTOP_JOINT_FIELD(block.impulseSecond);
    const WideVec3<N> first = j.vector(kFirst), second = j.vector(kSecond);
    const WideVec3<N> change1 = soft.massScale * p.first - soft.impulseScale * (first - held.first),
                      change2 = soft.massScale * p.second - soft.impulseScale * (second - held.second);
    j.set(kFirst, first + change1);
    j.set(kSecond, second + change2);
    j.apply(change1, change2);
}
template <int N>
RAGTOP_INLINE WideVec3<N> firstResidual(const WideJoint<N>& j, const WideTurning<N>& w, const WideSoftness<N>& soft,
                                        const JointContext& context, bool moving) {
    WideVec3<N> u = j.linearVelocity();
    if (moving) u = u + j.curvingArms(w, context.h);
    return u + soft.biasRate * j.gap;
}
/// Where a joint is closed by moving its bodies, and by which share.
template <int N>
struct WideOpening {
    Mask<N> lanes;
    Lanes<N> share;
};
/// False where nothing is.
template <int N>
RAGTOP_INLINE bool isOpen(const WideJoint<N>& j, Lanes<N> squaredTurn, float h, WideOpening<N>& open) {
    const Mask<N> rigid = ofFreeTrees(j);
    if (!any(rigid)) return false;
    open.share = openShare(j, squaredTurn, h);
    open.lanes = rigid & (open.share > 0.0f);
    return any(open.lanes);
}
/// As closeJoint: `answer` is what the rows ask for to be closed.
template <int N>
RAGTOP_INLINE void closeJoint(WideJoint<N>& j, const WideOpening<N>& open, const WideHalves<N>& answer) {
    j.moveWhere(open.lanes, open.share * answer.first, open.share * answer.second);
}

// ---- balls

/// Features whose rows need the inverse of P.
constexpr std::uint32_t kSolvesTurn = BallRows::kFriction | BallRows::kSwing | BallRows::kTwist;

template <int N>
RAGTOP_INLINE WideBlock<N> refreshBall(const WideJoint<N>& j) {
    WideBlock<N> block;
    const WideMass<N> k = j.mass();
    if (j.bundle.features == 0) {
        block.first = factorize(k.linear, diagonal(k.linear));
        return block;
    }
    eliminate(block, k);
    block.noise = kZeroPivot * (k.angular.xx + k.angular.yy + k.angular.zz);
    if (j.bundle.features & kSolvesTurn) block.second = factorize(block.rest, diagonal(k.angular));
    return block;
}
template <int N>
RAGTOP_INLINE void beginBallJoint(WideJoint<N>& j, const JointContext& context) {
    const WideBlock<N> block = refreshBall(j);
    j.set(RAGTOP_JOINT_FIELD(block.errorFirst), j.gap);
    j.set(RAGTOP_JOINT_FIELD(block.mass.first), block.first);
    if (j.bundle.features == 0) return;
    j.set(RAGTOP_JOINT_FIELD(block.mass.gain), block.gain);
    j.set(RAGTOP_JOINT_FIELD(block.mass.rest), block.rest);
    j.set(RAGTOP_JOINT_FIELD(block.noise), block.noise);
    if (j.bundle.features & kSolvesTurn) j.set(RAGTOP_JOINT_FIELD(block.second), block.second);
    const WideTurns<N> turns = findTurns(j);
    storeTurns(j, turns);
    beginBlock(j, beginBall(j, turns, block.rest, block.noise, context));
}
template <int N>
RAGTOP_INLINE WideBlock<N> loadBall(WideJoint<N>& j) {
    WideBlock<N> block;
    j.gap = j.vector(RAGTOP_JOINT_FIELD(block.errorFirst));
    block.first = j.factor(RAGTOP_JOINT_FIELD(block.mass.first));
    if (j.bundle.features == 0) return block;
    block.gain = j.matrix(RAGTOP_JOINT_FIELD(block.mass.gain));
    block.rest = j.symmetric(RAGTOP_JOINT_FIELD(block.mass.rest));
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
RAGTOP_INLINE void solveBall(WideJoint<N>& j, const WideBlock<N>& block, const WideTurns<N>& turns,
                             const JointContext& context, bool moving) {
    const WideSoftness<N> soft = softnessOf(j, Lanes<N>(0.0f), context, moving);
    addToBlock(j, {-solveFor(block.first, firstResidual(j, j.turns(), soft, context, moving)), nothing<N>()}, soft);
    if (j.bundle.features == 0) return;
    WideBallTurn<N> turn{j, block.rest, block.noise, j.angularVelocity(), nothing<N>()};
    turn.solve(j, turns, block.first, block.second, context, moving);
    const WideVec3<N> force = -(block.gain * turn.total);
    constexpr int kFirst = RAGTOP_JOINT_FIELD(block.impulseFirst);
    j.set(kFirst, j.vector(kFirst) + force);
    j.apply(force, turn.total);
}
template <int N>
RAGTOP_INLINE void relaxBall(WideJoint<N>& j, const JointContext& context) {
    const WideBlock<N> block = refreshBall(j);
    WideOpening<N> open;
    if (isOpen(j, Lanes<N>(0.0f), context.h, open))
        closeJoint(j, open, WideHalves<N>{-solveFor(block.first, j.gap), nothing<N>()});
    if (j.bundle.features == 0) return solveBall(j, block, {}, context, false);
    const WideTurns<N> turns = findTurns(j);
    storeTurns(j, turns);
    solveBall(j, block, turns, context, false);
}

// ---- hinges

/// As axisError.
template <int N>
RAGTOP_INLINE WideVec3<N> axisError(const WideVec3<N>& xA, const WideVec3<N>& xB) {
    const WideVec3<N> axis = cross(xA, xB);
    const Lanes<N> onePlusCos = 1.0f + dot(xA, xB);
    const Mask<N> regular = onePlusCos > kOpposite;
    const WideVec3<N> error = sqrt(2.0f / onePlusCos) * axis;
    if (!any(!regular)) return error;
    return select(regular, error, Lanes<N>(2.0f) * unitOr(axis, perpendicular(xB)));
}
/// The angle with its turns: notes it and gives the margins of its range and the error of its spring.
template <int N>
struct WideAngle {
    WideMargins<N> margins;
    Lanes<N> springError;

    RAGTOP_INLINE WideAngle(WideJoint<N>& j, Lanes<N> angle) {
        constexpr int kLast = RAGTOP_JOINT_FIELD(axis.lastAngle), kTurns = RAGTOP_JOINT_FIELD(axis.turns);
        const Lanes<N> change = angle - j.at(kLast);
        const typename Mask<N>::V turns = bits(j.at(kTurns)) + (change > kPi).v - (change < -kPi).v;
        j.set(kLast, angle);
        j.set(kTurns, Lanes<N>(reinterpret_cast<typename Lanes<N>::V>(turns)));
        if (j.bundle.features == 0) return;
        const WideDouble<N> whole =
            WideDouble<N>(angle) + kTurn * WideDouble<N>(__builtin_convertvector(turns, typename WideDouble<N>::V));
        margins.lower = (whole - WideDouble<N>(j.at(RAGTOP_JOINT_FIELD(axis.lower)))).rounded();
        margins.upper = (WideDouble<N>(j.at(RAGTOP_JOINT_FIELD(axis.upper))) - whole).rounded();
        springError = (whole - WideDouble<N>(j.at(RAGTOP_JOINT_FIELD(axis.target)))).rounded();
    }
};

/// Directions, errors and masses; the axis of B is the last column of the basis.
template <int N>
RAGTOP_INLINE WideBlock<N> refreshHinge(WideJoint<N>& j, const WideQuat<N>& a, const WideQuat<N>& b) {
    WideBlock<N> block;
    const WideVec3<N> xA = axisX(a), yA = axisY(a), xB = axisX(b);
    const WideVec3<N> across = yA - dot(yA, xB) * xB;
    const Lanes<N> size = length(across);
    WideVec3<N> y = (1.0f / size) * across;
    if (any(!(size > 0.0f))) y = select(size > 0.0f, y, perpendicular(xB));
    block.basis = {y, cross(xB, y), xB};
    const WideVec3<N> error = axisError(xA, xB);
    block.errorSecond = {dot(y, error), dot(block.basis.cy, error), Lanes<N>(0.0f)};
    constexpr int kSecond = RAGTOP_JOINT_FIELD(block.impulseSecond);
    const WideVec3<N> carried = j.vector(kSecond);
    j.set(kSecond, carried - dot(carried, xB) * xB);

    const WideMass<N> k = j.mass();
    eliminate(block, k);
    const WideMat3<N>& e = block.basis;
    const WideVec3<N> mx = block.rest * e.cx, my = block.rest * e.cy, mz = block.rest * e.cz;
    block.second = factorize(
        SymmetricMatrix<N>{dot(e.cx, mx), dot(e.cx, my), dot(e.cx, mz), dot(e.cy, my), dot(e.cy, mz), dot(e.cz, mz)},
        WideVec3<N>{dot(e.cx, k.angular * e.cx), dot(e.cy, k.angular * e.cy), dot(e.cz, k.angular * e.cz)});
    return block;
}
template <int N>
RAGTOP_INLINE Lanes<N> freeMass(const WideBlock<N>& block) {
    return divideOrZero(Lanes<N>(1.0f), block.second.inverse2);
}
template <int N>
RAGTOP_INLINE void beginHinge(WideJoint<N>& j, const JointContext& context) {
    const WideQuat<N> a = j.frameA(), b = j.frameB();
    const WideBlock<N> block = refreshHinge(j, a, b);
    j.set(RAGTOP_JOINT_FIELD(block.errorFirst), j.gap);
    j.set(RAGTOP_JOINT_FIELD(block.errorSecond), block.errorSecond);
    j.set(RAGTOP_JOINT_FIELD(block.mass.first), block.first);
    j.set(RAGTOP_JOINT_FIELD(block.mass.gain), block.gain);
    j.set(RAGTOP_JOINT_FIELD(block.second), block.second);
    j.set(RAGTOP_JOINT_FIELD(block.basis), block.basis);
    const Lanes<N> mass = freeMass(block);
    j.set(RAGTOP_JOINT_FIELD(axis.inverseMass), mass);
    const WideAngle<N> angle(j, angleAboutX(conjugate(a) * b));
    const Lanes<N> zero(0.0f);
    if (j.bundle.features == 0) return beginBlock(j, zero < zero);
    const WideVec3<N> impulse = j.vector(RAGTOP_JOINT_FIELD(block.impulseFirst)), xB = block.basis.cz;
    const WideVec3<N> load = impulse - dot(impulse, xB) * xB;
    beginBlock(
        j, beginAxis(j, angle.margins, angle.springError, mass, dot(xB, j.angularVelocity()), length(load), context));
}
template <int N>
RAGTOP_INLINE WideBlock<N> loadHinge(WideJoint<N>& j) {
    WideBlock<N> block;
    j.gap = j.vector(RAGTOP_JOINT_FIELD(block.errorFirst));
    block.errorSecond = j.vector(RAGTOP_JOINT_FIELD(block.errorSecond));
    block.first = j.factor(RAGTOP_JOINT_FIELD(block.mass.first));
    block.gain = j.matrix(RAGTOP_JOINT_FIELD(block.mass.gain));
    block.second = j.factor(RAGTOP_JOINT_FIELD(block.second));
    block.basis = j.matrix(RAGTOP_JOINT_FIELD(block.basis));
    return block;
}
/// What the rows ask for, as answer of rows.cpp; of the error of axes `bias`.
template <int N>
RAGTOP_INLINE WideHalves<N> answerOfHinge(const WideBlock<N>& block, const WideVec3<N>& residual,
                                          const WideVec3<N>& turn, Lanes<N> bias) {
    const WideFactor<N>& f = block.second;
    const WideMat3<N>& e = block.basis;
    const WideVec3<N> speed = turn - transposeTimes(block.gain, residual);
    const Lanes<N> x = dot(e.cx, speed) + bias * block.errorSecond.x, y = dot(e.cy, speed) + bias * block.errorSecond.y;
    const Lanes<N> solvedY = f.inverse1 * (y - f.l10 * x), solvedX = f.inverse0 * x - f.l10 * solvedY;
    const WideVec3<N> second = -(solvedX * e.cx + solvedY * e.cy);
    return {-solveFor(block.first, residual) - block.gain * second, second};
}
template <int N>
RAGTOP_INLINE Lanes<N> squaredTurn(const WideBlock<N>& hinge) {
    return hinge.errorSecond.x * hinge.errorSecond.x + hinge.errorSecond.y * hinge.errorSecond.y;
}
template <int N>
RAGTOP_INLINE void solveHinge(WideJoint<N>& j, const WideBlock<N>& block, Lanes<N> freeInverseMass,
                              const JointContext& context, bool moving) {
    const WideMat3<N>& e = block.basis;
    const WideSoftness<N> soft = softnessOf(j, squaredTurn(block), context, moving);
    const WideTurning<N> w = j.turnsAbout(e.cz);
    WideVec3<N> turn = j.angularVelocity();
    if (moving) turn = turn + curvingAxes(w, e.cz, context.h);
    WideReaction<N> held;
    if (moving && j.bundle.features != 0) held = reactionTo(block, axisImpulse(j));
    addToBlock(j, answerOfHinge(block, firstResidual(j, w, soft, context, moving), turn, soft.biasRate), soft, held);
    if (j.bundle.features == 0) return;

    WideAxis<N> axis(j, freeInverseMass, context, moving);
    axis.solve(dot(e.cz, j.angularVelocity()));
    // As freeImpulse.
    const WideReaction<N> reaction = reactionTo(block, axis.total);
    const WideVec3<N> second = reaction.second + axis.total * e.cz;
    constexpr int kFirst = RAGTOP_JOINT_FIELD(block.impulseFirst), kSecond = RAGTOP_JOINT_FIELD(block.impulseSecond);
    const WideVec3<N> oldFirst = j.vector(kFirst), oldSecond = j.vector(kSecond);
    j.set(kFirst, select(axis.movable, oldFirst + reaction.first, oldFirst));
    j.set(kSecond, select(axis.movable, oldSecond + reaction.second, oldSecond));
    j.applyWhere(axis.movable, reaction.first, second);
}
template <int N>
RAGTOP_INLINE void relaxHinge(WideJoint<N>& j, const JointContext& context) {
    const WideQuat<N> a = j.frameA(), b = j.frameB();
    const WideBlock<N> block = refreshHinge(j, a, b);
    const WideAngle<N> angle(j, angleAboutX(conjugate(a) * b));
    j.set(RAGTOP_JOINT_FIELD(block.basis.cz), block.basis.cz);
    if (j.bundle.features != 0) storeMargins(j, angle.margins);
    WideOpening<N> open;
    if (isOpen(j, squaredTurn(block), context.h, open))
        closeJoint(j, open, answerOfHinge(block, j.gap, nothing<N>(), Lanes<N>(1.0f)));
    solveHinge(j, block, freeMass(block), context, false);
}

// ---- fixed joints

template <int N>
RAGTOP_INLINE WideBlock<N> refreshFixed(const WideJoint<N>& j) {
    WideBlock<N> block;
    const WideQuat<N> q = j.frameB() * conjugate(j.frameA());
    const Lanes<N> s = select(q.w < 0.0f, Lanes<N>(-2.0f), Lanes<N>(2.0f));
    block.errorSecond = {s * q.x, s * q.y, s * q.z};
    const WideMass<N> k = j.mass();
    eliminate(block, k);
    block.second = factorize(block.rest, diagonal(k.angular));
    return block;
}
template <int N>
RAGTOP_INLINE void storeFixed(WideJoint<N>& j, const WideBlock<N>& block) {
    j.set(RAGTOP_JOINT_FIELD(block.errorFirst), j.gap);
    j.set(RAGTOP_JOINT_FIELD(block.errorSecond), block.errorSecond);
    j.set(RAGTOP_JOINT_FIELD(block.mass.first), block.first);
    j.set(RAGTOP_JOINT_FIELD(block.mass.gain), block.gain);
    j.set(RAGTOP_JOINT_FIELD(block.second), block.second);
}
template <int N>
RAGTOP_INLINE WideBlock<N> loadFixed(WideJoint<N>& j) {
    WideBlock<N> block;
    j.gap = j.vector(RAGTOP_JOINT_FIELD(block.errorFirst));
    block.errorSecond = j.vector(RAGTOP_JOINT_FIELD(block.errorSecond));
    block.first = j.factor(RAGTOP_JOINT_FIELD(block.mass.first));
    block.gain = j.matrix(RAGTOP_JOINT_FIELD(block.mass.gain));
    block.second = j.factor(RAGTOP_JOINT_FIELD(block.second));
    return block;
}
template <int N>
RAGTOP_INLINE WideHalves<N> answerOfFixed(const WideBlock<N>& block, const WideVec3<N>& residual,
                                          const WideVec3<N>& turn, Lanes<N> bias) {
    const WideVec3<N> speed = turn - transposeTimes(block.gain, residual);
    const WideVec3<N> second = -solveFor(block.second, speed + bias * block.errorSecond);
    return {-solveFor(block.first, residual) - block.gain * second, second};
}
template <int N>
RAGTOP_INLINE void solveFixed(WideJoint<N>& j, const WideBlock<N>& block, const JointContext& context, bool moving) {
    const WideSoftness<N> soft = softnessOf(j, dot(block.errorSecond, block.errorSecond), context, moving);
    const WideVec3<N> residual = firstResidual(j, j.turnsTogether(), soft, context, moving);
    addToBlock(j, answerOfFixed(block, residual, j.angularVelocity(), soft.biasRate), soft);
}
template <int N>
RAGTOP_INLINE void relaxFixed(WideJoint<N>& j, const JointContext& context) {
    const WideBlock<N> block = refreshFixed(j);
    WideOpening<N> open;
    if (isOpen(j, dot(block.errorSecond, block.errorSecond), context.h, open))
        closeJoint(j, open, answerOfFixed(block, j.gap, nothing<N>(), Lanes<N>(1.0f)));
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
    return {coordinate - j.at(RAGTOP_JOINT_FIELD(axis.lower)), j.at(RAGTOP_JOINT_FIELD(axis.upper)) - coordinate};
}
template <int N>
RAGTOP_INLINE void beginDistance(WideJoint<N>& j, const JointContext& context) {
    WideVec3<N> direction;
    const Lanes<N> distance = refreshDistance(j, direction), mass = j.mass(direction);
    j.set(RAGTOP_JOINT_FIELD(axis.inverseMass), mass);
    j.set(RAGTOP_JOINT_FIELD(block.errorFirst), j.gap);
    beginAxis(j, marginsOf(j, distance), distance - j.at(RAGTOP_JOINT_FIELD(axis.target)), mass,
              dot(direction, j.linearVelocity()), Lanes<N>(0.0f), context);
}
template <int N>
RAGTOP_INLINE void solveDistance(WideJoint<N>& j, const WideVec3<N>& direction, Lanes<N> mass,
                                 const JointContext& context, bool moving) {
    WideAxis<N> axis(j, mass, context, moving);
    const Lanes<N> speed = dot(direction, j.linearVelocity());
    constexpr std::uint32_t kRange = AxisRows::kLimit | AxisRows::kLocked;
    if (moving && (j.bundle.features & kRange)) axis.bend = j.receding(speed, context.h);
    axis.solve(speed);
    j.apply(axis.total * direction, nothing<N>());
}
template <int N>
RAGTOP_INLINE void relaxDistance(WideJoint<N>& j, const JointContext& context) {
    WideVec3<N> direction;
    const Lanes<N> distance = refreshDistance(j, direction);
    storeMargins(j, marginsOf(j, distance));
    solveDistance(j, direction, j.mass(direction), context, false);
}

}  // namespace
}  // namespace ragtop
