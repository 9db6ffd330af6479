#pragma once

#include "constraints/joint_swing.h"
#include "constraints/rows.h"

/// The rows that turn a ball's bodies, over a number T (base/numbers.h). Torques come with the force that keeps the
/// point together, so the inverse inertia is the block's P (rows.h).
namespace ragtop {

template <class T>
RAGTOP_INLINE VectorOf<T> clampLength(const VectorOf<T>& a, const T& longest) {
    const T l = length(a);
    return select(l > longest, (longest / l) * a, a);
}

/// The ball's rotation while its rows are solved in turn.
template <class T>
struct BallTurnOf {
    using Vector = VectorOf<T>;
    const RigidBlockOf<T>& block;
    Vector speed, total;

    RAGTOP_INLINE void add(const Vector& impulse) {
        total = total + impulse;
        speed = speed + block.mass.rest * impulse;
    }
    /// λ = push − drag ω about all axes at once: (E + drag P) λ = push − drag (ω − P λ_old).
    RAGTOP_INLINE void comply(Vector& impulse, const Vector& push, const T& drag, const T& longest) {
        const SymmetricOf<T>& p = block.mass.rest;
        const SymmetricOf<T> k{1 + drag * p.xx, drag * p.xy, drag * p.xz,
                               1 + drag * p.yy, drag * p.yz, 1 + drag * p.zz};
        const Vector old = impulse, right = push - drag * (speed - p * old);
        impulse = clampLength<T>(solve<T>(factorize<T>(k, diagonal(k)), right), longest);
        add(impulse - old);
    }
    RAGTOP_INLINE void rub(Vector& impulse, const T& bound) {
        const Vector old = impulse;
        impulse = clampLength<T>(old - solve<T>(block.second, speed), bound);
        add(impulse - old);
    }
    /// A stop whose margin grows with the speed about `axis`, by `along` on the mean. Returns the energy of the change
    /// of its impulse.
    RAGTOP_INLINE T stop(StopSideOf<T>& side, const Vector& axis, const RowAimOf<T>& aim, const T& along,
                         const JointContext& context, const TestOf<T>& acts) {
        const T inverseMass = dot(axis, block.mass.rest * axis);
        const T change =
            solveRow<T>(side.impulse, aim, along, inverseMass, context, acts & (inverseMass > block.noise));
        add(change * axis);
        return inverseMass * change * change;
    }
    /// A cone that closes on what turns in it would spin it up, as arms drawn in spin up a skater. Coming back from
    /// beyond a limit is to add no energy: the relative rotation is slowed down to what it had.
    RAGTOP_INLINE void shed(const T& mostEnergy) {
        using std::sqrt;
        const TestOf<T> limited = mostEnergy < T(kNoForceLimit);
        if (!any(limited)) return;
        const Vector momentum = solve<T>(block.second, speed);
        const T energy = 0.5f * dot(speed, momentum);
        add(select(limited & (energy > mostEnergy), (sqrt(mostEnergy / energy) - T(1.0f)) * momentum, Vector{}));
    }
};

/// The relative rotation that there would be if nothing out of place were brought back, neither the point nor a margin:
/// what acts would hold. Takes the rates about some axes out of it, n · ω = 0, by impulses about them: each axis is
/// first made P-orthogonal to those before it.
template <class T>
struct HeldRotationOf {
    using Vector = VectorOf<T>;
    static constexpr int kMost = 1 + SwingLimit::kSides;  ///< the twist, and the sides of the swing
    const RigidBlockOf<T>& block;
    Vector rotation, axes[kMost], responses[kMost];
    T inverseMasses[kMost];
    TestOf<T> held[kMost];
    int count = 0;

    RAGTOP_INLINE HeldRotationOf(const BallTurnOf<T>& turn, const PairMotion<T>& pair, const ArmsOf<T>& arms)
        : block(turn.block) {
        const PairVectorOf<T> u = pair.velocity(arms);
        PairMotion<T> still = pair;
        still.apply(arms, {-solve<T>(block.mass.first, u.linear), Vector{}});
        rotation = turn.speed + (still.velocity(arms).angular - u.angular);
    }
    RAGTOP_INLINE void hold(Vector axis, const TestOf<T>& where) {
        for (int i = 0; i < count; ++i)
            axis = select(held[i], axis - (dot(axis, responses[i]) / inverseMasses[i]) * axes[i], axis);
        const Vector response = block.mass.rest * axis;
        const T inverseMass = dot(axis, response);
        const TestOf<T> holds = where & (inverseMass > block.noise);
        rotation = select(holds, rotation - (dot(axis, rotation) / inverseMass) * response, rotation);
        axes[count] = axis;
        responses[count] = response;
        inverseMasses[count] = inverseMass;
        held[count++] = holds;
    }
    /// ½ ω · P⁻¹ ω, J.
    RAGTOP_INLINE T energy() const { return 0.5f * dot(rotation, solve<T>(block.second, rotation)); }
};

}  // namespace ragtop
