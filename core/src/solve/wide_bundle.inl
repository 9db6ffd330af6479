// A bundle of contacts in lanes, and where its bodies are. Included by wide_kernels.inl.

namespace ragtop {
namespace {

/// Asks for fields of a bundle some places on. Large piles are read from memory in every pass, and the processor does not
/// foresee fields with gaps between them.
template <int N>
RAGTOP_INLINE void prefetchFields(const float* bundle, int begin, int end) {
    constexpr int kPlaces = 4, kLine = 16;  // bundles ahead, by trial; floats of a cache line
    const float* ahead = bundle + kPlaces * contact::kFields * N;
    for (int i = begin * N; i < end * N; i += kLine) __builtin_prefetch(ahead + i);
}

/// 2 tan θ/2 along the axis of a turn by θ: what turns from r to r' has moved by this × (r + r')/2. By a series, of which
/// the next term is 1e-6 of it for half a radian.
template <int N>
RAGTOP_INLINE WideVec3<N> turnOf(const WideQuat<N>& q) {
    const WideVec3<N> u{q.x, q.y, q.z};
    const Lanes<N> squared = dot(u, u);
    return (2.0f + squared * (1.0f + squared * (0.75f + 0.625f * squared))) * u;
}

/// N contacts and the bodies they join: a bundle, or several of L one after the other in memory. With `kGround` each A is
/// the static body, of which nothing is read: it has no velocity and no inverse mass, offsets and shifts are zero. The
/// results are the same to the bit: what is left out adds zeros, and where that could turn a zero's sign they are kept.
template <int N, int L = N, bool kGround = false>
struct ContactBundle {
    static constexpr int kBundle = contact::kFields * L;  ///< floats
    float* fields;
    const BodyArrays& arrays;
    std::int32_t traits;  ///< contact::Traits of some lane
    Lanes<N> a[8], b[8];  ///< velocity rows
    WideVec3<N> vA, wA, vB, wB;
    Lanes<N> massA, massB;  ///< inverse
    SymmetricMatrix<N> inertiaA, inertiaB;  ///< inverse
    WideVec3<N> normal, offset;  ///< the offset is that of now where `shift` is
    WideVec3<N> shift{Lanes<N>(0.0f), Lanes<N>(0.0f), Lanes<N>(0.0f)};
    bool coresTurned = false;  ///< what turnCores has set counts
    WideQuat<N> turnA{}, turnB{};

    RAGTOP_INLINE Lanes<N> field(int i) const {
        if constexpr (N == L)
            return Lanes<N>::load(fields + i * N);
        else
            return loadTwo<L>(fields + i * L, fields + kBundle + i * L);
    }
    RAGTOP_INLINE WideVec3<N> vector(int i) const { return {field(i), field(i + 1), field(i + 2)}; }
    RAGTOP_INLINE void set(int i, Lanes<N> value) {
        if constexpr (N == L)
            value.store(fields + i * N);
        else
            storeTwo<L>(value, fields + i * L, fields + kBundle + i * L);
    }
    RAGTOP_INLINE void set(int i, const WideVec3<N>& value) {
        set(i, value.x), set(i + 1, value.y), set(i + 2, value.z);
    }

    /// How many points some lane has, or more.
    RAGTOP_INLINE int points() const {
        const auto has = [&](contact::Trait point) { return (traits & point) != 0 ? 1 : 0; };
        return 1 + has(contact::kSecondPoint) + has(contact::kThirdPoint) + has(contact::kFourthPoint);
    }
    /// Asks for what a pass will read of a bundle some places on, if that has as many points.
    RAGTOP_INLINE void prefetchAhead() const {
        for (int k = 0; k < N / L; ++k)
            prefetchFields<L>(fields + k * kBundle, 0, contact::kPoints + points() * contact::kPointFields);
    }

    /// A field that is zero in bundles without the trait.
    RAGTOP_INLINE Lanes<N> rare(int i, contact::Trait trait) const {
        return (traits & trait) != 0 ? field(i) : Lanes<N>(0.0f);
    }
    RAGTOP_INLINE WideVec3<N> rareVector(int i, contact::Trait trait) const {
        return {rare(i, trait), rare(i + 1, trait), rare(i + 2, trait)};
    }

