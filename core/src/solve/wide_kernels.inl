// Contact rows, N at a time: written once, compiled per instruction set.
//
// A manifold has the normal n from A to B and up to four points; a point has arms rA, rB from the centres of mass and
//   C = C₀ + n · (dpB + dqB rB − rB − dpA − dqA rA + rA),   the separation, negative inside; dq turns an arm
//   u = n · (vB + ωB × rB − vA − ωA × rA),                  its rate
//   1/m_eff = 1/mA + 1/mB + (rA × n)·IA⁻¹(rA × n) + (rB × n)·IB⁻¹(rB × n).
// With β, s_m, s_i of a soft row [Catto, Soft Constraints, GDC 2011] and the carried load λ̂, λ ≥ 0 changes by
//   apart, C > 0       Δλ = −m_eff (u + C/h)
//   overlap, soft      Δλ = min(m_eff u_C − s_i (λ − λ̂), m_eff u_most) − m_eff s_m u,   u_C = min(−s_m β C, u_held)
//   overlap, relax     Δλ = −m_eff u
// and both bodies take it at once: v ← v ± Δλ n/m, ω ← ω ± Δλ I⁻¹ (r × n). The points of a manifold follow each other
// (Gauss–Seidel); then come its twist and rolling rows and one pair of friction rows in the cone |λt| ≤ μ Σ λ
// (wide_friction.inl). λ̂ follows λ once per step, λ̂ ← λ̂ + α (λ − λ̂).
//
// A bundle holds N manifolds side by side (contact_layout.h); no two lanes share a moving body.

#include <cstdint>

#include "constraints/contact_layout.h"
#include "constraints/pair_motion.h"
#include "solve/kernel_table.h"
#include "solve/lane_rows.h"
#include "solve/lanes.h"
#include "solve/wide_parts.inl"
#include "solve/wide_rotation.inl"
#include "solve/wide_bodies.inl"
#include "solve/wide_bundle.inl"
#include "solve/wide_places.inl"
#include "solve/wide_friction.inl"
#include "solve/wide_bounce.inl"
#include "solve/wide_push.inl"

