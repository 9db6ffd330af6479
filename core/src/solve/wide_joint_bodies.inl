// A bundle of joints in lanes, the bodies they join and the masses of their rows. The operations are those of
// constraints/rows.cpp in the same order, so that a joint has the same bits alone and in a lane.
// Included by wide_joints.inl.

namespace ragtop {
namespace {

template <int N>
struct WideMat3 {
    WideVec3<N> cx, cy, cz;
};
template <int N>
RAGTOP_INLINE WideVec3<N> operator*(const WideMat3<N>& m, const WideVec3<N>& v) {
    return v.x * m.cx + v.y * m.cy + v.z * m.cz;
}
template <int N>
RAGTOP_INLINE WideVec3<N> transposeTimes(const WideMat3<N>& m, const WideVec3<N>& v) {
    return {dot(m.cx, v), dot(m.cy, v), dot(m.cz, v)};
}
template <int N>
RAGTOP_INLINE WideVec3<N> diagonal(const SymmetricMatrix<N>& m) {
    return {m.xx, m.yy, m.zz};
}
template <int N>
RAGTOP_INLINE SymmetricMatrix<N> operator*(Lanes<N> s, const SymmetricMatrix<N>& m) {
    return {s * m.xx, s * m.xy, s * m.xz, s * m.yy, s * m.yz, s * m.zz};
}
template <int N>
RAGTOP_INLINE SymmetricMatrix<N> operator+(const SymmetricMatrix<N>& a, const SymmetricMatrix<N>& b) {
    return {a.xx + b.xx, a.xy + b.xy, a.xz + b.xz, a.yy + b.yy, a.yz + b.yz, a.zz + b.zz};
}
template <int N>
RAGTOP_INLINE WideVec3<N> nothing() {
    const Lanes<N> zero(0.0f);
    return {zero, zero, zero};
}
template <int N>
RAGTOP_INLINE Lanes<N> length(const WideVec3<N>& a) {
    return sqrt(dot(a, a));
}
template <int N>
RAGTOP_INLINE WideVec3<N> unitOr(const WideVec3<N>& a, const WideVec3<N>& fallback) {
    const Lanes<N> l = length(a);
    return select(l > 0.0f, (1.0f / l) * a, fallback);
}

/// As perpendicular of math.h.
template <int N>
RAGTOP_INLINE WideVec3<N> perpendicular(const WideVec3<N>& n) {
    const Lanes<N> zero(0.0f), one(1.0f);
    const Mask<N> flat = n.x * n.x < 0.5f;
    const WideVec3<N> other{select(flat, one, zero), select(flat, zero, one), zero};
    return unitOr(cross(n, other), WideVec3<N>{one, zero, zero});
}

/// L D Lᵀ, as Factor3.
template <int N>
struct WideFactor {
    Lanes<N> inverse0, inverse1, inverse2, l10, l20, l21;
};
template <int N>
RAGTOP_INLINE Lanes<N> inverseOrZero(Lanes<N> pivot, Lanes<N> scale) {
    return select(pivot > kZeroPivot * scale, 1.0f / pivot, Lanes<N>(0.0f));
}
template <int N>
RAGTOP_INLINE WideFactor<N> factorize(const SymmetricMatrix<N>& m, const WideVec3<N>& scale) {
    WideFactor<N> f;
    f.inverse0 = inverseOrZero(m.xx, scale.x);
    f.l10 = m.xy * f.inverse0;
    f.l20 = m.xz * f.inverse0;
    f.inverse1 = inverseOrZero(m.yy - f.l10 * m.xy, scale.y);
    const Lanes<N> yz = m.yz - f.l20 * m.xy;
    f.l21 = yz * f.inverse1;
    f.inverse2 = inverseOrZero(m.zz - f.l20 * m.xz - f.l21 * yz, scale.z);
    return f;
}
template <int N>
RAGTOP_INLINE WideVec3<N> solveFor(const WideFactor<N>& f, const WideVec3<N>& right) {
    const Lanes<N> y = right.y - f.l10 * right.x;
    const Lanes<N> z = f.inverse2 * (right.z - f.l20 * right.x - f.l21 * y);
    const Lanes<N> solvedY = f.inverse1 * y - f.l21 * z;
    return {f.inverse0 * right.x - f.l10 * solvedY - f.l20 * z, solvedY, z};
}

/// K of the relative motion, as PairMass.
template <int N>
struct WideMass {
    SymmetricMatrix<N> linear, angular;
    WideMat3<N> coupling;
};
template <int N>
RAGTOP_INLINE WideMat3<N> turning(const SymmetricMatrix<N>& i, const WideVec3<N>& r) {
    return {{i.xy * r.z - i.xz * r.y, i.yy * r.z - i.yz * r.y, i.yz * r.z - i.zz * r.y},
            {i.xz * r.x - i.xx * r.z, i.yz * r.x - i.xy * r.z, i.zz * r.x - i.xz * r.z},
            {i.xx * r.y - i.xy * r.x, i.xy * r.y - i.yy * r.x, i.xz * r.y - i.yz * r.x}};
}
template <int N>
RAGTOP_INLINE SymmetricMatrix<N> outerCross(const WideMat3<N>& w, const WideVec3<N>& r) {
    return {r.z * w.cx.y - r.y * w.cx.z, r.z * w.cy.y - r.y * w.cy.z, r.z * w.cz.y - r.y * w.cz.z,
            r.x * w.cy.z - r.z * w.cy.x, r.x * w.cz.z - r.z * w.cz.x, r.y * w.cz.x - r.x * w.cz.y};
}

/// As curving of constraints/rows.h.
template <int N>
RAGTOP_INLINE WideVec3<N> curving(const WideVec3<N>& w, const WideVec3<N>& r, float h) {
    const WideVec3<N> speed = cross(w, r);
    const Lanes<N> square = Lanes<N>(h * h) * dot(w, w);
    const Lanes<N> turn2 = divideOrZero(Lanes<N>(h * h) * dot(speed, speed), dot(r, r));
    const Lanes<N> share = 1.0f / (12.0f + square * (1.0f + 0.125f * square) + 108.0f * (turn2 * turn2));
    return cross((Lanes<N>(6 * h) * share) * w, speed) - (2.0f * square * share) * speed;
}

template <int N>
struct WideTurning {
    WideVec3<N> a, b;
};
template <int N>
RAGTOP_INLINE WideVec3<N> curvingAxes(const WideTurning<N>& w, const WideVec3<N>& x, float h) {
    return cross(x, curving(w.b, x, h) - curving(w.a, x, h));
}

/// The memory of a bundle. What solves rows holds this and not the joint, which then need not be in memory itself.
template <int N>
struct JointFields {
    const JointBundle& bundle;
    float* fields;

