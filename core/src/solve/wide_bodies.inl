// Integration of bodies, N at a time. Included by wide_kernels.inl.
//
// Velocities (integrateVelocities), with damping d:
//   v ← (v + h a)/(1 + h d),    ω ← (ω + h I⁻¹ τ)/(1 + h d).
// Positions (integratePositions), with the velocity v that the soft pass has found:
//   dp ← dp + h v − ½ h² ā,     ā = s Δv/h,    s = clamp(Δv_last · Δv/|Δv|², 0, 1);
// ā is the part of the acceleration that this substep has in common with the one before. Rotations follow from the
// angular momentum (wide_rotation.inl).
// dp and dq are displacements since the step began; poses are updated once per step. docs/adr/0004 has the reasons.

namespace ragtop {
namespace {

/// Rows of N bodies; places beyond the end repeat the static body and are not written.
template <int N>
struct BodyRows {
    const std::uint32_t* numbers;
    int count;
    std::uint32_t last[N];  ///< the numbers where there are fewer than N

    RAGTOP_INLINE BodyRows(const std::uint32_t* bodies, int begin, int end)
        : numbers(bodies + begin), count(end - begin) {
        if (count >= N) return;
        for (int i = 0; i < N; ++i) last[i] = i < count ? numbers[i] : 0;
        numbers = last;
    }
    template <class T>
    RAGTOP_INLINE void gather(const T* rows, int offset, Lanes<N> out[8]) const {
        gather8<N>(NumberedRows<const T, N>{rows, numbers, 0, offset}.anew(), out);
    }
    template <class T>
    RAGTOP_INLINE void scatter(T* rows, int offset, const Lanes<N> in[8]) const {
        const auto places = NumberedRows<T, N>{rows, numbers, 0, offset}.anew();
        if (count >= N) return scatterAll8<N>(places, in);
        float* p[N];
        for (int i = 0; i < N; ++i) p[i] = i < count ? places[i] : nullptr;
        scatter8<N>(p, in);
    }
};

constexpr int kFewBodies = 4;  ///< lanes of what is left of a list: half of the rows that wider ones gather are no body's

/// The angular velocities that joints and contacts are told, in place of those of now. The axis of a fast spin circles
/// within a substep: they are told how far it will have come, not how fast it goes now; else they and free rotation take
/// turns to push a top over where L h/I⊥ > 0.7. Joints on slower bodies are told the angular velocity of half a substep
/// ahead. What touches nothing, and was acted on by nothing, has nobody to tell.
template <int N>
RAGTOP_INLINE void leadSpins(const BodyRows<N>& rows, const BodyArrays& arrays, const Lanes<N> rates[8],
                             const Lanes<N> forces[8], const SymmetricMatrix<N>& inverse, float h, WideVec3<N>& w,
                             Lanes<N> memory[8], Lanes<N> inertia[8]) {
    const Mask<N> jointed = (!(forces[7] > 0.0f)) & (forces[3] > 0.0f), mayLead = jointed | mayBeFast(rates, w, h);
    if (!any(mayLead)) return;
    Lanes<N> pose[8], start[8];
    rows.gather(arrays.history, 8, start);
    const Mask<N> tells = !((forces[3] > BodyDynamics::kSpins) & isZero(w - WideVec3<N>{memory[3], memory[7], start[7]}));
    if (!any(mayLead & tells)) return;
    rows.gather(arrays.states, 8, pose);
    FreeSpin<N> spin(
        WideQuat<N>{pose[4], pose[5], pose[6], pose[7]} * WideQuat<N>{start[0], start[1], start[2], start[3]}, rates, w,
        memory, start);
    const Mask<N> fast = spin.isFast(forces[3], h) & tells, leads = jointed | fast;
    // What acted since the momentum was stored counts in it from here on: the later look finds nothing new.
    const Mask<N> acted = jointed & !spin.free;
    Lanes<N> excess = inertia[6];
    if (any(acted)) excess = select(acted, spin.excess(), excess);
    w = select(jointed, spin.ahead(w, inverse, h), w);
    if (any(fast)) w = select(fast, spin.leading(w, h, jointed, excess), w);
    memory[3] = select(leads, w.x, memory[3]), memory[7] = select(leads, w.y, memory[7]);
    start[7] = select(leads, w.z, start[7]);
    start[4] = select(leads, spin.momentum.x, start[4]), start[5] = select(leads, spin.momentum.y, start[5]);
    start[6] = select(leads, spin.momentum.z, start[6]);
    inertia[6] = select(leads, excess, inertia[6]);
    rows.scatter(arrays.history, 8, start);
    rows.scatter(arrays.inertia, 0, inertia);
}

/// v ← (v + h a) / (1 + h d),  ω ← (ω + h I⁻¹ τ) / (1 + h d); of what has no mass the torque is I⁻¹ τ.
template <int N>
void integrateVelocities(const BodyArrays& arrays, const std::uint32_t* bodies, int begin, int end,
                         const SolverContext& context) {
    const float h = context.h;
    for (int i = begin; i < end; i += N) {
        if constexpr (N > kFewBodies)
            if (end - i <= kFewBodies) return integrateVelocities<kFewBodies>(arrays, bodies, i, end, context);
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
        const Mask<N> massive = state[3] > 0.0f;
        w = rates[7] * (w + Lanes<N>(h) * select(massive, inverse * torque, torque));
        applyLocks(v, state[7]);

        leadSpins(rows, arrays, rates, forces, inverse, h, w, memory, inertia);

        state[0] = v.x, state[1] = v.y, state[2] = v.z;
        state[4] = w.x, state[5] = w.y, state[6] = w.z;
        rows.scatter(arrays.states, 0, state);
        rows.scatter(arrays.history, 0, memory);
    }
}

/// R diag(d) Rᵀ, from the columns of R: R e = e + 2 (w u × e + u × (u × e)).
template <int N>
RAGTOP_INLINE SymmetricMatrix<N> rotated(const WideQuat<N>& q, const WideVec3<N>& d) {
    const Lanes<N> one(1.0f);
    const WideVec3<N> t{q.x + q.x, q.y + q.y, q.z + q.z};
    const Lanes<N> xx = q.x * t.x, yy = q.y * t.y, zz = q.z * t.z, xy = q.x * t.y, xz = q.x * t.z, yz = q.y * t.z;
    const Lanes<N> wx = q.w * t.x, wy = q.w * t.y, wz = q.w * t.z;
    const WideVec3<N> a{one - (yy + zz), wz + xy, xz - wy};
    const WideVec3<N> b{xy - wz, one - (zz + xx), wx + yz};
    const WideVec3<N> c{wy + xz, yz - wx, one - (xx + yy)};
    return {d.x * a.x * a.x + d.y * b.x * b.x + d.z * c.x * c.x, d.x * a.x * a.y + d.y * b.x * b.y + d.z * c.x * c.y,
            d.x * a.x * a.z + d.y * b.x * b.z + d.z * c.x * c.z, d.x * a.y * a.y + d.y * b.y * b.y + d.z * c.y * c.y,
            d.x * a.y * a.z + d.y * b.y * b.z + d.z * c.y * c.z, d.x * a.z * a.z + d.y * b.z * b.z + d.z * c.z * c.z};
}

/// x ← x + h v − ½ h² a, with a the part of this substep's acceleration that the substep before had too: free fall and
/// steady sliding are then exact parabolas, while impacts and resting contacts, whose accelerations reverse or vanish,
/// see no correction (docs/adr/0004). Long: all of a body stays in registers.
template <int N>
void integratePositions(const BodyArrays& arrays, const std::uint32_t* bodies, int begin, int end,
                        const SolverContext& context) {
    const float h = context.h;
    const Lanes<N> zero(0.0f);
    for (int i = begin; i < end; i += N) {
        if constexpr (N > kFewBodies)
            if (end - i <= kFewBodies) return integratePositions<kFewBodies>(arrays, bodies, i, end, context);
        const BodyRows<N> rows(bodies, i, end);
        Lanes<N> state[8], pose[8], rates[8], forces[8], memory[8], start[8], inertia[8];
        rows.gather(arrays.states, 0, state);
        rows.gather(arrays.dynamics, 8, forces);
        rows.gather(arrays.history, 0, memory);
        rows.gather(arrays.history, 8, start);

        const WideVec3<N> v{state[0], state[1], state[2]};
        const WideVec3<N> w{state[4], state[5], state[6]};
        // What stood still and stands still has no momentum, and keeps its place to the bit.
        const WideVec3<N> before{memory[0], memory[1], memory[2]}, told{memory[3], memory[7], start[7]};
        const WideVec3<N> stored{start[4], start[5], start[6]};
        const Mask<N> spins = forces[3] > 0.0f, alone = spins & (forces[7] > 0.0f);
        const Mask<N> still = alone & isZero(v) & isZero(before) & isZero(w);
        const Mask<N> settled = still & isZero(told) & isZero(stored);
        if (!any(!settled)) continue;
        rows.gather(arrays.states, 8, pose);
        rows.gather(arrays.dynamics, 0, rates);
        rows.gather(arrays.inertia, 0, inertia);

        const WideVec3<N> now = v - before;
        const WideVec3<N> last{memory[4], memory[5], memory[6]};
        const Lanes<N> share = min(max(divideOrZero(dot(last, now), dot(now, now)), Lanes<N>(0.0f)), Lanes<N>(1.0f));
        WideVec3<N> smooth = (0.5f * share * forces[7]) * now;
        const WideVec3<N> dp = WideVec3<N>{pose[0], pose[1], pose[2]} + Lanes<N>(h) * (v - smooth);

        const WideQuat<N> q0{start[0], start[1], start[2], start[3]};
        const FreeSpin<N> spin(WideQuat<N>{pose[4], pose[5], pose[6], pose[7]} * q0, rates, w, memory, start);
        const WideVec3<N>& inverse = spin.inverse;
        const WideVec3<N> momentum = select(still, WideVec3<N>{zero, zero, zero}, spin.momentum);
        const Mask<N> little = still | (alone & spin.turnsLittle(w, h));
        const SymmetricMatrix<N> inverseBefore{inertia[0], inertia[1], inertia[2], inertia[3], inertia[4], inertia[5]};
        WideQuat<N> q = turnedLittle(spin.q, w, momentum, inverseBefore, h);
        inertia[6] = select(little & !still, spin.excess(), inertia[6]);
        if (any(!little)) {
            WideQuat<N> split = spin.q;
            Lanes<N> excess = inertia[6];
            rotateFreely(split, momentum, inverse, h, spin.free, excess);
            q = select(little, q, split);
            inertia[6] = select(little, inertia[6], excess);
        }

        const Mask<N> turns = spins & !still;
        const WideVec3<N> wNew = select(turns, rotate(q, scale(inverse, inverseRotate(q, momentum))), w);
        const WideVec3<N> toldNew = select(settled, told, wNew), storedNew = select(settled, stored, momentum);
        const WideVec3<N> place = select(still, WideVec3<N>{pose[0], pose[1], pose[2]}, dp);
        const WideQuat<N> dq = q * WideQuat<N>{-q0.x, -q0.y, -q0.z, q0.w};
        const SymmetricMatrix<N> inverseWorld = rotated(q, inverse);

        state[4] = wNew.x, state[5] = wNew.y, state[6] = wNew.z;
        memory[3] = toldNew.x, memory[7] = toldNew.y, start[7] = toldNew.z;
        start[4] = storedNew.x, start[5] = storedNew.y, start[6] = storedNew.z;
        pose[0] = place.x, pose[1] = place.y, pose[2] = place.z;
        pose[4] = select(still, pose[4], dq.x), pose[5] = select(still, pose[5], dq.y);
        pose[6] = select(still, pose[6], dq.z), pose[7] = select(still, pose[7], dq.w);
        // What holds for one substep alone is an impact, and counts half.
        const Lanes<N> taut = pose[3] - Lanes<N>(TautBody::kExplicit);
        inertia[7] = select(taut < inertia[7], taut, 0.5f * (inertia[7] + taut));
        pose[3] = zero;
        inertia[0] = select(turns, inverseWorld.xx, inertia[0]);
        inertia[1] = select(turns, inverseWorld.xy, inertia[1]);
        inertia[2] = select(turns, inverseWorld.xz, inertia[2]);
        inertia[3] = select(turns, inverseWorld.yy, inertia[3]);
        inertia[4] = select(turns, inverseWorld.yz, inertia[4]);
        inertia[5] = select(turns, inverseWorld.zz, inertia[5]);
        rows.scatter(arrays.states, 0, state);
        rows.scatter(arrays.states, 8, pose);
        rows.scatter(arrays.history, 0, memory);
        rows.scatter(arrays.history, 8, start);
        rows.scatter(arrays.inertia, 0, inertia);
    }
}

}  // namespace
}  // namespace ragtop