namespace ragtop {
namespace {

/// m, overlap that no load leaves: at rest a soft row that carries λ is −C = s_i λ/(m_eff s_m β) deep.
template <int N, int L, bool kGround>
RAGTOP_INLINE Lanes<N> deepOf(const ContactBundle<N, L, kGround>& c, const SolverContext& context) {
    return max(Lanes<N>(contact::kDeep) * c.field(contact::kSize), Lanes<N>(context.heavyDepth));
}

/// m/s, what an overlap adds at most to what its load takes.
template <int N, int L, bool kGround>
RAGTOP_INLINE Lanes<N> pushOf(const ContactBundle<N, L, kGround>& c, const SolverContext& context) {
    const Lanes<N> size = c.field(contact::kSize);
    return min(Lanes<N>(context.pushOut) * size, Lanes<N>(context.pushRoot) * sqrt(size));
}

/// m/s, u_held: what a soft row answers the depth with that counts as deep, and the push. No more takes a body out
/// sooner; and where nothing gives way, in a press, loads would grow with depth until a normal that turns a little throws
/// what is pressed.
template <int N, int L, bool kGround>
RAGTOP_INLINE Lanes<N> mostHeld(const ContactBundle<N, L, kGround>& c, const SolverContext& context) {
    const Softness& hard = context.softStatic;
    return Lanes<N>(hard.massScale * hard.biasRate) * deepOf(c, context) + pushOf(c, context);
}

/// How much of what a row with the ground carries is its own body's: 1 up to twice its weight, then less.
template <int N>
RAGTOP_INLINE Lanes<N> ownShare(Lanes<N> mass, Lanes<N> impulse, const SolverContext& context) {
    return min(divideOrZero(Lanes<N>(2 * context.gravityStep) * mass, impulse), Lanes<N>(1.0f));
}

/// λ̂ ← λ̂ + α (λ − λ̂). Integral action on a row that carries n times its own mass is stable while its time constant is
/// long beside n times that of the row: contacts with the ground that carry little else than their body may be quick, and
/// so may points that have sunk to twice what counts as deep, as long as they are. None grows beyond what a soft row
/// holds at rest.
template <int N, bool kGround>
RAGTOP_INLINE void updateLoads(ContactBundle<N, N, kGround>& c, typename Mask<N>::V count, const SolverContext& context) {
    const Lanes<N> zero(0.0f), one(1.0f), slow(context.loadShare);
    const Lanes<N> fast(context.staticLoadShare), quick = select(c.isFixed(), fast, zero);
    const Lanes<N> deep = deepOf(c, context);
    const Lanes<N> most = divideOrZero(mostHeld(c, context), Lanes<N>(context.softStatic.impulseScale));
    for (int j = 0; j < contact::kMaxPoints; ++j) {
        if (!any(Mask<N>{count > j})) return;
        const Lanes<N> mass = c.field(pointField(j, contact::kMass)),
                       impulse = c.field(pointField(j, contact::kImpulse));
        const Lanes<N> load = select(mass > zero, c.field(pointField(j, contact::kLoad)), zero);
        const Lanes<N> own = ownShare(mass, impulse, context);
        const Lanes<N> sunk = divideOrZero(-c.field(pointField(j, contact::kSeparation)), deep);
        const Lanes<N> deepShare = fast * min(max(sunk - one, zero), one);
        const Lanes<N> carried = load + max(max(slow, deepShare), quick * own * own) * (impulse - load);
        // What has lost half its load is no longer what it was, and would be pushed away.
        c.set(pointField(j, contact::kLoad), min(min(carried, impulse + impulse), max(mass * most, load)));
    }
}

/// Which contact::Traits the lanes have. By bits: −0 is added like any other number.
template <int N, bool kGround>
RAGTOP_INLINE std::int32_t traitsOf(const ContactBundle<N, N, kGround>& c, typename Mask<N>::V count) {
    typedef typename Mask<N>::V Int;
    const auto trait = [](contact::Trait which, Int set) { return anySet(set != 0) ? which : 0; };
    const auto field = [&](int i) { return bits(c.field(i)); };
    const auto vector = [&](int i) { return field(i) | field(i + 1) | field(i + 2); };
    return trait(contact::kBouncy, field(contact::kRestitution)) | trait(contact::kUneven, field(contact::kCross)) |
           trait(contact::kRolls, field(contact::kRolling) | vector(contact::kRollImpulse)) |
           trait(contact::kSpins, field(contact::kSpinning)) |
           trait(contact::kRound, field(contact::kRoundA) | field(contact::kRoundB)) |
           trait(contact::kMovingSurface, vector(contact::kSurface)) |
           trait(contact::kFindsLoad, field(contact::kShifted)) |
           trait(contact::kTurningCore, field(contact::kCoreShareA) | field(contact::kCoreShareB)) |
           trait(contact::kBodyOnBody, field(contact::kBodyA)) | trait(contact::kIsStruck, field(contact::kStruck)) |
           trait(contact::kSecondPoint, count > 1) | trait(contact::kThirdPoint, count > 2) |
           trait(contact::kFourthPoint, count > 3);
}

/// What begins anew in a step: sums of impulses, speeds of approach and the friction centre.
template <int N, bool kGround>
RAGTOP_INLINE void preparePoints(ContactBundle<N, N, kGround>& c, typename Mask<N>::V count,
                                 const SolverContext& context) {
    const Lanes<N> depth = 0.01f * c.field(contact::kSize), near = 0.01f * depth, zero(0.0f);
    WideVec3<N> center{zero, zero, zero};
    Lanes<N> weight(0.0f), fastest(0.0f), deepest(0.0f);
    int points = 0;
    for (int j = 0; j < contact::kMaxPoints; ++j) {
        const Mask<N> present{count > j};
        c.set(pointField(j, contact::kPeak), zero);
        if (!any(present)) {
            for (const int field : {contact::kImpulse, contact::kMass, contact::kLoad}) c.set(pointField(j, field), zero);
            continue;
        }
        points = j + 1;
        const WideVec3<N> rA = c.vector(pointField(j, contact::kAnchor));
        const WideVec3<N> rB = c.armB(rA);
        const Lanes<N> impulse = select(present, c.field(pointField(j, contact::kImpulse)), zero);
        c.set(pointField(j, contact::kImpulse), impulse);
        const Lanes<N> approach = dot(c.normal, c.relativeVelocity(rA, rB));
        c.set(contact::kApproach + j, approach);
        const Lanes<N> separation = c.field(pointField(j, contact::kSeparation));
        const Mask<N> meets = present & (separation + Lanes<N>(context.dt) * approach < zero);
        fastest = min(fastest, select(meets, approach, zero));
        deepest = min(deepest, select(present, separation, zero));
        // Points that are apart lose their say in where friction acts, smoothly, or tops would drift. At rest gaps
        // are rounding: it must not move the centre, which carried twists are about.
        const Lanes<N> gap = max(c.field(pointField(j, contact::kSeparation)) - near, zero);
        const Lanes<N> share = select(present, divideOrZero(depth, depth + gap), zero);
        weight = weight + share;
        center = center + share * rA;
    }
    center = divideOrZero(Lanes<N>(1.0f), weight) * center;
    const Lanes<N> left = max(c.field(contact::kStruck) - Lanes<N>(1.0f), zero);
    // What is struck, or pressed deep. Without weight, which presses nothing, what overlaps are pushed apart with is slow.
    const bool weighs = context.gravityStep > 0;
    const Lanes<N> least = weighs ? Lanes<N>(-contact::kStruckSpeed * context.gravityStep)
                                  : Lanes<N>(-context.pushOut) * c.field(contact::kSize);
    const Lanes<N> pressed = Lanes<N>(weighs ? -contact::kPressedDepth : -1e30f) * deepOf(c, context);
    c.set(contact::kStruck, select((fastest < least) | (deepest < pressed), Lanes<N>(contact::kStruckSteps), left));
    for (int j = 0; j < points; ++j) {
        const WideVec3<N> arm = c.vector(pointField(j, contact::kAnchor)) - center;
        c.set(pointField(j, contact::kLever), sqrt(dot(arm, arm)));
    }
    c.set(contact::kCenter, center);
}

template <int N, bool kGround>
RAGTOP_INLINE std::int32_t prepareBundle(float* fields, const BodyArrays& arrays, const SolverContext& context) {
    typedef typename Mask<N>::V Int;
    ContactBundle<N, N, kGround> c(fields, arrays);
    const Int count = bits(c.field(contact::kPointCount));
    preparePoints(c, count, context);
    c.traits = traitsOf(c, count);
    c.set(contact::kTraits, Lanes<N>(reinterpret_cast<typename Lanes<N>::V>(Int{} + c.traits)));
    c.set(contact::kShift, c.shift);
    setMasses(c, Mask<N>{count == count}, [&](int field) { return c.vector(field); });
    updateLoads(c, count, context);
    // Rounding of the normal does not count, or friction would change a little in every step at rest.
    const WideVec3<N> friction = c.vector(contact::kFrictionImpulse);
    const Lanes<N> along = dot(friction, c.normal);
    const Mask<N> leaves = along * along > 1e-12f * dot(friction, friction);
    c.set(contact::kFrictionImpulse, friction - select(leaves, along, Lanes<N>(0.0f)) * c.normal);
    const WideVec3<N> stick = c.vector(contact::kStick);
    c.set(contact::kStick, stick - dot(stick, c.normal) * c.normal);
    return c.traits;
}

template <int N>
std::int32_t prepareContacts(float* bundles, int begin, int end, const BodyArrays& arrays, const SolverContext& context) {
    std::int32_t traits = 0;
    for (int i = begin; i < end; ++i) {
        float* const fields = bundles + static_cast<long>(i) * contact::kFields * N;
        const bool ground = !anySet(bits(Lanes<N>::load(fields + contact::kBodyA * N)) != 0);
        traits |= ground ? prepareBundle<N, true>(fields, arrays, context) : prepareBundle<N, false>(fields, arrays, context);
    }
    return traits & (contact::kBouncy | contact::kIsStruck);
}

/// Are A of both bundles, or of the one at `fields`, static?
template <int N>
RAGTOP_INLINE bool onGround(const float* fields, int bundles) {
    std::int32_t traits = 0;
    for (int k = 0; k < bundles; ++k)
        traits |= reinterpret_cast<const std::int32_t*>(fields + k * contact::kFields * N)[contact::kTraits * N];
    return (traits & contact::kBodyOnBody) == 0;
}

template <int N, bool kGround>
RAGTOP_INLINE void warmStartBundle(float* fields, const BodyArrays& arrays, const SolverContext& context) {
    ContactBundle<N, N, kGround> c(fields, arrays);
    if (context.farContacts) c.prefetchAhead();
    c.recallArms();
    Lanes<N> total(0.0f);
    WideVec3<N> moment{Lanes<N>(0.0f), Lanes<N>(0.0f), Lanes<N>(0.0f)};
    for (int j = 0, points = c.points(); j < points; ++j) {
        const Lanes<N> impulse = c.field(pointField(j, contact::kImpulse));
        if (!any(impulse > 0.0f)) continue;
        total = total + impulse;
        const WideVec3<N> anchor = c.vector(pointField(j, contact::kAnchor));
        moment = moment + impulse * anchor;
        if (c.coresTurned) moment = moment + impulse * c.wayWithCores(anchor);
    }
    if constexpr (!kGround) moment = moment + total * c.shift;
    // Σ λⱼ rAⱼ × n and, since rBⱼ = rAⱼ − offset, (Σ λⱼ rAⱼ − Σ λⱼ offset) × n
    const WideVec3<N> linear = total * c.normal + c.vector(contact::kFrictionImpulse);
    const WideVec3<N> friction = c.vector(contact::kFrictionImpulse);
    const WideVec3<N> center = c.arm(contact::kCenter);
    const WideVec3<N> spin =
        c.field(contact::kTwistImpulse) * c.normal + c.rareVector(contact::kRollImpulse, contact::kRolls);
    const WideVec3<N> angularA = cross(moment, c.normal) + cross(center, friction) + spin;
    WideVec3<N> offset = c.offset;
    if constexpr (kGround) {
        offset = WideVec3<N>{Lanes<N>(0.0f), Lanes<N>(0.0f), Lanes<N>(0.0f)};
    } else {
        c.vA = c.vA - c.massA * linear;
        c.wA = c.wA - c.inertiaA * angularA;
    }
    c.vB = c.vB + c.massB * linear;
    c.wB = c.wB + c.inertiaB * (angularA - cross(offset, linear));
    c.writeVelocities();
}

template <int N>
void warmStartContacts(float* bundles, int begin, int end, const BodyArrays& arrays, const SolverContext& context) {
    for (int i = begin; i < end; ++i) {
        float* const fields = bundles + static_cast<long>(i) * contact::kFields * N;
        if (onGround<N>(fields, 1))
            warmStartBundle<N, true>(fields, arrays, context);
        else
            warmStartBundle<N, false>(fields, arrays, context);
    }
}

/// Which contacts that were struck leave each other after the warm start though they bear something: Σ λ u > 0.
template <int N>
void markThrown(float* bundles, int begin, int end, const BodyArrays& arrays, const SolverContext& context) {
    for (int i = begin; i < end; ++i) {
        ContactBundle<N, N, false> c(bundles + static_cast<long>(i) * contact::kFields * N, arrays);
        if ((c.traits & contact::kIsStruck) == 0) continue;
        Lanes<N> power(0.0f), load(0.0f);
        for (int j = 0, points = c.points(); j < points; ++j) {
            const Lanes<N> impulse = c.field(pointField(j, contact::kImpulse));
            const WideVec3<N> rA = c.vector(pointField(j, contact::kAnchor));
            power = power + impulse * dot(c.normal, c.relativeVelocity(rA, c.armB(rA)));
            load = load + impulse;
        }
        const Lanes<N> least(contact::kThrownSpeed * context.gravityStep), zero(0.0f);
        c.set(contact::kThrown, select(power > least * load, c.field(contact::kStruck), zero));
    }
}

/// Of a contact's normal rows; rigid until it is taken.
template <int N>
struct NormalSoftness {
    Lanes<N> rate{0.0f}, massScale{1.0f}, impulseScale{0.0f};
    Lanes<N> push{0.0f};  ///< m/s, pushOut
    Lanes<N> deep{0.0f};  ///< m, beyond which rows are as stiff as those with the ground
    Lanes<N> most{0.0f};  ///< m/s, mostHeld

