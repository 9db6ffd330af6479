// A bundle of joints in lanes and the bodies they join.
// Included by wide_joints.inl.

namespace ragtop {
namespace {

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
};

/// What joints do in a pass: velocities of the bodies are gathered once and scattered once.
template <int N>
struct WideJoint : JointFields<N>, PairMotion<Lanes<N>> {
    using JointFields<N>::at;
    using JointFields<N>::vector;
    using JointFields<N>::quaternion;
    using JointFields<N>::set;
    using Motion = PairMotion<Lanes<N>>;
    using Motion::vA, Motion::wA, Motion::vB, Motion::wB, Motion::inverseMassA, Motion::inverseMassB;
    using Motion::inertiaA, Motion::inertiaB, Motion::shareA, Motion::shareB;
    NumberedRows<BodyState, N> rowsA, rowsB;
    Lanes<N> a[8], b[8];  ///< velocity rows
    ArmsOf<Lanes<N>> arms;
    WideVec3<N> gap;
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
        inverseMassA = {a[3], a[3], a[3]}, inverseMassB = {b[3], b[3], b[3]};
        applyLocks(inverseMassA, a[7]);
        applyLocks(inverseMassB, b[7]);
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
        arms = {anchorA + half * gap, anchorB - half * gap};
    }
    RAGTOP_INLINE WideQuat<N> frameA() const { return dqA * quaternion(RAGTOP_JOINT_FIELD(frameA)); }
    RAGTOP_INLINE WideQuat<N> frameB() const { return dqB * quaternion(RAGTOP_JOINT_FIELD(frameB)); }
    RAGTOP_INLINE void storeArms() { set(RAGTOP_JOINT_FIELD(arms.a), arms.a), set(RAGTOP_JOINT_FIELD(arms.b), arms.b); }
    RAGTOP_INLINE void loadArms() {
        arms = {vector(RAGTOP_JOINT_FIELD(arms.a)), vector(RAGTOP_JOINT_FIELD(arms.b))};
    }

    /// As BodyPair::recordPull.
    RAGTOP_INLINE void recordPull(const WideVec3<N>& impulse, float h) const {
        addPull(rowsA, a[3], Lanes<N>(-h) * dot(arms.a, impulse) * easeAcross(inertiaA, arms.a));
        addPull(rowsB, b[3], Lanes<N>(h) * dot(arms.b, impulse) * easeAcross(inertiaB, arms.b));
    }
    static RAGTOP_INLINE void addPull(const NumberedRows<BodyState, N>& rows, Lanes<N> inverseMass, Lanes<N> ratio) {
        constexpr int kPull = offsetof(BodyState, pull) / sizeof(float);
        const Mask<N> pulled = (inverseMass > 0.0f) & (ratio > 0.0f);
        if (!any(pulled)) return;
        for (int i = 0; i < N; ++i)
            if (pulled.v[i] != 0) rows[i][kPull] += ratio.v[i];
    }
    /// In some lanes.
    RAGTOP_INLINE void applyWhere(Mask<N> lanes, const PairVectorOf<Lanes<N>>& impulse) {
        const WideVec3<N> oldVA = vA, oldWA = wA, oldVB = vB, oldWB = wB;
        this->apply(arms, impulse);
        vA = select(lanes, vA, oldVA), wA = select(lanes, wA, oldWA);
        vB = select(lanes, vB, oldVB), wB = select(lanes, wB, oldWB);
    }

    /// As BodyPair::move, in some lanes; once, where locate has found the bodies.
    RAGTOP_INLINE void moveWhere(Mask<N> lanes, const PairVectorOf<Lanes<N>>& impulse) {
        displace(lanes, posesOf(rowsA), a[3], poseA, -scale(inverseMassA, impulse.linear), -this->turnA(arms, impulse));
        displace(lanes, posesOf(rowsB), b[3], poseB, scale(inverseMassB, impulse.linear), this->turnB(arms, impulse));
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
