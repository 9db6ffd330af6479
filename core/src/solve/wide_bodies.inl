// Integration of bodies, N at a time. Included by wide_kernels.inl.
//
// Velocities (integrateVelocities), with damping d:
//   v ← (v + h a)/(1 + h d),    ω ← (ω + h I⁻¹ τ)/(1 + h d).
// Positions (integratePositions), with the velocity v that the soft pass has found:
//   dp ← dp + h v − ½ h² ā,     ā = s Δv/h,    s = clamp(Δv_last · Δv/|Δv|², 0, 1);
// ā is the part of the acceleration that this substep has in common with the one before. Rotations follow from the
// angular momentum L, which is stored in world axes and changes by I Δω only. With p = L along the principal axes and
// I₂ the middle moment, the energy of free rotation splits [Dullweber, Leimkuhler, McLachlan, 1997] into
//   Σ pᵢ²/2Iᵢ = |L|²/2I₂ + ½ α₁ p₁² + ½ α₃ p₃²,    αᵢ = 1/Iᵢ − 1/I₂:
// one turn about L, which commutes with the others, and turns about single axes: α₁ for h/2, α₃ for h, α₁ for h/2.
// dp and dq are displacements since the step began; poses are updated once per step. docs/adr/0004 has the reasons.

namespace ragtop {
namespace {

template <int N>
using SymmetricMatrix = SymmetricOf<Lanes<N>>;

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

/// Turns a body of momentum p = Rᵀ L, in axes of which y is the middle one, by the least angle that gives it back the
/// excess  e(p) = α₁ p₁² + α₃ p₃²:  p ← p + λ g,  g = ∇e/2 − (e/|p|²) p,  λ = (e_kept − e) / (2 g·∇e/2).
/// Only near the separatrix, where its sign is at stake; about the outer axes e is stationary and would tell nothing.
template <int N>
RAGTOP_INLINE WideQuat<N> keepingExcess(const WideQuat<N>& u, const WideVec3<N>& world, Lanes<N> alpha1,
                                        Lanes<N> alpha3, Lanes<N> excess, const Mask<N>& free) {
    const WideVec3<N> p = inverseRotate(u, world);
    const Lanes<N> zero(0.0f), squared = dot(p, p);
    const Lanes<N> range = 0.25f * squared * min(max(alpha1, -alpha1), max(alpha3, -alpha3));
    const Mask<N> near = free & (max(excess, -excess) < range);
    const WideVec3<N> slope{alpha1 * p.x, zero, alpha3 * p.z};
    const Lanes<N> now = dot(slope, p), share = divideOrZero(now, squared);
    const WideVec3<N> along = slope - share * p;
    const Lanes<N> lambda = divideOrZero(excess - now, 2.0f * dot(along, slope));
    // R ← R exp θ takes p to p − θ × p, so that θ = −λ p × g / |p|².
    const WideVec3<N> half = (-0.5f * divideOrZero(lambda, squared)) * cross(p, along);
    const WideQuat<N> turned = u * WideQuat<N>{half.x, half.y, half.z, Lanes<N>(1.0f)};
    // Where e is stationary, or belongs to another momentum, the way would be far: rounding asks for 1e-6.
    const Mask<N> little = near & (dot(half, half) < 1e-4f);
    return {select(little, turned.x, u.x), select(little, turned.y, u.y), select(little, turned.z, u.z),
            select(little, turned.w, u.w)};
}

/// Free rotation of a body of momentum `world` over h. The energy Σ pᵢ²/2Iᵢ is split as
///   |p|²/2I₂  +  α₁ p₁²/2  +  α₃ p₃²/2,   αᵢ = 1/Iᵢ − 1/I₂,   I₂ the middle moment.
/// The first part turns the body about its momentum and commutes with the others, so it is exact; those are turns about
/// single axes, taken symmetrically [Dullweber, Leimkuhler, McLachlan 1997]. A symmetric body has one α alone and is
/// exact as a whole. The error in energy goes with h² |L|² α₁ α₃ max(α) I₂: rotor steps of h keep its root below 0.04,
/// and every angle below one. Rounding would still walk a body that flips over and over across its separatrix; its
/// `excess` (see excessOfSpin) is therefore kept where nothing acted, and taken from the momentum elsewhere.
template <int N>
RAGTOP_INLINE void rotateFreely(WideQuat<N>& q, const WideVec3<N>& world, const WideVec3<N>& inverseInertia, float h,
                                const Mask<N>& free, Lanes<N>& excess) {
    typedef typename Mask<N>::V Int;
    const MiddleAxis<N> axes(inverseInertia);
    const WideVec3<N> inverse = axes.toY(inverseInertia);
    const Lanes<N> alpha1 = inverse.x - inverse.y, alpha3 = inverse.z - inverse.y;
    // With equal moments about all axes only the first part is left; the others would change no bit but the sign of a zero.
    const bool uneven = any((alpha1 != 0.0f) | (alpha3 != 0.0f));
    const Lanes<N> zero(0.0f);
    WideVec3<N> p = axes.toY(inverseRotate(q, world));
    const WideVec3<N> exchanged = axes.toY({q.x, q.y, q.z});
    WideQuat<N> u{exchanged.x + zero, exchanged.y + zero, exchanged.z + zero, q.w + zero};

    excess = select(free, excess, alpha1 * p.x * p.x + alpha3 * p.z * p.z);

    const Lanes<N> size1 = max(alpha1, -alpha1), size3 = max(alpha3, -alpha3), largest = max(size1, size3);
    constexpr float kError = 1.0f / 0.04f, kMaxSteps = 511;  // as above; a bound
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
        if (uneven) {
            turnAboutAxis(half, m.x, alpha1, m.y, m.z, r.x, r.y, r.z, r.w);
            turnAboutAxis(step, m.z, alpha3, m.x, m.y, r.z, r.x, r.y, r.w);
            turnAboutAxis(half, m.x, alpha1, m.y, m.z, r.x, r.y, r.z, r.w);
        }
        r = turn * r;
        const Mask<N> active{count > i};
        p = select(active, m, p);
        u = {select(active, r.x, u.x), select(active, r.y, u.y), select(active, r.z, u.z), select(active, r.w, u.w)};
    }
    if (uneven && any(free)) u = keepingExcess(u, axes.toY(world), alpha1, alpha3, excess, free);
    const WideVec3<N> axis = axes.back({u.x, u.y, u.z});
    q = normalized(WideQuat<N>{axis.x, axis.y, axis.z, u.w});
}

/// A turn by ω + ½ h I⁻¹ (L × ω), the mean angular velocity of a substep up to its second order. In bodies,
/// |Iⱼ − Iₖ| ≤ Iᵢ, so that what is left out is a twelfth of the third power of the turn: less than rounding.
template <int N>
RAGTOP_INLINE WideQuat<N> turnedLittle(const WideQuat<N>& q, const WideVec3<N>& w, const WideVec3<N>& momentum,
                                       const SymmetricMatrix<N>& inverseWorld, float h) {
    const WideVec3<N> u = Lanes<N>(0.5f * h) * (w + Lanes<N>(0.5f * h) * (inverseWorld * cross(momentum, w)));
    const Lanes<N> squared = dot(u, u), ratio = 1.0f - (1.0f / 6) * squared;
    return normalized(WideQuat<N>{ratio * u.x, ratio * u.y, ratio * u.z, 1.0f - 0.5f * squared} * q);
}

/// What a body turns by: its rotation, its moments, and the momentum of the last substep with what its angular velocity
/// was changed by since.
template <int N>
struct FreeSpin {
    WideQuat<N> q;
    WideVec3<N> inverse, momentum;
    Mask<N> free;  ///< nothing has changed it

