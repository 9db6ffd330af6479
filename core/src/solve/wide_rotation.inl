// Free rotation of bodies, N at a time. Included by wide_kernels.inl.
//
// Rotations follow from the angular momentum L, which is stored in world axes and changes by I Δω only. With p = L along
// the principal axes and I₂ the middle moment, the energy of free rotation splits [Dullweber, Leimkuhler, McLachlan, 1997]
// into
//   Σ pᵢ²/2Iᵢ = |L|²/2I₂ + ½ α₁ p₁² + ½ α₃ p₃²,    αᵢ = 1/Iᵢ − 1/I₂:
// one turn about L, which commutes with the others, and turns about single axes, composed to second order, α₁ for h/2, α₃
// for h, α₁ for h/2, or to fourth [Blanes, Moan, 2002]. docs/adr/0004 has the reasons.

namespace ragtop {
namespace {

template <int N>
RAGTOP_INLINE WideQuat<N> select(Mask<N> m, const WideQuat<N>& a, const WideQuat<N>& b) {
    return {select(m, a.x, b.x), select(m, a.y, b.y), select(m, a.z, b.z), select(m, a.w, b.w)};
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
    return select(little, turned, u);
}

/// A composition of fourth order: a turn by kFirst of a step about the axis of α₁, then six about that of α₃, each
/// followed by one about that of α₁ [Blanes, Moan, Practical Symplectic Partitioned Runge–Kutta Methods, 2002, table 2,
/// S₆]. Steps follow each other: the last turn of one and the first of the next are one.
struct FourthOrder {
    static constexpr int kStages = 6;  ///< of a turn about each axis, in a step
    static constexpr float kFirst = 0.0792036964311957f;  ///< of a step, as the others
    static constexpr float kThird[kStages] = {0.209515106613362f, -0.143851773179818f, 0.434336666566456f,
                                              0.434336666566456f, -0.143851773179818f, 0.209515106613362f};
    static constexpr float kNext[kStages] = {0.353172906049774f,  -0.0420650803577195f, 0.2193769557534998f,
                                             -0.0420650803577195f, 0.353172906049774f,  2 * kFirst};
};

/// What a rotation is composed of: to second order stages of equal length, half a turn about the axis of α₁, one about
/// that of α₃, and the other half; to fourth order those of a composition.
template <int N>
struct RotorStages {
    typedef typename Mask<N>::V Int;
    Mask<N> fourth;  ///< order
    Int count;
    Lanes<N> step;  ///< s, of one stage, or of all six of a composition

