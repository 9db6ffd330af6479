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

/// sin x / x and cos x as series in x², for angles that the caller keeps small.
template <int N>
RAGTOP_INLINE Lanes<N> sineRatio(Lanes<N> x2) {
    return 1.0f - (1.0f / 6) * x2 * (1.0f - (1.0f / 20) * x2 * (1.0f - (1.0f / 42) * x2));
}
template <int N>
RAGTOP_INLINE Lanes<N> cosine(Lanes<N> x2) {
    return 1.0f - 0.5f * x2 * (1.0f - (1.0f / 12) * x2 * (1.0f - (1.0f / 30) * x2 * (1.0f - (1.0f / 56) * x2)));
}

/// One factor of the splitting: the body turns by a = t αᵢ pᵢ about its axis i, so its momentum p, seen from the body,
/// turns back, and q ← q · (axis i, a).
template <int N>
RAGTOP_INLINE void turnAboutAxis(Lanes<N> t, Lanes<N> pi, Lanes<N> alpha, Lanes<N>& pj, Lanes<N>& pk, Lanes<N>& qi,
                                 Lanes<N>& qj, Lanes<N>& qk, Lanes<N>& qw) {
    const Lanes<N> x = 0.5f * (t * pi * alpha), x2 = x * x;
    const Lanes<N> s = x * sineRatio(x2), c = cosine(x2);
    const Lanes<N> sine = 2.0f * (s * c), versine = 2.0f * (s * s);

    const Lanes<N> j = pj, k = pk;
    pj = j + (sine * k - versine * j);
    pk = k - (sine * j + versine * k);

    // q · (s eᵢ + c):  (i, j, k) is an even permutation of (x, y, z)
    const Lanes<N> i0 = qi, j0 = qj, k0 = qk, w0 = qw;
    qi = c * i0 + s * w0;
    qj = c * j0 + s * k0;
    qk = c * k0 - s * j0;
    qw = c * w0 - s * i0;
}

/// The cyclic exchange of axes that puts the middle moment on y, and back.
template <int N>
struct MiddleAxis {
    Mask<N> isX, isZ;

    RAGTOP_INLINE explicit MiddleAxis(const WideVec3<N>& d) {
        isX = middle(d.x, d.y, d.z);
        isZ = middle(d.z, d.x, d.y);
    }
    static RAGTOP_INLINE Mask<N> middle(Lanes<N> a, Lanes<N> b, Lanes<N> c) {
        return ((b <= a) & (a <= c)) | ((c <= a) & (a <= b));
    }
    RAGTOP_INLINE WideVec3<N> toY(const WideVec3<N>& v) const {
        return select(isX, WideVec3<N>{v.z, v.x, v.y}, select(isZ, WideVec3<N>{v.y, v.z, v.x}, v));
    }
    RAGTOP_INLINE WideVec3<N> back(const WideVec3<N>& v) const {
        return select(isX, WideVec3<N>{v.y, v.z, v.x}, select(isZ, WideVec3<N>{v.z, v.x, v.y}, v));
    }
};

/// Free rotation of a body of momentum `world` over h. The energy Σ pᵢ²/2Iᵢ is split as
///   |p|²/2I₂  +  α₁ p₁²/2  +  α₃ p₃²/2,   αᵢ = 1/Iᵢ − 1/I₂,   I₂ the middle moment.
/// The first part turns the body about its momentum and commutes with the others, so it is exact; those are turns about
/// single axes, taken symmetrically [Dullweber, Leimkuhler, McLachlan 1997]. A symmetric body has one α alone and is
/// exact as a whole. The error in energy goes with h² |L|² α₁ α₃ max(α) I₂: rotor steps of h keep its root below 0.04,
/// and every angle below one.
template <int N>
RAGTOP_INLINE void rotateFreely(WideQuat<N>& q, const WideVec3<N>& world, const WideVec3<N>& inverseInertia,
                                float h) {
    typedef typename Mask<N>::V Int;
    const MiddleAxis<N> axes(inverseInertia);
    const WideVec3<N> inverse = axes.toY(inverseInertia);
    const Lanes<N> alpha1 = inverse.x - inverse.y, alpha3 = inverse.z - inverse.y;
    WideVec3<N> p = axes.toY(inverseRotate(q, world));
    const WideVec3<N> exchanged = axes.toY({q.x, q.y, q.z});
    WideQuat<N> u{exchanged.x, exchanged.y, exchanged.z, q.w};

    const Lanes<N> size1 = max(alpha1, -alpha1), size3 = max(alpha3, -alpha3), largest = max(size1, size3);
    constexpr float kError = 1.0f / 0.04f, kMaxSteps = 511;
    const Lanes<N> accuracy = (kError * kError) * divideOrZero(size1 * size3 * largest, inverse.y);
    const Lanes<N> angle = max(largest, inverse.y);
    const Lanes<N> wanted = min(h * sqrt(dot(world, world) * max(accuracy, angle * angle)), Lanes<N>(kMaxSteps));
    const Int count = __builtin_convertvector(wanted.v, Int) + 1;
    const Lanes<N> step = Lanes<N>(h) / Lanes<N>(__builtin_convertvector(count, typename Lanes<N>::V));
    const Lanes<N> half = 0.5f * step;
    const WideVec3<N> halfTurn = (half * inverse.y) * axes.toY(world);
    const Lanes<N> squared = dot(halfTurn, halfTurn), ratio = sineRatio(squared);
    const WideQuat<N> turn{ratio * halfTurn.x, ratio * halfTurn.y, ratio * halfTurn.z, cosine(squared)};
    for (int i = 0; any(Mask<N>{count > i}); ++i) {
        WideVec3<N> m = p;
        WideQuat<N> r = u;
        turnAboutAxis(half, m.x, alpha1, m.y, m.z, r.x, r.y, r.z, r.w);
        turnAboutAxis(step, m.z, alpha3, m.x, m.y, r.z, r.x, r.y, r.w);
        turnAboutAxis(half, m.x, alpha1, m.y, m.z, r.x, r.y, r.z, r.w);
        r = turn * r;
        const Mask<N> active{count > i};
        p = select(active, m, p);
        u = {select(active, r.x, u.x), select(active, r.y, u.y), select(active, r.z, u.z), select(active, r.w, u.w)};
    }
    const WideVec3<N> axis = axes.back({u.x, u.y, u.z});
    q = normalized(WideQuat<N>{axis.x, axis.y, axis.z, u.w});
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
        const WideVec3<N> turned = inverseRotate(q, w - WideVec3<N>{memory[3], memory[7], start[7]});
        const WideVec3<N> gained = rotate(q, times(moments, turned));
        const WideVec3<N> momentum = WideVec3<N>{start[4], start[5], start[6]} + gained;
        rotateFreely(q, momentum, inverse, h);

        const Mask<N> spins = forces[3] > 0.0f;
        const WideVec3<N> wNew = select(spins, rotate(q, times(inverse, inverseRotate(q, momentum))), w);
        const WideQuat<N> dq = q * WideQuat<N>{-q0.x, -q0.y, -q0.z, q0.w};
        const SymmetricMatrix<N> inverseWorld = rotated(q, inverse);

        state[4] = wNew.x, state[5] = wNew.y, state[6] = wNew.z;
        memory[3] = wNew.x, memory[7] = wNew.y, start[7] = wNew.z;
        start[4] = momentum.x, start[5] = momentum.y, start[6] = momentum.z;
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
        rows.scatter(arrays.history, 0, memory);
        rows.scatter(arrays.history, 8, start);
        rows.scatter(arrays.inertia, 0, inertia);
    }
}

}  // namespace
}  // namespace ragtop