    RAGTOP_INLINE FreeSpin(const WideQuat<N>& rotation, const Lanes<N> rates[8], const WideVec3<N>& w,
                           const Lanes<N> memory[8], const Lanes<N> start[8])
        : q(normalized(rotation)), inverse{rates[4], rates[5], rates[6]} {
        const WideVec3<N> turned = inverseRotate(q, w - WideVec3<N>{memory[3], memory[7], start[7]});
        const WideVec3<N> gained = rotate(q, scale(WideVec3<N>{rates[0], rates[1], rates[2]}, turned));
        momentum = WideVec3<N>{start[4], start[5], start[6]} + gained;
        free = dot(gained, gained) <= Lanes<N>(0.0f);
    }

    /// By what shows no third power in single precision: θ²/12 of a turn by θ is less than a rounding. What nothing acts
    /// on is left to the splitting, which keeps its energy for good, unless it does not turn at all.
    RAGTOP_INLINE Mask<N> turnsLittle(const WideVec3<N>& w, float h) const {
        constexpr float kLittle = 1.0f / 1024;  // rad
        const Mask<N> acted = (!free) | (!(dot(momentum, momentum) > 0.0f));
        return acted & (Lanes<N>(h * h) * dot(w, w) < kLittle * kLittle);
    }
    /// As excessOfSpin.
    RAGTOP_INLINE Lanes<N> excess() const {
        const WideVec3<N> p = inverseRotate(q, momentum);
        const Lanes<N> low = min(inverse.x, inverse.y), high = max(inverse.x, inverse.y);
        const Lanes<N> middle = max(low, min(high, inverse.z));
        return (inverse.x - middle) * p.x * p.x + (inverse.y - middle) * p.y * p.y + (inverse.z - middle) * p.z * p.z;
    }