    RAGTOP_INLINE Lanes<N> at(int f) const { return Lanes<N>::load(fields + f * N); }
    RAGTOP_INLINE WideVec3<N> vector(int f) const { return {at(f), at(f + 1), at(f + 2)}; }
    RAGTOP_INLINE WideQuat<N> quaternion(int f) const { return {at(f), at(f + 1), at(f + 2), at(f + 3)}; }
    RAGTOP_INLINE void set(int f, Lanes<N> value) { value.store(fields + f * N); }
    RAGTOP_INLINE void set(int f, const WideVec3<N>& v) { set(f, v.x), set(f + 1, v.y), set(f + 2, v.z); }
    RAGTOP_INLINE SymmetricMatrix<N> symmetric(int f) const {
        return {at(f), at(f + 1), at(f + 2), at(f + 3), at(f + 4), at(f + 5)};
    }
    RAGTOP_INLINE void set(int f, const SymmetricMatrix<N>& m) {
        set(f, m.xx), set(f + 1, m.xy), set(f + 2, m.xz), set(f + 3, m.yy), set(f + 4, m.yz), set(f + 5, m.zz);
    }
    RAGTOP_INLINE WideMat3<N> matrix(int f) const { return {vector(f), vector(f + 3), vector(f + 6)}; }
    RAGTOP_INLINE void set(int f, const WideMat3<N>& m) { set(f, m.cx), set(f + 3, m.cy), set(f + 6, m.cz); }
    RAGTOP_INLINE WideFactor<N> factor(int f) const {
        return {at(f), at(f + 1), at(f + 2), at(f + 3), at(f + 4), at(f + 5)};
    }
    RAGTOP_INLINE void set(int f, const WideFactor<N>& m) {
        set(f, m.inverse0), set(f + 1, m.inverse1), set(f + 2, m.inverse2);
        set(f + 3, m.l10), set(f + 4, m.l20), set(f + 5, m.l21);
    }
};

/// What joints do in a pass: velocities of the bodies are gathered once and scattered once.
template <int N>
struct WideJoint : JointFields<N> {
    using JointFields<N>::at;
    using JointFields<N>::vector;
    using JointFields<N>::quaternion;
    using JointFields<N>::set;
    NumberedRows<BodyState, N> rowsA, rowsB;
    Lanes<N> a[8], b[8];  ///< velocity rows
    WideVec3<N> vA, wA, vB, wB, massA, massB;
    SymmetricMatrix<N> inertiaA, inertiaB;  ///< inverse
    Lanes<N> shareA, shareB;                ///< of the inverse inertia
    WideVec3<N> armA, armB, gap;
    WideQuat<N> dqA, dqB;
    Lanes<N> poseA[8], poseB[8];  ///< displacements