    RAGTOP_INLINE ContactBundle(float* bundle, const BodyArrays& bodies) : fields(bundle), arrays(bodies) {
        traits = 0;
        for (int k = 0; k < N / L; ++k)
            traits |= reinterpret_cast<const std::int32_t*>(fields + k * kBundle)[contact::kTraits * L];
        if constexpr (!kGround) {
            gatherBody(contact::kBodyA, a, inertiaA);
            vA = {a[0], a[1], a[2]}, wA = {a[4], a[5], a[6]}, massA = a[3];
        }
        gatherBody(contact::kBodyB, b, inertiaB);
        vB = {b[0], b[1], b[2]}, wB = {b[4], b[5], b[6]}, massB = b[3];
        normal = vector(contact::kNormal);
        if constexpr (!kGround) offset = vector(contact::kOffset);
    }

    /// Rows of the bodies of which `index` is kBodyA or kBodyB.
    template <class T>
    RAGTOP_INLINE NumberedRows<T, L> rowsOf(T* rows, int index, int from = 0) const {
        return {rows, reinterpret_cast<const std::uint32_t*>(fields + index * L), kBundle, from};
    }
    RAGTOP_INLINE void gatherBody(int index, Lanes<N> state[8], SymmetricMatrix<N>& inverse) const {
        gather8<N>(rowsOf(arrays.states, index).anew(), state);
        Lanes<N> m[8];
        gather8<N>(rowsOf(arrays.inertia, index).anew(), m);
        inverse = {m[0], m[1], m[2], m[3], m[4], m[5]};
    }

    /// The bodies share the point of an impulse wherever they have moved: then what one loses of the angular momentum
    /// about any place the other gains. It lies half way between the anchors, or stays below what is round.
    RAGTOP_INLINE void moveArms(const WideVec3<N>& displacement) {
        if constexpr (kGround) return;
        shift = field(contact::kFollow) * displacement;
        offset = offset + displacement;
    }
    /// By what B has moved beside A; returns what of it counts. Bodies that have moved by more than half a size are no
    /// longer where they touched: such arms would only lengthen. What a carrier takes along as it turns has not.
    RAGTOP_INLINE WideVec3<N> moveArms(const WideVec3<N>& dp, const WideQuat<N>& dqA, const WideQuat<N>& dqB) {
        if constexpr (kGround) return dp;
        const Lanes<N> zero(0.0f), half(0.5f), reach = half * field(contact::kSize), most = reach * reach;
        const Mask<N> isStatic{bits(field(contact::kBodyA)) == 0};
        Mask<N> far = dot(dp, dp) > most;
        if (any(far)) {
            const WideVec3<N> middle = offset + half * dp;
            const WideVec3<N> inA = dp - cross(turnOf(dqA), middle), inB = dp - cross(turnOf(dqB), middle);
            far = far & (dot(inA, inA) > most) & (dot(inB, inB) > most);
        }
        const WideVec3<N> displacement = select(isStatic | far, WideVec3<N>{zero, zero, zero}, dp);
        moveArms(displacement);
        return displacement;
    }
    /// A round surface touches beyond its core, which turns with the body: so does the shared point, by its share.
    RAGTOP_INLINE void turnCores(const WideQuat<N>& dqA, const WideQuat<N>& dqB) {
        if ((traits & contact::kTurningCore) == 0) return;
        if constexpr (!kGround) turnA = {-dqA.x, -dqA.y, -dqA.z, dqA.w};
        turnB = {-dqB.x, -dqB.y, -dqB.z, dqB.w};
        coresTurned = true;
    }
    /// How far the shared point that was at `anchor` has gone with the cores.
    RAGTOP_INLINE WideVec3<N> wayWithCores(const WideVec3<N>& anchor) const {
        if constexpr (kGround) {
            const WideVec3<N> core = anchor + field(contact::kRoundB) * normal;
            return field(contact::kCoreShareB) * inverseTurn(turnB, core);
        } else {
            const WideVec3<N> coreA = anchor - field(contact::kRoundA) * normal;
            const WideVec3<N> coreB = anchor - vector(contact::kOffset) + field(contact::kRoundB) * normal;
            return field(contact::kCoreShareA) * inverseTurn(turnA, coreA) +
                   field(contact::kCoreShareB) * inverseTurn(turnB, coreB);
        }
    }
    RAGTOP_INLINE WideVec3<N> arm(int i) const {
        const WideVec3<N> anchor = vector(i), shifted = kGround ? anchor : anchor + shift;
        return coresTurned ? shifted + wayWithCores(anchor) : shifted;
    }
    RAGTOP_INLINE WideVec3<N> armB(const WideVec3<N>& armA) const { return kGround ? armA : armA - offset; }