    template <int L, bool kGround>
    RAGTOP_INLINE void take(const ContactBundle<N, L, kGround>& c, Mask<N> isStatic, const SolverContext& context) {
        const auto of = [&](float Softness::*which) {
            const Lanes<N> hard(context.softStatic.*which);
            return kGround ? hard : select(isStatic, hard, Lanes<N>(context.soft.*which));
        };
        massScale = of(&Softness::massScale);
        rate = massScale * of(&Softness::biasRate);
        impulseScale = of(&Softness::impulseScale);
        push = pushOf(c, context);
        deep = deepOf(c, context);
        most = mostHeld(c, context);
    }
};

/// One visit to the manifolds of a bundle, in the soft pass (kBias) or the relaxing pass. The push beyond the load is
/// bounded because the speeds of rows that push each other add up, and one relaxing pass takes back a part of them
/// only. Long: what a bundle needs stays in registers from its first row to its last.
template <int N, int L, bool kGround, bool kBias>
RAGTOP_INLINE void solveBundle(float* fields, const BodyArrays& arrays, const SolverContext& context) {
    const Lanes<N> inverseH(context.inverseH), zero(0.0f), one(1.0f), half(0.5f), threshold(-context.restitutionSpeed);
    const Lanes<N> deepRate(context.softStatic.massScale * context.softStatic.biasRate);
    ContactBundle<N, L, kGround> c(fields, arrays);
    if (context.farContacts) c.prefetchAhead();
    WideVec3<N> dp;
    WideQuat<N> dqA, dqB;
    c.gatherDisplacements(dp, dqA, dqB);
    c.turnCores(dqA, dqB);
    if constexpr (!kBias) followTurns(c, dqA, dqB);
    const Separations<N> separations(c, dp, dqA, dqB);
    const WideVec3<N> displacement = c.moveArms(dp, dqA, dqB);
    if constexpr (!kBias && !kGround) c.set(contact::kShift, displacement);
    NormalSoftness<N> soft;
    if constexpr (kBias) soft.take(c, c.isFixed(), context);
    // What holds a body on the ground has changed: nothing pulls towards loads of other points, and those that the
    // first substep finds are carried from then on. Else the body would sag where it loses a point, and rise again.
    const Lanes<N> shifted = c.rare(contact::kShifted, contact::kFindsLoad);
    const bool anyShifted = (c.traits & contact::kFindsLoad) != 0;
    if constexpr (kBias) soft.impulseScale = (one - shifted) * soft.impulseScale;
    const Mask<N> bouncy = c.rare(contact::kRestitution, contact::kBouncy) > zero;
    // What bounces is met at the end of a parabola, whose chord is flatter than its end.
    const Lanes<N> lead = select(bouncy, half * Lanes<N>(context.gravityStep), zero);
    Lanes<N> total(0.0f), leverTotal(0.0f), deepest(0.0f);
    NormalRows<N> rows(c);
    for (int j = 0, points = c.points(); j < points; ++j) {
        const Lanes<N> mass = c.field(pointField(j, contact::kMass));
        if (!any(mass > 0.0f)) break;
        const Lanes<N> old = c.field(pointField(j, contact::kImpulse));
        Lanes<N> impulse = old;
        if (context.normals) {
            const WideVec3<N> anchor = c.vector(pointField(j, contact::kAnchor));
            const typename NormalRows<N>::Arms arms = rows.arms(c, anchor);
            const Lanes<N> separation = separations.at(c, j, anchor);
            const Mask<N> apart = separation > 0.0f;
            Lanes<N> overlap = soft.rate * separation;
            if constexpr (kBias) overlap = max(min(overlap, deepRate * (separation + soft.deep)), -soft.most);
            const Lanes<N> bias = select(apart, separation * inverseH + lead, overlap);
            const Lanes<N> scale = select(apart, one, soft.massScale);
            const Lanes<N> leak = select(apart, zero, soft.impulseScale);

            const Lanes<N> speed = rows.speed(c, arms);
            Lanes<N> still = old - mass * bias;  // the impulse of a row at rest
            if constexpr (kBias) {
                // What meets fast is beyond its surface for a part of a step only.
                const Lanes<N> begun = c.field(pointField(j, contact::kSeparation));
                deepest = min(deepest, select(mass > zero, max(separation, begun), zero));
                const Lanes<N> pushed = -(mass * bias) - leak * (old - c.field(pointField(j, contact::kLoad)));
                still = old + min(pushed, mass * soft.push);
            }
            impulse = max(still - (mass * scale) * speed, zero);
            // What is to bounce comes to the surface with its own speed; the next substep reflects it there.
            if constexpr (!kBias) impulse = select(bouncy & (speed < threshold), old, impulse);
            c.set(pointField(j, contact::kImpulse), impulse);
            rows.apply(c, arms, impulse - old);
            if constexpr (!kBias)
                c.set(pointField(j, contact::kPeak), c.field(pointField(j, contact::kPeak)) + impulse);
            if (!kBias && anyShifted) {
                const Lanes<N> own = ownShare(mass, impulse, context), load = c.field(pointField(j, contact::kLoad));
                c.set(pointField(j, contact::kLoad), load + shifted * own * own * (impulse - load));
            }
        }
        total = total + impulse;
        leverTotal = leverTotal + c.field(pointField(j, contact::kLever)) * impulse;
    }
    rows.finish(c);
    if (kBias && context.normals) moveApart(c, deepest, context);
    if (!kBias && context.normals && anyShifted) c.set(contact::kShifted, zero);
    if (context.friction) {
        solveTurning(c, total, leverTotal);
        solveFriction<kBias>(c, total, soft.rate, slipOf(c, dp, displacement, dqA, dqB, context.elapsed), context);
    }
    c.writeVelocities();
}

/// Some bundles side by side, which share no moving body: one goes on while the other waits.
template <int N, int kAtOnce, bool kBias>
RAGTOP_INLINE void solvePass(float* bundles, int begin, int end, const BodyArrays& arrays,
                             const SolverContext& context) {
    const auto at = [&](int i) { return bundles + static_cast<long>(i) * contact::kFields * N; };
    int i = begin;
    if constexpr (kAtOnce > 1)
        for (; i + kAtOnce <= end; i += kAtOnce) {
            if (onGround<N>(at(i), kAtOnce))
                solveBundle<kAtOnce * N, N, true, kBias>(at(i), arrays, context);
            else
                solveBundle<kAtOnce * N, N, false, kBias>(at(i), arrays, context);
        }
    for (; i < end; ++i) {
        if (onGround<N>(at(i), 1))
            solveBundle<N, N, true, kBias>(at(i), arrays, context);
        else
            solveBundle<N, N, false, kBias>(at(i), arrays, context);
    }
}

template <int N, int kAtOnce>
void solveContacts(float* bundles, int begin, int end, const BodyArrays& arrays, const SolverContext& context) {
    solvePass<N, kAtOnce, true>(bundles, begin, end, arrays, context);
}
template <int N, int kAtOnce>
void relaxContacts(float* bundles, int begin, int end, const BodyArrays& arrays, const SolverContext& context) {
    solvePass<N, kAtOnce, false>(bundles, begin, end, arrays, context);
}

/// Bodies are in no bundles and may be wider, as may registers than a bundle is.
template <int N, int kBodies = N, int kAtOnce = 1>
constexpr KernelTable makeTable(const char* name) {
    return {name,
            N,
            integrateVelocities<kBodies>,
            integratePositions<kBodies>,
            placeContacts<N>,
            prepareContacts<N>,
            bounceContacts<N>,
            warmStartContacts<N>,
            markThrown<N>,
            solveContacts<N, kAtOnce>,
            relaxContacts<N, kAtOnce>,
            readTouches<N>};
}

}  // namespace
}  // namespace ragtop
