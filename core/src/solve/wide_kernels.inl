// Contact rows, N at a time: written once, compiled per instruction set. The soft step of [Catto, Solver2D, 2024] with
// one friction row pair and one twist row per manifold.

#include <cstdint>

#include "constraints/contact_layout.h"
#include "solve/kernel_table.h"
#include "solve/lanes.h"
#include "solve/wide_bodies.inl"

namespace ragtop {
namespace {

/// A bundle of N contacts and the bodies it joins.
template <int N>
struct ContactBundle {
    float* fields;
    const BodyArrays& arrays;
    float* rowA[N];
    float* rowB[N];
    Lanes<N> a[8], b[8];  ///< velocity rows
    WideVec3<N> vA, wA, vB, wB;
    Lanes<N> massA, massB;  ///< inverse
    SymmetricMatrix<N> inertiaA, inertiaB;  ///< inverse
    WideVec3<N> normal, offset;

    RAGTOP_INLINE Lanes<N> field(int i) const { return Lanes<N>::load(fields + i * N); }
    RAGTOP_INLINE WideVec3<N> vector(int i) const { return {field(i), field(i + 1), field(i + 2)}; }
    RAGTOP_INLINE void set(int i, Lanes<N> value) { value.store(fields + i * N); }
    RAGTOP_INLINE void set(int i, const WideVec3<N>& value) {
        set(i, value.x), set(i + 1, value.y), set(i + 2, value.z);
    }

    RAGTOP_INLINE ContactBundle(float* bundle, const BodyArrays& bodies) : fields(bundle), arrays(bodies) {
        const auto* indexA = reinterpret_cast<const std::uint32_t*>(fields + contact::kBodyA * N);
        const auto* indexB = reinterpret_cast<const std::uint32_t*>(fields + contact::kBodyB * N);
        const float *mA[N], *mB[N];
        for (int i = 0; i < N; ++i) {
            rowA[i] = reinterpret_cast<float*>(arrays.states + indexA[i]);
            rowB[i] = reinterpret_cast<float*>(arrays.states + indexB[i]);
            mA[i] = reinterpret_cast<const float*>(arrays.inertia + indexA[i]);
            mB[i] = reinterpret_cast<const float*>(arrays.inertia + indexB[i]);
        }
        gather8<N>(const_cast<const float* const*>(rowA), a);
        gather8<N>(const_cast<const float* const*>(rowB), b);
        vA = {a[0], a[1], a[2]}, wA = {a[4], a[5], a[6]}, massA = a[3];
        vB = {b[0], b[1], b[2]}, wB = {b[4], b[5], b[6]}, massB = b[3];
        Lanes<N> m[8];
        gather8<N>(mA, m);
        inertiaA = {m[0], m[1], m[2], m[3], m[4], m[5]};
        gather8<N>(mB, m);
        inertiaB = {m[0], m[1], m[2], m[3], m[4], m[5]};
        normal = vector(contact::kNormal);
        offset = vector(contact::kOffset);
    }

    /// Writes velocities back; bodies that no impulse moves are shared between threads and never written.
    RAGTOP_INLINE void writeVelocities() {
        applyLocks(vA, a[7]);
        applyLocks(vB, b[7]);
        a[0] = vA.x, a[1] = vA.y, a[2] = vA.z, a[4] = wA.x, a[5] = wA.y, a[6] = wA.z;
        b[0] = vB.x, b[1] = vB.y, b[2] = vB.z, b[4] = wB.x, b[5] = wB.y, b[6] = wB.z;
        for (int i = 0; i < N; ++i) {
            if (!(massA[i] > 0)) rowA[i] = nullptr;
            if (!(massB[i] > 0)) rowB[i] = nullptr;
        }
        scatter8<N>(rowA, a);
        scatter8<N>(rowB, b);
    }

    /// Displacements since the beginning of the step.
    RAGTOP_INLINE void gatherDisplacements(WideVec3<N>& dp, WideQuat<N>& dqA, WideQuat<N>& dqB) const {
        const float *pA[N], *pB[N];
        for (int i = 0; i < N; ++i) pA[i] = rowA[i] + 8, pB[i] = rowB[i] + 8;
        Lanes<N> dA[8], dB[8];
        gather8<N>(pA, dA);
        gather8<N>(pB, dB);
        dp = {dB[0] - dA[0], dB[1] - dA[1], dB[2] - dA[2]};
        dqA = {dA[4], dA[5], dA[6], dA[7]};
        dqB = {dB[4], dB[5], dB[6], dB[7]};
    }