    /// Writes velocities back.
    RAGTOP_INLINE void writeVelocities() {
        if constexpr (!kGround) {
            applyLocks(vA, a[7]);
            a[0] = vA.x, a[1] = vA.y, a[2] = vA.z, a[4] = wA.x, a[5] = wA.y, a[6] = wA.z;
            scatterMoving<N>(rowsOf(arrays.states, contact::kBodyA).anew(), a, massA);
        }
        applyLocks(vB, b[7]);
        b[0] = vB.x, b[1] = vB.y, b[2] = vB.z, b[4] = wB.x, b[5] = wB.y, b[6] = wB.z;
        scatterMoving<N>(rowsOf(arrays.states, contact::kBodyB).anew(), b, massB);
    }

    /// Displacements since the beginning of the step.
    RAGTOP_INLINE void gatherDisplacements(WideVec3<N>& dp, WideQuat<N>& dqA, WideQuat<N>& dqB) const {
        Lanes<N> dB[8];
        gather8<N>(rowsOf(arrays.states, contact::kBodyB, 8).anew(), dB);
        dqB = {dB[4], dB[5], dB[6], dB[7]};
        if constexpr (kGround) {
            dp = {dB[0], dB[1], dB[2]};
        } else {
            Lanes<N> dA[8];
            gather8<N>(rowsOf(arrays.states, contact::kBodyA, 8).anew(), dA);
            dqA = {dA[4], dA[5], dA[6], dA[7]};
            dp = {dB[0] - dA[0], dB[1] - dA[1], dB[2] - dA[2]};
        }
    }

    /// The arms of the last relaxing pass, where the bodies still are.
    RAGTOP_INLINE void recallArms() {
        moveArms(vector(contact::kShift));
        if ((traits & contact::kTurningCore) == 0) return;
        WideVec3<N> dp;
        WideQuat<N> dqA, dqB;
        gatherDisplacements(dp, dqA, dqB);
        turnCores(dqA, dqB);
    }

    /// Adds to the displacements of bodies that impulses move, before velocities are written.
    RAGTOP_INLINE void displace(int index, const WideVec3<N>& dp, Lanes<N> mass) const {
        const auto places = rowsOf(arrays.states, index, 8);
        Lanes<N> d[8];
        gather8<N>(places, d);
        d[0] = d[0] + dp.x, d[1] = d[1] + dp.y, d[2] = d[2] + dp.z;
        scatterMoving<N>(places, d, mass);
    }