    RAGTOP_INLINE WideJoint(const JointLanesView& view, int index, const BodyArrays& arrays)
        : JointFields<N>{view.bundles[index], view.fields + view.bundles[index].fields},
          rowsA{arrays.states, view.statesA + index * N},
          rowsB{arrays.states, view.statesB + index * N} {
        gather8<N>(rowsA.anew(), a);
        gather8<N>(rowsB.anew(), b);
        vA = {a[0], a[1], a[2]}, wA = {a[4], a[5], a[6]};
        vB = {b[0], b[1], b[2]}, wB = {b[4], b[5], b[6]};
        massA = massB = nothing<N>();
        massA = {a[3], a[3], a[3]}, massB = {b[3], b[3], b[3]};
        applyLocks(massA, a[7]);
        applyLocks(massB, b[7]);
        inertiaA = gatherInertia({arrays.inertia, rowsA.numbers}, a[3], shareA);
        inertiaB = gatherInertia({arrays.inertia, rowsB.numbers}, b[3], shareB);
    }
    static RAGTOP_INLINE SymmetricMatrix<N> gatherInertia(const NumberedRows<BodyInertia, N>& rows,
                                                          Lanes<N> inverseMass, Lanes<N>& share) {
        Lanes<N> m[8];
        gather8<N>(rows.anew(), m);
        const Mask<N> moves = inverseMass > 0.0f;
        for (int i = 0; i < 6; ++i) m[i] = select(moves, m[i], Lanes<N>(0.0f));
        share = select(m[7] > 0.0f, 1.0f / (1.0f + m[7]), Lanes<N>(1.0f));
        return {m[0], m[1], m[2], m[3], m[4], m[5]};
    }

    static RAGTOP_INLINE NumberedRows<BodyState, N> posesOf(NumberedRows<BodyState, N> rows) {
        rows.offset = 8;
        return rows.anew();
    }
    /// Where the bodies are now, and the shared point half way between the anchors.
    RAGTOP_INLINE void locate() {
        gather8<N>(posesOf(rowsA), poseA);
        gather8<N>(posesOf(rowsB), poseB);
        dqA = {poseA[4], poseA[5], poseA[6], poseA[7]}, dqB = {poseB[4], poseB[5], poseB[6], poseB[7]};
        const WideVec3<N> anchorA = rotate(dqA, vector(RAGTOP_JOINT_FIELD(anchorA)));
        const WideVec3<N> anchorB = rotate(dqB, vector(RAGTOP_JOINT_FIELD(anchorB)));
        const WideVec3<N> dpA{poseA[0], poseA[1], poseA[2]}, dpB{poseB[0], poseB[1], poseB[2]};
        gap = vector(RAGTOP_JOINT_FIELD(centerOffset)) + (dpB - dpA) + (anchorB - anchorA);
        const Lanes<N> half(0.5f);
        armA = anchorA + half * gap, armB = anchorB - half * gap;
    }
    RAGTOP_INLINE WideQuat<N> frameA() const { return dqA * quaternion(RAGTOP_JOINT_FIELD(frameA)); }
    RAGTOP_INLINE WideQuat<N> frameB() const { return dqB * quaternion(RAGTOP_JOINT_FIELD(frameB)); }
    RAGTOP_INLINE void storeArms() { set(RAGTOP_JOINT_FIELD(arms.a), armA), set(RAGTOP_JOINT_FIELD(arms.b), armB); }
    RAGTOP_INLINE void loadArms() {
        armA = vector(RAGTOP_JOINT_FIELD(arms.a)), armB = vector(RAGTOP_JOINT_FIELD(arms.b));
    }