    /// Spins about nearly one principal axis, 3, which circles about the momentum by more than a quarter radian in h:
    ///   rate = |L| (1/I₃ ± √((1/I₁ − 1/I₃)(1/I₂ − 1/I₃))),  − about the axis of the least moment.
    RAGTOP_INLINE Mask<N> isFast(Lanes<N> spins, float h) {
        const Lanes<N> zero(0.0f), one(1.0f);
        const WideVec3<N> p = inverseRotate(q, momentum), squares = scale(p, p);
        const Mask<N> isX = (squares.y <= squares.x) & (squares.z <= squares.x);
        const Mask<N> isY = (squares.x < squares.y) & (squares.z <= squares.y);
        axis = select(isX, WideVec3<N>{one, zero, zero},
                      select(isY, WideVec3<N>{zero, one, zero}, WideVec3<N>{zero, zero, one}));
        const Lanes<N> total = dot(p, p), along = dot(axis, squares), about = dot(axis, inverse);
        const Lanes<N> first = select(isX, inverse.y, inverse.x) - about;
        const Lanes<N> second = select(isX | isY, inverse.z, inverse.y) - about;
        const Lanes<N> apart = sqrt(max(first * second, zero)), rate = about + select(first < zero, -apart, apart);
        squaredTurn = (h * h) * total * rate * rate;
        return (spins > 0.0f) & (along > 0.8f * total) & (squaredTurn > 1.0f / 16);
    }

    /// The angular velocity of half a substep ahead, ω + ½ h I⁻¹ (L × ω), by at most a quarter of it.
    RAGTOP_INLINE WideVec3<N> ahead(const WideVec3<N>& w, const SymmetricMatrix<N>& inverseWorld, float h) const {
        const WideVec3<N> gain = Lanes<N>(0.5f * h) * (inverseWorld * cross(momentum, w));
        const Lanes<N> square = dot(w, w);
        return w + divideOrZero(square, square + 4.0f * dot(gain, gain)) * gain;
    }

    /// The angular velocity that moves the axis of spin e in a straight line to where it will be after h, if nothing
    /// acts. Joints count besides how an arm curves with ω (`curving` in constraints/rows.h): with a the speed of e and
    /// s the spin, c₁ a + c₂ s e × a is to be its way. Where it circles by more than a radian that is left to lead them
    /// further, which damps the nutation that they feed by answering with I⁻¹.
    RAGTOP_INLINE WideVec3<N> leading(const WideVec3<N>& w, float h, const Mask<N>& jointed, Lanes<N>& excess) const {
        WideQuat<N> next = q;
        rotateFreely(next, momentum, inverse, h, free, excess);
        const WideVec3<N> now = rotate(q, axis), to = rotate(next, axis), way = to - dot(now, to) * now;
        const Lanes<N> spin = dot(now, w), square = Lanes<N>(h * h) * dot(w, w);
        const Lanes<N> share = 1.0f / (12.0f + square * (1.0f + 0.125f * square));
        const Mask<N> curves = jointed & (squaredTurn < 1.0f);
        const Lanes<N> c1 = select(curves, Lanes<N>(h) * (1.0f - 2.0f * square * share), Lanes<N>(h));
        const Lanes<N> c2 = select(curves, Lanes<N>(6 * h * h) * share * spin, Lanes<N>(0.0f));
        const WideVec3<N> speed = (1.0f / (c1 * c1 + c2 * c2)) * (c1 * way - c2 * cross(now, way));
        return spin * now + cross(now, speed);
    }

private:
    WideVec3<N> axis;
    Lanes<N> squaredTurn;  ///< of the axis about the momentum in h
};

/// False where FreeSpin::isFast would be: |L| ≤ I_max |ω|, and its rate is below 2/I_min.
template <int N>
RAGTOP_INLINE Mask<N> mayBeFast(const Lanes<N> rates[8], const WideVec3<N>& w, float h) {
    const Lanes<N> moment = max(rates[0], max(rates[1], rates[2])), inverse = max(rates[4], max(rates[5], rates[6]));
    const Lanes<N> turn = Lanes<N>(2 * h) * (moment * inverse);
    return turn * turn * dot(w, w) > 1.0f / 20;  // of 1/16, for what rounding makes of it
}

constexpr int kFewBodies = 4;  ///< lanes of what is left of a list: half of the rows that wider ones gather are no body's

template <int N>
RAGTOP_INLINE Mask<N> isZero(const WideVec3<N>& a) {
    return !((a.x != 0.0f) | (a.y != 0.0f) | (a.z != 0.0f));
}

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
            q = {select(little, q.x, split.x), select(little, q.y, split.y), select(little, q.z, split.z),
                 select(little, q.w, split.w)};
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