    RAGTOP_INLINE void applyImpulse(const WideVec3<N>& impulse, const WideVec3<N>& rA, const WideVec3<N>& rB) {
        vA = vA - massA * impulse;
        wA = wA - inertiaA * cross(rA, impulse);
        vB = vB + massB * impulse;
        wB = wB + inertiaB * cross(rB, impulse);
    }
    RAGTOP_INLINE void applyAngular(const WideVec3<N>& impulse) {
        wA = wA - inertiaA * impulse;
        wB = wB + inertiaB * impulse;
    }
    RAGTOP_INLINE WideVec3<N> relativeVelocity(const WideVec3<N>& rA, const WideVec3<N>& rB) const {
        return (vB + cross(wB, rB)) - (vA + cross(wA, rA));
    }
    /// K along a direction: mA⁻¹ + mB⁻¹ + (rA×d)·IA⁻¹(rA×d) + (rB×d)·IB⁻¹(rB×d), and mixed for two directions.
    RAGTOP_INLINE Lanes<N> admittance(const WideVec3<N>& rA, const WideVec3<N>& rB, const WideVec3<N>& d,
                                      const WideVec3<N>& e, Lanes<N> de) const {
        return (massA + massB) * de + dot(cross(rA, d), inertiaA * cross(rA, e)) +
               dot(cross(rB, d), inertiaB * cross(rB, e));
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

constexpr int pointField(int point, int field) { return contact::kPoints + point * contact::kPointFields + field; }

template <int N>
void prepareContacts(float* bundles, int begin, int end, const BodyArrays& arrays, const SolverContext& context) {
    typedef typename Mask<N>::V Int;
    for (int i = begin; i < end; ++i) {
        ContactBundle<N> c(bundles + static_cast<long>(i) * contact::kFields * N, arrays);
        const Int count = bits(c.field(contact::kPointCount));
        const Lanes<N> depth = 0.01f * c.field(contact::kSize);

        WideVec3<N> center{Lanes<N>(0.0f), Lanes<N>(0.0f), Lanes<N>(0.0f)};
        Lanes<N> weight(0.0f);
        for (int j = 0; j < contact::kMaxPoints; ++j) {
            const Mask<N> present{count > j};
            const WideVec3<N> rA = c.vector(pointField(j, contact::kAnchor));
            const WideVec3<N> rB = rA - c.offset;
            const Lanes<N> K = c.admittance(rA, rB, c.normal, c.normal, Lanes<N>(1.0f));
            const Lanes<N> mass = select(present, divideOrZero(Lanes<N>(1.0f), K), Lanes<N>(0.0f));
            const Lanes<N> impulse = select(present, c.field(pointField(j, contact::kImpulse)), Lanes<N>(0.0f));
            const Lanes<N> load = select(present, c.field(pointField(j, contact::kLoad)), Lanes<N>(0.0f));
            c.set(pointField(j, contact::kMass), mass);
            c.set(pointField(j, contact::kImpulse), impulse);
            c.set(pointField(j, contact::kLoad), load + Lanes<N>(context.loadShare) * (impulse - load));
            c.set(pointField(j, contact::kApproach), dot(c.normal, c.relativeVelocity(rA, rB)));
            c.set(pointField(j, contact::kPeak), Lanes<N>(0.0f));
            // Points that are apart lose their say in where friction acts, smoothly, or tops would drift.
            const Lanes<N> gap = max(c.field(pointField(j, contact::kSeparation)), Lanes<N>(0.0f));
            const Lanes<N> share = select(present, divideOrZero(depth, depth + gap), Lanes<N>(0.0f));
            weight = weight + share;
            center = center + share * rA;
        }
        center = divideOrZero(Lanes<N>(1.0f), weight) * center;
        for (int j = 0; j < contact::kMaxPoints; ++j) {
            const WideVec3<N> arm = c.vector(pointField(j, contact::kAnchor)) - center;
            c.set(pointField(j, contact::kLever), sqrt(dot(arm, arm)));
        }

        WideVec3<N> t1, t2;
        tangents(c.normal, t1, t2);
        const WideVec3<N> centerB = center - c.offset;
        const Lanes<N> k11 = c.admittance(center, centerB, t1, t1, Lanes<N>(1.0f));
        const Lanes<N> k12 = c.admittance(center, centerB, t1, t2, Lanes<N>(0.0f));
        const Lanes<N> k22 = c.admittance(center, centerB, t2, t2, Lanes<N>(1.0f));
        const Lanes<N> inverseDet = divideOrZero(Lanes<N>(1.0f), k11 * k22 - k12 * k12);
        c.set(contact::kCenter, center);
        c.set(contact::kTangentMass, WideVec3<N>{k22 * inverseDet, -(k12 * inverseDet), k11 * inverseDet});
        const Lanes<N> twist = dot(c.normal, c.inertiaA * c.normal) + dot(c.normal, c.inertiaB * c.normal);
        c.set(contact::kTwistMass, divideOrZero(Lanes<N>(1.0f), twist));
        const Lanes<N> roll = max(c.inertiaA.xx + c.inertiaB.xx,
                                  max(c.inertiaA.yy + c.inertiaB.yy, c.inertiaA.zz + c.inertiaB.zz));
        c.set(contact::kRollMass, divideOrZero(Lanes<N>(1.0f), roll));
        const WideVec3<N> friction = c.vector(contact::kFrictionImpulse);
        c.set(contact::kFrictionImpulse, friction - dot(friction, c.normal) * c.normal);
    }
}

/// The speed at which points that were not struck yet in this step will be: velocities are already those of the end of
/// the substep, a fall through a gap s ends t = s / |u| h substeps in, so u⁻ = u − a h (1 − t). A point is struck up to two
/// substeps ahead, because the relax pass lets velocities end a substep that would pass the surface in the next.
template <int N>
RAGTOP_INLINE void predictApproach(ContactBundle<N>& c, const SolverContext& context) {
    if (!any(c.field(contact::kRestitution) > 0.0f)) return;
    WideVec3<N> dp;
    WideQuat<N> dqA, dqB;
    c.gatherDisplacements(dp, dqA, dqB);
    const Lanes<N> zero(0.0f), one(1.0f), h(context.h);
    const WideVec3<N> g{Lanes<N>(context.gravity[0]), Lanes<N>(context.gravity[1]), Lanes<N>(context.gravity[2])};
    // Two falling bodies fall alike; only against one that does not fall does gravity close the gap.
    const Lanes<N> falling = select(c.massB > zero, one, zero) - select(c.massA > zero, one, zero);
    const Lanes<N> gain = h * falling * dot(c.normal, g);
    for (int j = 0; j < contact::kMaxPoints; ++j) {
        const WideVec3<N> rA = c.vector(pointField(j, contact::kAnchor)), rB = rA - c.offset;
        const WideVec3<N> turned = (rotate(dqB, rB) - rB) - (rotate(dqA, rA) - rA);
        const Lanes<N> gap = max(c.field(pointField(j, contact::kSeparation)) + dot(c.normal, dp + turned), zero);
        const Lanes<N> speed = dot(c.normal, c.relativeVelocity(rA, rB));
        const Lanes<N> substeps = min(divideOrZero(gap, max(-(speed * h), zero)), Lanes<N>(2.0f));
        const Mask<N> struck = c.field(pointField(j, contact::kPeak)) > 0.0f;
        const Lanes<N> before = c.field(pointField(j, contact::kApproach));
        c.set(pointField(j, contact::kApproach), select(struck, before, speed - gain * (one - substeps)));
    }
}

template <int N>
void warmStartContacts(float* bundles, int begin, int end, const BodyArrays& arrays, const SolverContext& context) {
    for (int i = begin; i < end; ++i) {
        ContactBundle<N> c(bundles + static_cast<long>(i) * contact::kFields * N, arrays);
        predictApproach(c, context);
        Lanes<N> total(0.0f);
        WideVec3<N> moment{Lanes<N>(0.0f), Lanes<N>(0.0f), Lanes<N>(0.0f)};
        for (int j = 0; j < contact::kMaxPoints; ++j) {
            const Lanes<N> impulse = c.field(pointField(j, contact::kImpulse));
            total = total + impulse;
            moment = moment + impulse * c.vector(pointField(j, contact::kAnchor));
        }
        // Σ λⱼ rAⱼ × n and, since rBⱼ = rAⱼ − offset, (Σ λⱼ rAⱼ − Σ λⱼ offset) × n
        const WideVec3<N> linear = total * c.normal + c.vector(contact::kFrictionImpulse);
        const WideVec3<N> friction = c.vector(contact::kFrictionImpulse);
        const WideVec3<N> center = c.vector(contact::kCenter);
        const WideVec3<N> spin = c.field(contact::kTwistImpulse) * c.normal + c.vector(contact::kRollImpulse);
        const WideVec3<N> angularA = cross(moment, c.normal) + cross(center, friction) + spin;
        const WideVec3<N> angularB = angularA - cross(c.offset, linear);
        c.vA = c.vA - c.massA * linear;
        c.wA = c.wA - c.inertiaA * angularA;
        c.vB = c.vB + c.massB * linear;
        c.wB = c.wB + c.inertiaB * angularB;
        c.writeVelocities();
    }
}

/// Friction about the centre: |λt| ≤ μ Σλn as a vector (a cone), twist ≤ μ Σ lever λn, rolling ≤ rr Σλn.
template <int N>
RAGTOP_INLINE void solveFriction(ContactBundle<N>& c, Lanes<N> total, Lanes<N> leverTotal) {
    const Lanes<N> mu = c.field(contact::kFriction);
    {
        const Lanes<N> old = c.field(contact::kTwistImpulse), limit = mu * leverTotal;
        const Lanes<N> wanted = old - c.field(contact::kTwistMass) * dot(c.normal, c.wB - c.wA);
        const Lanes<N> twist = min(max(wanted, -limit), limit);
        c.set(contact::kTwistImpulse, twist);
        c.applyAngular((twist - old) * c.normal);
    }
    const Lanes<N> rolling = c.field(contact::kRolling);
    if (any(rolling > 0.0f)) {
        const WideVec3<N> old = c.vector(contact::kRollImpulse);
        const WideVec3<N> wanted = old - c.field(contact::kRollMass) * (c.wB - c.wA);
        const Lanes<N> limit = rolling * total, size = sqrt(dot(wanted, wanted));
        const WideVec3<N> roll = select(size > limit, limit / max(size, Lanes<N>(1e-30f)), Lanes<N>(1.0f)) * wanted;
        c.set(contact::kRollImpulse, roll);
        c.applyAngular(roll - old);
    }
    WideVec3<N> t1, t2;
    tangents(c.normal, t1, t2);
    const WideVec3<N> rA = c.vector(contact::kCenter), rB = rA - c.offset;
    const WideVec3<N> slip = c.relativeVelocity(rA, rB) + c.vector(contact::kSurface);
    const Lanes<N> s1 = dot(slip, t1), s2 = dot(slip, t2);
    const WideVec3<N> mass = c.vector(contact::kTangentMass);
    const WideVec3<N> old = c.vector(contact::kFrictionImpulse);
    const Lanes<N> f1 = dot(old, t1) - (mass.x * s1 + mass.y * s2);
    const Lanes<N> f2 = dot(old, t2) - (mass.y * s1 + mass.z * s2);
    const Lanes<N> limit = mu * total, size = sqrt(f1 * f1 + f2 * f2);
    const Lanes<N> share = select(size > limit, limit / max(size, Lanes<N>(1e-30f)), Lanes<N>(1.0f));
    const WideVec3<N> friction = (share * f1) * t1 + (share * f2) * t2;
    c.set(contact::kFrictionImpulse, friction);
    c.applyImpulse(friction - old, rA, rB);
}

/// C ≥ 0 per point. Apart, the row lets the gap close within the substep; overlapping, it is a soft row that relaxes
/// towards the carried load (bias pass), or a rigid velocity row (relax pass, which takes back the push-out velocity).
template <int N, bool kBias>
RAGTOP_INLINE void solvePass(float* bundles, int begin, int end, const BodyArrays& arrays, const SolverContext& context) {
    const Lanes<N> inverseH(context.inverseH), zero(0.0f), one(1.0f);
    for (int i = begin; i < end; ++i) {
        ContactBundle<N> c(bundles + static_cast<long>(i) * contact::kFields * N, arrays);
        WideVec3<N> dp;
        WideQuat<N> dqA, dqB;
        c.gatherDisplacements(dp, dqA, dqB);

        // What turns is a round shape's core; its surface stays round.
        const WideVec3<N> roundA = c.field(contact::kRoundA) * c.normal, roundB = c.field(contact::kRoundB) * c.normal;

        const Mask<N> isStatic = Mask<N>{c.massA.v == zero.v} | Mask<N>{c.massB.v == zero.v};
        Lanes<N> rate(0.0f), massScale(1.0f), impulseScale(0.0f), push(0.0f);
        if constexpr (kBias) {
            massScale = select(isStatic, Lanes<N>(context.softStatic.massScale), Lanes<N>(context.soft.massScale));
            rate = massScale * select(isStatic, Lanes<N>(context.softStatic.biasRate), Lanes<N>(context.soft.biasRate));
            impulseScale =
                select(isStatic, Lanes<N>(context.softStatic.impulseScale), Lanes<N>(context.soft.impulseScale));
            push = Lanes<N>(-context.pushOut) * c.field(contact::kSize);
        }

        Lanes<N> total(0.0f), leverTotal(0.0f);
        for (int j = 0; j < contact::kMaxPoints; ++j) {
            const Lanes<N> mass = c.field(pointField(j, contact::kMass));
            if (!any(mass > 0.0f)) break;
            const WideVec3<N> rA = c.vector(pointField(j, contact::kAnchor)), rB = rA - c.offset;
            const WideVec3<N> coreA = rA - roundA, coreB = rB + roundB;
            const WideVec3<N> turned = (rotate(dqB, coreB) - coreB) - (rotate(dqA, coreA) - coreA);
            const Lanes<N> separation =
                c.field(pointField(j, contact::kSeparation)) + dot(c.normal, dp + turned);
            const Mask<N> apart = separation > 0.0f;
            const Lanes<N> bias = select(apart, separation * inverseH, max(rate * separation, push));
            const Lanes<N> scale = select(apart, one, massScale);
            const Lanes<N> leak = select(apart, zero, impulseScale);

            const Lanes<N> speed = dot(c.normal, c.relativeVelocity(rA, rB));
            const Lanes<N> old = c.field(pointField(j, contact::kImpulse));
            Lanes<N> change = -(mass * (scale * speed + bias));
            if constexpr (kBias) change = change - leak * (old - c.field(pointField(j, contact::kLoad)));
            const Lanes<N> impulse = max(old + change, zero);
            c.set(pointField(j, contact::kImpulse), impulse);
            c.applyImpulse((impulse - old) * c.normal, rA, rB);
            total = total + impulse;
            leverTotal = leverTotal + c.field(pointField(j, contact::kLever)) * impulse;
            if constexpr (!kBias) c.set(pointField(j, contact::kPeak), c.field(pointField(j, contact::kPeak)) + impulse);
        }
        solveFriction(c, total, leverTotal);
        c.writeVelocities();
    }
}

template <int N>
void solveContacts(float* bundles, int begin, int end, const BodyArrays& arrays, const SolverContext& context) {
    solvePass<N, true>(bundles, begin, end, arrays, context);
}
template <int N>
void relaxContacts(float* bundles, int begin, int end, const BodyArrays& arrays, const SolverContext& context) {
    solvePass<N, false>(bundles, begin, end, arrays, context);
}

constexpr int kRestitutionSweeps = 8;

template <int N>
RAGTOP_INLINE void bouncePoints(ContactBundle<N>& c, Lanes<N> threshold, Lanes<N> restitution) {
    for (int j = 0; j < contact::kMaxPoints; ++j) {
        const Lanes<N> approach = c.field(pointField(j, contact::kApproach));
        const Mask<N> bounces = (approach < threshold) & (c.field(pointField(j, contact::kPeak)) > 0.0f) &
                                (restitution > 0.0f);
        if (!any(bounces)) continue;
        const WideVec3<N> rA = c.vector(pointField(j, contact::kAnchor)), rB = rA - c.offset;
        const Lanes<N> speed = dot(c.normal, c.relativeVelocity(rA, rB));
        const Lanes<N> old = c.field(pointField(j, contact::kImpulse));
        const Lanes<N> mass = c.field(pointField(j, contact::kMass));
        const Lanes<N> wanted = max(old - mass * (speed + restitution * approach), Lanes<N>(0.0f));
        const Lanes<N> impulse = select(bounces, wanted, old);
        c.set(pointField(j, contact::kImpulse), impulse);
        c.set(pointField(j, contact::kPeak), c.field(pointField(j, contact::kPeak)) + (impulse - old));
        c.applyImpulse((impulse - old) * c.normal, rA, rB);
    }
}

/// u⁺ = −e u⁻ for points that were struck faster than the threshold during the step.
template <int N>
void applyRestitution(float* bundles, int begin, int end, const BodyArrays& arrays, const SolverContext& context) {
    const Lanes<N> threshold(-context.restitutionSpeed);
    for (int i = begin; i < end; ++i) {
        float* fields = bundles + static_cast<long>(i) * contact::kFields * N;
        const Lanes<N> restitution = Lanes<N>::load(fields + contact::kRestitution * N);
        if (!any(restitution > 0.0f)) continue;
        ContactBundle<N> c(fields, arrays);
        // Points of one manifold are struck together: a single sweep would turn a box that falls flat.
        for (int sweep = 0; sweep < kRestitutionSweeps; ++sweep) bouncePoints(c, threshold, restitution);
        c.writeVelocities();
    }
}

template <int N>
constexpr KernelTable makeTable(const char* name) {
    return {name,
            N,
            integrateVelocities<N>,
            integratePositions<N>,
            prepareContacts<N>,
            warmStartContacts<N>,
            solveContacts<N>,
            relaxContacts<N>,
            applyRestitution<N>};
}

}  // namespace
}  // namespace ragtop