    /// As BodyPair::recordPull.
    RAGTOP_INLINE void recordPull(const WideVec3<N>& impulse, float h) const {
        addPull(rowsA, a[3], Lanes<N>(-h) * dot(armA, impulse) * easeAcross(inertiaA, armA));
        addPull(rowsB, b[3], Lanes<N>(h) * dot(armB, impulse) * easeAcross(inertiaB, armB));
    }
    static RAGTOP_INLINE void addPull(const NumberedRows<BodyState, N>& rows, Lanes<N> inverseMass, Lanes<N> ratio) {
        constexpr int kPull = offsetof(BodyState, pull) / sizeof(float);
        const Mask<N> pulled = (inverseMass > 0.0f) & (ratio > 0.0f);
        if (!any(pulled)) return;
        for (int i = 0; i < N; ++i)
            if (pulled.v[i] != 0) rows[i][kPull] += ratio.v[i];
    }
    RAGTOP_INLINE Lanes<N> easeAcross(const SymmetricMatrix<N>& inertia, const WideVec3<N>& arm) const {
        const Lanes<N> largest = max(inertia.zz, max(inertia.xx, inertia.yy));
        const Lanes<N> square = dot(arm, arm), along = dot(arm, inertia * arm);
        return min(inertia.xx + inertia.yy + inertia.zz - divideOrZero(along, square), largest);
    }

    RAGTOP_INLINE WideVec3<N> linearVelocity() const { return (vB + cross(wB, armB)) - (vA + cross(wA, armA)); }
    RAGTOP_INLINE WideVec3<N> angularVelocity() const { return wB - wA; }
    /// As BodyPair::turns, turnsTogether and turnsAbout.
    RAGTOP_INLINE WideTurning<N> turns() const { return {wA, wB}; }
    RAGTOP_INLINE WideTurning<N> turnsTogether() const {
        const Lanes<N> easeA = shareA * (inertiaA.xx + inertiaA.yy + inertiaA.zz);
        const Lanes<N> easeB = shareB * (inertiaB.xx + inertiaB.yy + inertiaB.zz);
        const WideVec3<N> w = wA + divideOrZero(easeA, easeA + easeB) * (wB - wA);
        return {w, w};
    }
    RAGTOP_INLINE WideTurning<N> turnsAbout(const WideVec3<N>& x) const {
        const WideVec3<N> w = turnsTogether().a;
        return {w + dot(x, wA - w) * x, w + dot(x, wB - w) * x};
    }
    RAGTOP_INLINE WideVec3<N> curvingArms(const WideTurning<N>& w, float h) const {
        return curving(w.b, armB, h) - curving(w.a, armA, h);
    }
    /// As BodyPair::receding.
    RAGTOP_INLINE Lanes<N> receding(Lanes<N> speed, float substep) const {
        const Lanes<N> half(0.5f), h(substep);
        const WideVec3<N> anchorA = armA - half * gap, anchorB = armB + half * gap;
        const WideVec3<N> bends = curving(wB, anchorB, substep) - curving(wA, anchorA, substep);
        const WideVec3<N> u = ((vB + cross(wB, anchorB)) - (vA + cross(wA, anchorA))) + bends, ahead = gap + h * u;
        const Lanes<N> now = length(gap), later = length(ahead), zero(0.0f);
        const Lanes<N> mean = divideOrZero(2.0f * dot(gap, u) + h * dot(u, u), now + later);
        const Lanes<N> cosine = max(divideOrZero(dot(gap, ahead), now * later), zero);
        return (cosine * cosine) * (cosine * cosine) * (mean - speed);
    }
    RAGTOP_INLINE void apply(const WideVec3<N>& linear, const WideVec3<N>& angular) {
        vA = vA - times(massA, linear);
        wA = wA - shareA * (inertiaA * (cross(armA, linear) + angular));
        vB = vB + times(massB, linear);
        wB = wB + shareB * (inertiaB * (cross(armB, linear) + angular));
    }
    /// What `angularVelocity` would be after that.
    RAGTOP_INLINE WideVec3<N> angularVelocityAfter(const WideVec3<N>& linear, const WideVec3<N>& angular) const {
        const WideVec3<N> turnedA = wA - shareA * (inertiaA * (cross(armA, linear) + angular));
        const WideVec3<N> turnedB = wB + shareB * (inertiaB * (cross(armB, linear) + angular));
        return turnedB - turnedA;
    }
    /// In some lanes.
    RAGTOP_INLINE void applyWhere(Mask<N> lanes, const WideVec3<N>& linear, const WideVec3<N>& angular) {
        const WideVec3<N> oldVA = vA, oldWA = wA, oldVB = vB, oldWB = wB;
        apply(linear, angular);
        vA = select(lanes, vA, oldVA), wA = select(lanes, wA, oldWA);
        vB = select(lanes, vB, oldVB), wB = select(lanes, wB, oldWB);
    }
    RAGTOP_INLINE WideMass<N> mass() const {
        const WideVec3<N> m = massA + massB;
        const SymmetricMatrix<N> iA = shareA * inertiaA, iB = shareB * inertiaB;
        const WideMat3<N> tA = turning(iA, armA), tB = turning(iB, armB);
        const SymmetricMatrix<N> kA = outerCross(tA, armA), kB = outerCross(tB, armB);
        return {{m.x + kA.xx + kB.xx, kA.xy + kB.xy, kA.xz + kB.xz, m.y + kA.yy + kB.yy, kA.yz + kB.yz,
                 m.z + kA.zz + kB.zz},
                iA + iB,
                {tA.cx + tB.cx, tA.cy + tB.cy, tA.cz + tB.cz}};
    }
    RAGTOP_INLINE Lanes<N> mass(const WideVec3<N>& direction) const {
        const WideVec3<N> ra = cross(armA, direction), rb = cross(armB, direction);
        return dot(direction, times(massA + massB, direction)) + shareA * dot(ra, inertiaA * ra) +
               shareB * dot(rb, inertiaB * rb);
    }