    RAGTOP_INLINE Lanes<N> inverseMass() const { return kGround ? massB : massA + massB; }
    /// Is one of the bodies held by no impulse?
    RAGTOP_INLINE Mask<N> isFixed() const {
        const Lanes<N> zero(0.0f);
        if constexpr (kGround)
            return {zero.v == zero.v};
        else
            return (!(massA != 0.0f)) | (!(massB != 0.0f));
    }
    RAGTOP_INLINE void applyImpulse(const WideVec3<N>& impulse, const WideVec3<N>& rA, const WideVec3<N>& rB) {
        if constexpr (!kGround) {
            vA = vA - massA * impulse;
            wA = wA - inertiaA * cross(rA, impulse);
        }
        vB = vB + massB * impulse;
        wB = wB + inertiaB * cross(rB, impulse);
    }
    /// An impulse of a size about an axis.
    RAGTOP_INLINE void applyAngular(Lanes<N> size, const WideVec3<N>& axis) {
        if constexpr (!kGround) wA = wA - size * (inertiaA * axis);
        wB = wB + size * (inertiaB * axis);
    }
    RAGTOP_INLINE void applyAngular(const WideVec3<N>& impulse) {
        if constexpr (!kGround) wA = wA - inertiaA * impulse;
        wB = wB + inertiaB * impulse;
    }
    RAGTOP_INLINE WideVec3<N> relativeVelocity(const WideVec3<N>& rA, const WideVec3<N>& rB) const {
        if constexpr (kGround)
            return vB + cross(wB, rB);
        else
            return (vB + cross(wB, rB)) - (vA + cross(wA, rA));
    }
    RAGTOP_INLINE WideVec3<N> relativeSpin() const {
        if constexpr (kGround)
            return wB;
        else
            return wB - wA;
    }
    /// K along a direction: mA⁻¹ + mB⁻¹ + (rA×d)·IA⁻¹(rA×d) + (rB×d)·IB⁻¹(rB×d), and mixed for two directions.
    RAGTOP_INLINE Lanes<N> admittance(const WideVec3<N>& rA, const WideVec3<N>& rB, const WideVec3<N>& d,
                                      const WideVec3<N>& e, Lanes<N> de) const {
        Lanes<N> ofA = inverseMass() * de;
        if constexpr (!kGround) ofA = ofA + dot(cross(rA, d), inertiaA * cross(rA, e));
        return ofA + dot(cross(rB, d), inertiaB * cross(rB, e));
    }
};

/// The rows along a bundle's normal, one point after the other:
///   u = n · (vB − vA) + (rB × n) · ωB − (rA × n) · ωA,   rB × n = rA × n − offset × n.
/// Linear velocities count through their part along n alone, and are written when all points are done; what follows
/// from one point to the next is then a few operations long.
template <int N>
struct NormalRows {
    struct Arms {
        WideVec3<N> a, b;  ///< r × n
    };
    WideVec3<N> shiftArm, offsetArm;
    Lanes<N> closing, inverseMass, total{0.0f};

