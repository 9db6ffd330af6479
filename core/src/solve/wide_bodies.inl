// Integration of bodies, N at a time. Included by wide_kernels.inl.

namespace ragtop {
namespace {

template <int N>
struct SymmetricMatrix {
    Lanes<N> xx, xy, xz, yy, yz, zz;
};
template <int N>
RAGTOP_INLINE WideVec3<N> operator*(const SymmetricMatrix<N>& m, const WideVec3<N>& a) {
    return {m.xx * a.x + m.xy * a.y + m.xz * a.z, m.xy * a.x + m.yy * a.y + m.yz * a.z,
            m.xz * a.x + m.yz * a.y + m.zz * a.z};
}

/// Rows of N bodies; places beyond the end repeat the static body and are not written.
template <int N>
struct BodyRows {
    std::uint32_t index[N];
    int count;

    RAGTOP_INLINE BodyRows(const std::uint32_t* bodies, int begin, int end) {
        count = end - begin < N ? end - begin : N;
        for (int i = 0; i < N; ++i) index[i] = i < count ? bodies[begin + i] : 0;
    }
    template <class T>
    RAGTOP_INLINE void gather(const T* rows, int offset, Lanes<N> out[8]) const {
        const float* p[N];
        for (int i = 0; i < N; ++i) p[i] = reinterpret_cast<const float*>(rows + index[i]) + offset;
        gather8<N>(p, out);
    }
    template <class T>
    RAGTOP_INLINE void scatter(T* rows, int offset, const Lanes<N> in[8]) const {
        float* p[N];
        for (int i = 0; i < N; ++i) p[i] = i < count ? reinterpret_cast<float*>(rows + index[i]) + offset : nullptr;
        scatter8<N>(p, in);
    }
};

/// Zeroes what a body's translation locks forbid.
template <int N>
RAGTOP_INLINE void applyLocks(WideVec3<N>& v, Lanes<N> locks) {
    typedef typename Mask<N>::V Int;
    const Int locked = bits(locks);
    if (!any(Mask<N>{locked != 0})) return;
    v.x = select(Mask<N>{(locked & 1) != 0}, Lanes<N>(0.0f), v.x);
    v.y = select(Mask<N>{(locked & 2) != 0}, Lanes<N>(0.0f), v.y);
    v.z = select(Mask<N>{(locked & 4) != 0}, Lanes<N>(0.0f), v.z);
}

/// v ← (v + h a) / (1 + h d),  ω ← (ω + h I⁻¹ τ) / (1 + h d)
template <int N>
void integrateVelocities(const BodyArrays& arrays, const std::uint32_t* bodies, int begin, int end,
                         const SolverContext& context) {
    const float h = context.h;
    for (int i = begin; i < end; i += N) {
        const BodyRows<N> rows(bodies, i, end);
        Lanes<N> state[8], rates[8], forces[8], memory[8], inertia[8];
        rows.gather(arrays.states, 0, state);
        rows.gather(arrays.dynamics, 0, rates);
        rows.gather(arrays.dynamics, 8, forces);
        rows.gather(arrays.history, 0, memory);
        rows.gather(arrays.inertia, 0, inertia);

        WideVec3<N> v{state[0], state[1], state[2]};
        WideVec3<N> w{state[4], state[5], state[6]};
        const WideVec3<N> before{memory[0], memory[1], memory[2]};
        const WideVec3<N> change = v - before;
        memory[0] = v.x, memory[1] = v.y, memory[2] = v.z;
        memory[4] = change.x, memory[5] = change.y, memory[6] = change.z;

        const WideVec3<N> a{forces[0], forces[1], forces[2]};
        const WideVec3<N> torque{forces[4], forces[5], forces[6]};
        const SymmetricMatrix<N> inverse{inertia[0], inertia[1], inertia[2], inertia[3], inertia[4], inertia[5]};
        v = rates[3] * (v + Lanes<N>(h) * a);
        w = rates[7] * (w + Lanes<N>(h) * (inverse * torque));
        applyLocks(v, state[7]);

        state[0] = v.x, state[1] = v.y, state[2] = v.z;
        state[4] = w.x, state[5] = w.y, state[6] = w.z;
        rows.scatter(arrays.states, 0, state);
        rows.scatter(arrays.history, 0, memory);
    }
}

template <int N>
RAGTOP_INLINE WideQuat<N> normalized(const WideQuat<N>& q) {
    const Lanes<N> norm = 1.0f / sqrt(q.x * q.x + q.y * q.y + q.z * q.z + q.w * q.w);
    return {q.x * norm, q.y * norm, q.z * norm, q.w * norm};
}

/// `a` with the length of `b`, which it has but for rounding. Squares are of shares of b, so that none underflows.
template <int N>
RAGTOP_INLINE WideVec3<N> withLengthOf(const WideVec3<N>& b, const WideVec3<N>& a) {
    const Lanes<N> largest = max(max(max(b.x, -b.x), max(b.y, -b.y)), max(b.z, -b.z));
    const Lanes<N> unit = divideOrZero(Lanes<N>(1.0f), largest);
    const WideVec3<N> to = unit * b, from = unit * a;
    return sqrt(divideOrZero(dot(to, to), dot(from, from))) * a;
}

/// One factor of the splitting: the body turns by a = t pᵢ/Iᵢ about its axis i, so its momentum p, seen from the body,
/// turns back, and q ← q · (axis i, a). Series in a/2, which the caller keeps small.
template <int N>
RAGTOP_INLINE void turnAboutAxis(Lanes<N> t, Lanes<N> pi, Lanes<N> inverseInertia, Lanes<N>& pj, Lanes<N>& pk,
                                 Lanes<N>& qi, Lanes<N>& qj, Lanes<N>& qk, Lanes<N>& qw) {
    const Lanes<N> x = 0.5f * (t * pi * inverseInertia);
    const Lanes<N> x2 = x * x;
    const Lanes<N> s = x * (1.0f - (1.0f / 6) * x2 * (1.0f - (1.0f / 20) * x2 * (1.0f - (1.0f / 42) * x2)));
    const Lanes<N> c =
        1.0f - 0.5f * x2 * (1.0f - (1.0f / 12) * x2 * (1.0f - (1.0f / 30) * x2 * (1.0f - (1.0f / 56) * x2)));
    const Lanes<N> sine = 2.0f * (s * c), cosine = 1.0f - 2.0f * (s * s);

    const Lanes<N> j = pj, k = pk;
    pj = cosine * j + sine * k;
    pk = cosine * k - sine * j;

    // q · (s eᵢ + c):  (i, j, k) is an even permutation of (x, y, z)
    const Lanes<N> i0 = qi, j0 = qj, k0 = qk, w0 = qw;
    qi = c * i0 + s * w0;
    qj = c * j0 + s * k0;
    qk = c * k0 - s * j0;
    qw = c * w0 - s * i0;
}

/// Free rotation over h: symmetric splitting into five single-axis rotations of the momentum, exact in L and nearly so
/// in energy [Dullweber, Leimkuhler, McLachlan 1997]; rotor substeps keep |ω| h below 0.15.
template <int N>
RAGTOP_INLINE void rotateFreely(WideQuat<N>& q, WideVec3<N> p, const WideVec3<N>& inverseInertia, Lanes<N> speed, float h) {
    typedef typename Mask<N>::V Int;
    const Lanes<N> wanted = min(speed * Lanes<N>(h * (1.0f / 0.15f)), Lanes<N>(63.0f));
    const Int count = __builtin_convertvector(wanted.v, Int) + 1;
    const Lanes<N> step = Lanes<N>(h) / Lanes<N>(__builtin_convertvector(count, typename Lanes<N>::V));
    const Lanes<N> half = 0.5f * step;
    for (int i = 0; any(Mask<N>{count > i}); ++i) {
        WideVec3<N> m = p;
        WideQuat<N> r = q;
        turnAboutAxis(half, m.x, inverseInertia.x, m.y, m.z, r.x, r.y, r.z, r.w);
        turnAboutAxis(half, m.y, inverseInertia.y, m.z, m.x, r.y, r.z, r.x, r.w);
        turnAboutAxis(step, m.z, inverseInertia.z, m.x, m.y, r.z, r.x, r.y, r.w);
        turnAboutAxis(half, m.y, inverseInertia.y, m.z, m.x, r.y, r.z, r.x, r.w);
        turnAboutAxis(half, m.x, inverseInertia.x, m.y, m.z, r.x, r.y, r.z, r.w);
        const Mask<N> active{count > i};
        p = select(active, m, p);
        q = {select(active, r.x, q.x), select(active, r.y, q.y), select(active, r.z, q.z), select(active, r.w, q.w)};
    }
    q = normalized(q);
}

/// R diag(d) Rᵀ
template <int N>
RAGTOP_INLINE SymmetricMatrix<N> rotated(const WideQuat<N>& q, const WideVec3<N>& d) {
    const Lanes<N> one(1.0f), zero(0.0f);
    const WideVec3<N> a = rotate(q, {one, zero, zero});
    const WideVec3<N> b = rotate(q, {zero, one, zero});
    const WideVec3<N> c = rotate(q, {zero, zero, one});
    return {d.x * a.x * a.x + d.y * b.x * b.x + d.z * c.x * c.x, d.x * a.x * a.y + d.y * b.x * b.y + d.z * c.x * c.y,
            d.x * a.x * a.z + d.y * b.x * b.z + d.z * c.x * c.z, d.x * a.y * a.y + d.y * b.y * b.y + d.z * c.y * c.y,
            d.x * a.y * a.z + d.y * b.y * b.z + d.z * c.y * c.z, d.x * a.z * a.z + d.y * b.z * b.z + d.z * c.z * c.z};
}

/// x ← x + h v − ½ h² a, with a the part of this substep's acceleration that the substep before had too: free fall and
/// steady sliding are then exact parabolas, while impacts and resting contacts, whose accelerations reverse or vanish,
/// see no correction (docs/adr/0004-position-map.md).
template <int N>
void integratePositions(const BodyArrays& arrays, const std::uint32_t* bodies, int begin, int end,
                        const SolverContext& context) {
    const float h = context.h;
    for (int i = begin; i < end; i += N) {
        const BodyRows<N> rows(bodies, i, end);
        Lanes<N> state[8], pose[8], rates[8], forces[8], memory[8], start[8], inertia[8];
        rows.gather(arrays.states, 0, state);
        rows.gather(arrays.states, 8, pose);
        rows.gather(arrays.dynamics, 0, rates);
        rows.gather(arrays.dynamics, 8, forces);
        rows.gather(arrays.history, 0, memory);
        rows.gather(arrays.history, 8, start);
        rows.gather(arrays.inertia, 0, inertia);

        const WideVec3<N> v{state[0], state[1], state[2]};
        const WideVec3<N> w{state[4], state[5], state[6]};
        const WideVec3<N> now = v - WideVec3<N>{memory[0], memory[1], memory[2]};
        const WideVec3<N> last{memory[4], memory[5], memory[6]};
        const Lanes<N> share = min(max(divideOrZero(dot(last, now), dot(now, now)), Lanes<N>(0.0f)), Lanes<N>(1.0f));
        WideVec3<N> smooth = (0.5f * share * forces[7]) * now;
        const WideVec3<N> dp = WideVec3<N>{pose[0], pose[1], pose[2]} + Lanes<N>(h) * (v - smooth);

        const WideQuat<N> q0{start[0], start[1], start[2], start[3]};
        WideQuat<N> q = normalized(WideQuat<N>{pose[4], pose[5], pose[6], pose[7]} * q0);
        const WideVec3<N> moments{rates[0], rates[1], rates[2]}, inverse{rates[4], rates[5], rates[6]};
        const WideVec3<N> wBody = withLengthOf(w, inverseRotate(q, w));
        const WideVec3<N> momentum{moments.x * wBody.x, moments.y * wBody.y, moments.z * wBody.z};
        const WideVec3<N> momentumWorld = rotate(q, momentum);
        rotateFreely(q, momentum, inverse, sqrt(dot(w, w)), h);

        const WideVec3<N> after = withLengthOf(momentum, inverseRotate(q, momentumWorld));
        const Mask<N> spins = forces[3] > 0.0f;
        const WideVec3<N> wNew =
            select(spins, rotate(q, WideVec3<N>{after.x / moments.x, after.y / moments.y, after.z / moments.z}), w);
        const WideQuat<N> dq = q * WideQuat<N>{-q0.x, -q0.y, -q0.z, q0.w};
        const SymmetricMatrix<N> inverseWorld = rotated(q, inverse);

        state[4] = wNew.x, state[5] = wNew.y, state[6] = wNew.z;
        pose[0] = dp.x, pose[1] = dp.y, pose[2] = dp.z;
        pose[4] = dq.x, pose[5] = dq.y, pose[6] = dq.z, pose[7] = dq.w;
        inertia[0] = select(spins, inverseWorld.xx, inertia[0]);
        inertia[1] = select(spins, inverseWorld.xy, inertia[1]);
        inertia[2] = select(spins, inverseWorld.xz, inertia[2]);
        inertia[3] = select(spins, inverseWorld.yy, inertia[3]);
        inertia[4] = select(spins, inverseWorld.yz, inertia[4]);
        inertia[5] = select(spins, inverseWorld.zz, inertia[5]);
        rows.scatter(arrays.states, 0, state);
        rows.scatter(arrays.states, 8, pose);
        rows.scatter(arrays.inertia, 0, inertia);
    }
}

}  // namespace
}  // namespace ragtop