    /// As BodyPair::move, in some lanes; once, where locate has found the bodies.
    RAGTOP_INLINE void moveWhere(Mask<N> lanes, const WideVec3<N>& linear, const WideVec3<N>& angular) {
        displace(lanes, posesOf(rowsA), a[3], poseA, -times(massA, linear),
                 -(shareA * (inertiaA * (cross(armA, linear) + angular))));
        displace(lanes, posesOf(rowsB), b[3], poseB, times(massB, linear),
                 shareB * (inertiaB * (cross(armB, linear) + angular)));
    }
    static RAGTOP_INLINE void displace(Mask<N> lanes, const NumberedRows<BodyState, N>& rows, Lanes<N> inverseMass,
                                       Lanes<N> (&pose)[8], const WideVec3<N>& way, const WideVec3<N>& turn) {
        const Lanes<N> half(0.5f);
        const WideQuat<N> q = normalized(WideQuat<N>{half * turn.x, half * turn.y, half * turn.z, Lanes<N>(1.0f)} *
                                         WideQuat<N>{pose[4], pose[5], pose[6], pose[7]});
        pose[0] = pose[0] + way.x, pose[1] = pose[1] + way.y, pose[2] = pose[2] + way.z;
        pose[4] = q.x, pose[5] = q.y, pose[6] = q.z, pose[7] = q.w;
        const Mask<N> moves = lanes & (inverseMass > 0.0f);
        float* out[N];
        for (int i = 0; i < N; ++i) out[i] = moves.v[i] != 0 ? rows[i] : nullptr;
        scatter8<N>(out, pose);
    }

    RAGTOP_INLINE void writeVelocities() {
        a[0] = vA.x, a[1] = vA.y, a[2] = vA.z, a[4] = wA.x, a[5] = wA.y, a[6] = wA.z;
        b[0] = vB.x, b[1] = vB.y, b[2] = vB.z, b[4] = wB.x, b[5] = wB.y, b[6] = wB.z;
        scatterMoving<N>(rowsA.anew(), a, a[3]);
        scatterMoving<N>(rowsB.anew(), b, b[3]);
    }
};

}  // namespace
}  // namespace ragtop