    template <int L, bool kGround>
    RAGTOP_INLINE explicit NormalRows(const ContactBundle<N, L, kGround>& c) : inverseMass(c.inverseMass()) {
        if constexpr (kGround) {
            closing = dot(c.normal, c.vB);
        } else {
            shiftArm = cross(c.shift, c.normal);
            offsetArm = cross(c.offset, c.normal);
            closing = dot(c.normal, c.vB - c.vA);
        }
    }
    template <int L, bool kGround>
    RAGTOP_INLINE Arms arms(const ContactBundle<N, L, kGround>& c, const WideVec3<N>& anchor) const {
        WideVec3<N> a = cross(anchor, c.normal);
        if constexpr (!kGround) a = a + shiftArm;
        if (c.coresTurned) a = a + cross(c.wayWithCores(anchor), c.normal);
        if constexpr (kGround) {
            const Lanes<N> zero(0.0f);  // what differences of zeros are, which the general form has
            return {a, a + WideVec3<N>{zero, zero, zero}};
        } else {
            return {a, a - offsetArm};
        }
    }
    template <int L, bool kGround>
    RAGTOP_INLINE Lanes<N> speed(const ContactBundle<N, L, kGround>& c, const Arms& arms) const {
        if constexpr (kGround)
            return closing + dot(arms.b, c.wB);
        else
            return closing + (dot(arms.b, c.wB) - dot(arms.a, c.wA));
    }
    template <int L, bool kGround>
    RAGTOP_INLINE void apply(ContactBundle<N, L, kGround>& c, const Arms& arms, Lanes<N> change) {
        if constexpr (!kGround) c.wA = c.wA - change * (c.inertiaA * arms.a);
        c.wB = c.wB + change * (c.inertiaB * arms.b);
        closing = closing + inverseMass * change;
        total = total + change;
    }
    template <int L, bool kGround>
    RAGTOP_INLINE void finish(ContactBundle<N, L, kGround>& c) const {
        const WideVec3<N> impulse = total * c.normal;
        if constexpr (!kGround) c.vA = c.vA - c.massA * impulse;
        c.vB = c.vB + c.massB * impulse;
    }
};

/// Two unit vectors that complete n to a basis [Duff et al., Building an Orthonormal Basis, Revisited, JCGT 2017].
template <int N>
RAGTOP_INLINE void tangents(const WideVec3<N>& n, WideVec3<N>& t1, WideVec3<N>& t2) {
    const Lanes<N> sign = select(n.z < 0.0f, Lanes<N>(-1.0f), Lanes<N>(1.0f));
    const Lanes<N> a = Lanes<N>(-1.0f) / (sign + n.z);
    const Lanes<N> b = n.x * n.y * a;
    t1 = {1.0f + sign * n.x * n.x * a, sign * b, -(sign * n.x)};
    t2 = {b, sign + n.y * n.y * a, -n.y};
}

/// rad, turn of a step up to which slips are known; third powers are left out: 1e-6 of a radius.
constexpr float kFirstOrderTurn = 0.02f;

constexpr int pointField(int point, int field) { return contact::kPoints + point * contact::kPointFields + field; }

/// Effective masses of the rows of some lanes, for the inertia of now and the arms armOf(field).
template <int N, bool kGround, class Arm>
RAGTOP_INLINE void setMasses(ContactBundle<N, N, kGround>& c, Mask<N> lanes, Arm&& armOf) {
    typedef typename Mask<N>::V Int;
    const Int count = bits(c.field(contact::kPointCount));
    const Lanes<N> zero(0.0f), one(1.0f);
    const auto set = [&](int field, Lanes<N> value) { c.set(field, select(lanes, value, c.field(field))); };
    for (int j = 0; j < contact::kMaxPoints && any(Mask<N>{count > j}); ++j) {
        const WideVec3<N> rA = armOf(pointField(j, contact::kAnchor));
        const Lanes<N> k = c.admittance(rA, c.armB(rA), c.normal, c.normal, one);
        set(pointField(j, contact::kMass), select(Mask<N>{count > j}, divideOrZero(one, k), zero));
    }
    WideVec3<N> t1, t2;
    tangents(c.normal, t1, t2);
    const WideVec3<N> rA = armOf(contact::kCenter), rB = c.armB(rA);
    const Lanes<N> k11 = c.admittance(rA, rB, t1, t1, one);
    const Lanes<N> k12 = c.admittance(rA, rB, t1, t2, zero);
    const Lanes<N> k22 = c.admittance(rA, rB, t2, t2, one);
    // t₁ pᵀ + t₂ qᵀ, with (p, q) = (t₁, t₂) K⁻¹
    const Lanes<N> inverseDet = divideOrZero(one, k11 * k22 - k12 * k12);
    const Lanes<N> m11 = k22 * inverseDet, m12 = -(k12 * inverseDet), m22 = k11 * inverseDet;
    const WideVec3<N> p = m11 * t1 + m12 * t2, q = m12 * t1 + m22 * t2;
    const Lanes<N> entries[6] = {t1.x * p.x + t2.x * q.x, t1.x * p.y + t2.x * q.y, t1.x * p.z + t2.x * q.z,
                                 t1.y * p.y + t2.y * q.y, t1.y * p.z + t2.y * q.z, t1.z * p.z + t2.z * q.z};
    // What is an entry by rounding alone would make speeds of nothing, down to where floats end.
    const Lanes<N> rounding = 1e-7f * (entries[0] + entries[3] + entries[5]);
    for (int i = 0; i < 6; ++i)
        set(contact::kFrictionMass + i, select((entries[i] > rounding) | (entries[i] < -rounding), entries[i], zero));
    Lanes<N> twist = dot(c.normal, c.inertiaB * c.normal);
    Lanes<N> xx = c.inertiaB.xx, yy = c.inertiaB.yy, zz = c.inertiaB.zz;
    if constexpr (!kGround) {
        twist = dot(c.normal, c.inertiaA * c.normal) + twist;
        xx = c.inertiaA.xx + xx, yy = c.inertiaA.yy + yy, zz = c.inertiaA.zz + zz;
    }
    set(contact::kTwistMass, divideOrZero(one, twist));
    set(contact::kRollMass, divideOrZero(one, max(xx, max(yy, zz))));
}

constexpr float kLittleTurn = 1.0f / 100;  ///< sin² θ/2 of a turn that effective masses do not follow

/// What fast turns ask of contacts whose arms are those of the step's beginning, once positions have moved. Masses follow
/// the inertia as it turns, or the impulses of a slender body would gain energy. Contacts let go when their points are no
/// longer where they were found, half a radian on; a round surface goes on touching where it did. What spins otherwise
/// is left to continuous collision. Seldom, and for itself: the passes keep their registers.
template <int N>
__attribute__((noinline, cold)) void followFastTurns(float* fields, const BodyArrays& arrays) {
    ContactBundle<N> c(fields, arrays);
    WideVec3<N> dp;
    WideQuat<N> dqA, dqB;
    c.gatherDisplacements(dp, dqA, dqB);
    c.turnCores(dqA, dqB);
    const Lanes<N> little(kLittleTurn), limit(1.0f / 16), zero(0.0f);  // of sin² θ/2: 0.2 and 0.5 rad
    const WideVec3<N> uA{dqA.x, dqA.y, dqA.z}, uB{dqB.x, dqB.y, dqB.z};
    const Lanes<N> turn = max(dot(uA, uA), dot(uB, uB));
    setMasses(c, turn > little, [&](int field) { return c.arm(field); });
    if (!any(turn > limit)) return;
    const WideVec3<N> rA = c.vector(contact::kCenter), rB = rA - c.offset;
    const WideVec3<N> wayA = cross(uA, rA - c.rare(contact::kRoundA, contact::kRound) * c.normal);
    const WideVec3<N> wayB = cross(uB, rB + c.rare(contact::kRoundB, contact::kRound) * c.normal);
    const Mask<N> far = (dot(wayA, wayA) > limit * dot(rA, rA)) | (dot(wayB, wayB) > limit * dot(rB, rB));
    const Mask<N> lost = (turn > limit) & far;  // whatever the other lanes do
    const auto clear = [&](int field, int count) {
        for (int i = field; i < field + count; ++i) c.set(i, select(lost, zero, c.field(i)));
    };
    for (int j = 0; j < contact::kMaxPoints; ++j) {
        const Lanes<N> spent = select(lost, c.field(pointField(j, contact::kImpulse)), zero);
        c.set(pointField(j, contact::kPeak), c.field(pointField(j, contact::kPeak)) + spent);
        clear(pointField(j, contact::kImpulse), 1);
        clear(pointField(j, contact::kMass), 1);
        clear(pointField(j, contact::kLoad), 1);
    }
    clear(contact::kFrictionImpulse, 3);
    clear(contact::kRollImpulse, 3);
    clear(contact::kFrictionMass, 6);
    clear(contact::kTwistImpulse, 1);
    clear(contact::kTwistMass, 1);
    clear(contact::kRollMass, 1);
}
template <int N, int L, bool kGround>
RAGTOP_INLINE void followTurns(const ContactBundle<N, L, kGround>& c, const WideQuat<N>& dqA, const WideQuat<N>& dqB) {
    const WideVec3<N> uB{dqB.x, dqB.y, dqB.z};
    Lanes<N> turn = dot(uB, uB);
    if constexpr (!kGround) {
        const WideVec3<N> uA{dqA.x, dqA.y, dqA.z};
        turn = max(dot(uA, uA), turn);
    }
    if (!any(turn > kLittleTurn)) return;
    for (int k = 0; k < N / L; ++k) followFastTurns<L>(c.fields + k * c.kBundle, c.arrays);
}

/// Separations of a bundle's points after displacements. What turns is a round shape's core; its surface stays round.
/// n · (R r − r) = r · (Rᵀ n − n), so that a point costs one product. Made before the arms move.
template <int N>
struct Separations {
    Lanes<N> moved;
    WideVec3<N> turn;

    template <int L, bool kGround>
    RAGTOP_INLINE Separations(const ContactBundle<N, L, kGround>& c, const WideVec3<N>& dp, const WideQuat<N>& dqA,
                              const WideQuat<N>& dqB) {
        const WideVec3<N> turnB = inverseTurn(dqB, c.normal);
        const bool round = (c.traits & contact::kRound) != 0;
        moved = dot(c.normal, dp);
        if constexpr (kGround) {
            turn = turnB;
            if (round) moved = moved + c.field(contact::kRoundB) * dot(turnB, c.normal);
        } else {
            const WideVec3<N> turnA = inverseTurn(dqA, c.normal);
            turn = turnB - turnA;
            moved = moved - dot(turnB, c.offset);
            if (round)
                moved = moved + (c.field(contact::kRoundA) * dot(turnA, c.normal) +
                                 c.field(contact::kRoundB) * dot(turnB, c.normal));
        }
    }
    template <int L, bool kGround>
    RAGTOP_INLINE Lanes<N> at(const ContactBundle<N, L, kGround>& c, int point, const WideVec3<N>& anchor) const {
        return c.field(pointField(point, contact::kSeparation)) + (moved + dot(turn, anchor));
    }
};

}  // namespace
}  // namespace ragtop