    /// To second order the error in energy goes with h² |L|² α₁ α₃ max(α) I₂: its root is kept below 0.04. To fourth
    /// order turns about both axes stay below ¾ rad in the six stages of a step. Their rates are bounded by what is kept,
    /// e = α₁ p₁² + α₃ p₃² and L: αᵢ² pᵢ² ≤ |αᵢ| (max(e, 0) + |αⱼ| L²), with e and αᵢ of one sign. Both keep every angle
    /// of a stage below one; what takes fewer stages is taken.
    RAGTOP_INLINE RotorStages(Lanes<N> alpha1, Lanes<N> alpha3, Lanes<N> middle, Lanes<N> squared, Lanes<N> energy,
                              float h) {
        constexpr float kError = 1.0f / 0.04f, kMaxSteps = 511;  // as above; a bound
        constexpr float kTurn = 1.0f / 0.75f, kStage = 1.0f / FourthOrder::kStages;
        const Lanes<N> zero(0.0f), size1 = max(alpha1, -alpha1), size3 = max(alpha3, -alpha3), largest = max(size1, size3);
        const Lanes<N> accuracy = (kError * kError) * divideOrZero(size1 * size3 * largest, middle);
        const Lanes<N> angle = max(largest, middle);
        const auto stages = [&](Lanes<N> perLength, float most) {
            return __builtin_convertvector(min(h * sqrt(perLength), Lanes<N>(most)).v, Int) + 1;
        };
        count = stages(squared * max(accuracy, angle * angle), kMaxSteps);
        Int steps = count;
        fourth = Mask<N>{Int{}};
        if (anySet(count > FourthOrder::kStages)) {
            const Lanes<N> rate1 = size1 * (max(select(alpha1 > 0.0f, energy, -energy), zero) + size3 * squared);
            const Lanes<N> rate3 = size3 * (max(select(alpha3 > 0.0f, energy, -energy), zero) + size1 * squared);
            const Lanes<N> common = (kStage * kStage) * (squared * middle * middle);
            const Int few = stages(max((kTurn * kTurn) * max(rate1, rate3), common), kStage * kMaxSteps);
            fourth = Mask<N>{few * FourthOrder::kStages < count};
            count = (fourth.v & few * FourthOrder::kStages) | (~fourth.v & count);
            steps = (fourth.v & few) | (~fourth.v & count);
        }
        step = Lanes<N>(h) / Lanes<N>(__builtin_convertvector(steps, typename Lanes<N>::V));
    }
    /// s, of the turn about the axis of α₁ that a stage of second order begins with, as does the first of fourth order.
    RAGTOP_INLINE Lanes<N> first() const { return select(fourth, FourthOrder::kFirst * step, 0.5f * step); }
    /// Of stage i about the axis of α₃, and about that of α₁ again.
    RAGTOP_INLINE Lanes<N> third(int i) const {
        return select(fourth, FourthOrder::kThird[i % FourthOrder::kStages] * step, step);
    }
    RAGTOP_INLINE Lanes<N> next(int i) const {
        const Mask<N> goesOn{count > i + 1};
        return select(fourth & goesOn, FourthOrder::kNext[i % FourthOrder::kStages] * step, first());
    }
};

/// Free rotation of a body of momentum `world` over h. The energy Σ pᵢ²/2Iᵢ is split as
///   |p|²/2I₂  +  α₁ p₁²/2  +  α₃ p₃²/2,   αᵢ = 1/Iᵢ − 1/I₂,   I₂ the middle moment.
/// The first part turns the body about its momentum and commutes with the others, so it is exact; those are turns about
/// single axes, composed symmetrically. A symmetric body has one α alone and is exact as a whole. Rounding would still
/// walk a body that flips over and over across its separatrix; its `excess` (see excessOfSpin) is therefore kept where
/// nothing acted, and taken from the momentum elsewhere.
template <int N>
RAGTOP_INLINE void rotateFreely(WideQuat<N>& q, const WideVec3<N>& world, const WideVec3<N>& inverseInertia, float h,
                                const Mask<N>& free, Lanes<N>& excess) {
    const MiddleAxis<N> axes(inverseInertia);
    const WideVec3<N> inverse = axes.toY(inverseInertia);
    const Lanes<N> alpha1 = inverse.x - inverse.y, alpha3 = inverse.z - inverse.y;
    // With equal moments about all axes only the first part is left; the others would change no bit but the sign of a zero.
    const bool uneven = any((alpha1 != 0.0f) | (alpha3 != 0.0f));
    const Lanes<N> zero(0.0f);
    WideVec3<N> p = axes.toY(inverseRotate(q, world));
    const WideVec3<N> exchanged = axes.toY({q.x, q.y, q.z});
    WideQuat<N> u{exchanged.x + zero, exchanged.y + zero, exchanged.z + zero, q.w + zero};

    const Lanes<N> energy = alpha1 * p.x * p.x + alpha3 * p.z * p.z;
    excess = select(free, excess, energy);

    const RotorStages<N> stages(alpha1, alpha3, inverse.y, dot(world, world), energy, h);
    const Lanes<N> part = Lanes<N>(h) / Lanes<N>(__builtin_convertvector(stages.count, typename Lanes<N>::V));
    const WideVec3<N> halfTurn = (0.5f * part * inverse.y) * axes.toY(world);
    const Lanes<N> squared = dot(halfTurn, halfTurn), ratio = sineRatio(squared);
    const WideQuat<N> turn{ratio * halfTurn.x, ratio * halfTurn.y, ratio * halfTurn.z, cosine(squared)};
    const bool second = any(!stages.fourth);
    for (int i = 0; any(Mask<N>{stages.count > i}); ++i) {
        WideVec3<N> m = p;
        WideQuat<N> r = u;
        if (uneven) {
            if (second || i == 0) turnAboutAxis(stages.first(), m.x, alpha1, m.y, m.z, r.x, r.y, r.z, r.w);
            if (second && i > 0) m = select(stages.fourth, p, m), r = select(stages.fourth, u, r);
            turnAboutAxis(stages.third(i), m.z, alpha3, m.x, m.y, r.z, r.x, r.y, r.w);
            turnAboutAxis(stages.next(i), m.x, alpha1, m.y, m.z, r.x, r.y, r.z, r.w);
        }
        r = turn * r;
        const Mask<N> active{stages.count > i};
        p = select(active, m, p);
        u = select(active, r, u);
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

}  // namespace
}  // namespace ragtop
