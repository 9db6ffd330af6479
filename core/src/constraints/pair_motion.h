#pragma once

#include "base/numbers.h"
#include "constraints/joint_constants.h"

/// Two bodies that exchange impulses at one shared world point, over a number T (base/numbers.h). Their relative motion
/// there is a pair of vectors,
///   u = (vB + ωB × rB − vA − ωA × rA,  ωB − ωA)        linear and angular,
/// and K = J M⁻¹ Jᵀ, its velocity per impulse, has four blocks:
///   K_ll = (1/mA + 1/mB) E − [rA] IA⁻¹ [rA] − [rB] IB⁻¹ [rB],   K_aa = IA⁻¹ + IB⁻¹,   K_al = IA⁻¹ [rA] + IB⁻¹ [rB].
namespace ragtop {

/// A symmetric 3×3 matrix. As all of these, not set to zero by itself: in lanes that would cost as much as a row.
template <class T>
struct SymmetricOf {
    T xx, xy, xz, yy, yz, zz;
};
using Sym3 = SymmetricOf<float>;

template <class T>
constexpr RAGTOP_INLINE VectorOf<T> operator*(const SymmetricOf<T>& m, const VectorOf<T>& a) {
    return {m.xx * a.x + m.xy * a.y + m.xz * a.z, m.xy * a.x + m.yy * a.y + m.yz * a.z,
            m.xz * a.x + m.yz * a.y + m.zz * a.z};
}
template <class T>
constexpr RAGTOP_INLINE SymmetricOf<T> operator*(const T& s, const SymmetricOf<T>& m) {
    return {s * m.xx, s * m.xy, s * m.xz, s * m.yy, s * m.yz, s * m.zz};
}
template <class T>
constexpr RAGTOP_INLINE SymmetricOf<T> operator+(const SymmetricOf<T>& a, const SymmetricOf<T>& b) {
    return {a.xx + b.xx, a.xy + b.xy, a.xz + b.xz, a.yy + b.yy, a.yz + b.yz, a.zz + b.zz};
}
template <class T>
constexpr RAGTOP_INLINE VectorOf<T> diagonal(const SymmetricOf<T>& m) {
    return {m.xx, m.yy, m.zz};
}
/// Bᵀ M B
template <class T>
RAGTOP_INLINE SymmetricOf<T> inBasis(const SymmetricOf<T>& m, const MatrixOf<T>& basis) {
    const VectorOf<T> mx = m * basis.cx, my = m * basis.cy, mz = m * basis.cz;
    return {dot(basis.cx, mx), dot(basis.cx, my), dot(basis.cx, mz),
            dot(basis.cy, my), dot(basis.cy, mz), dot(basis.cz, mz)};
}

/// L D Lᵀ of a positive semidefinite matrix. A pivot that is rounding noise beside `scale`, the diagonal before other
/// rows were eliminated, counts as zero, and the row of a zero pivot does nothing.
template <class T>
struct FactorOf {
    T inverse[3];  ///< of the pivots
    T l10, l20, l21;
};
using Factor3 = FactorOf<float>;

template <class T>
RAGTOP_INLINE T inverseOrZero(const T& pivot, const T& scale) {
    return select(pivot > kZeroPivot * scale, 1 / pivot, T(0.0f));
}
template <class T>
RAGTOP_INLINE FactorOf<T> factorize(const SymmetricOf<T>& m, const VectorOf<T>& scale) {
    FactorOf<T> f;
    f.inverse[0] = inverseOrZero(m.xx, scale.x);
    f.l10 = m.xy * f.inverse[0];
    f.l20 = m.xz * f.inverse[0];
    f.inverse[1] = inverseOrZero<T>(m.yy - f.l10 * m.xy, scale.y);
    const T yz = m.yz - f.l20 * m.xy;
    f.l21 = yz * f.inverse[1];
    f.inverse[2] = inverseOrZero<T>(m.zz - f.l20 * m.xz - f.l21 * yz, scale.z);
    return f;
}
template <class T>
RAGTOP_INLINE VectorOf<T> solve(const FactorOf<T>& f, const VectorOf<T>& right) {
    const T y = right.y - f.l10 * right.x;
    const T z = f.inverse[2] * (right.z - f.l20 * right.x - f.l21 * y);
    const T solvedY = f.inverse[1] * y - f.l21 * z;
    return {f.inverse[0] * right.x - f.l10 * solvedY - f.l20 * z, solvedY, z};
}
/// Of the leading 2×2 block; the third component is zero.
template <class T>
RAGTOP_INLINE VectorOf<T> solveFirstTwo(const FactorOf<T>& f, const VectorOf<T>& right) {
    const T y = f.inverse[1] * (right.y - f.l10 * right.x);
    return {f.inverse[0] * right.x - f.l10 * y, y, T(0.0f)};
}

/// Linear and angular: a velocity of B relative to A at the shared point, or an impulse that B receives there.
template <class T>
struct PairVectorOf {
    VectorOf<T> linear, angular;
};
using PairVector = PairVectorOf<float>;

/// K = J M⁻¹ Jᵀ of the whole relative motion, in world axes.
template <class T>
struct PairMassOf {
    SymmetricOf<T> linear, angular;
    MatrixOf<T> coupling;  ///< angular velocity per linear impulse
};
using PairMass = PairMassOf<float>;

/// Where the bodies are held: from each centre of mass to the shared point, m.
template <class T>
struct ArmsOf {
    VectorOf<T> a, b;
};
using Arms = ArmsOf<float>;

/// Angular velocities of both bodies, rad/s.
template <class T>
struct TurningOf {
    VectorOf<T> a, b;
};
using Turning = TurningOf<float>;

/// An arm that turns with ω through θ = |ω| h leaves the line of its first speed; by what its mean speed over h
/// differs:
///   (r' − r)/h − ω × r = h (1 − cos θ)/θ² ω × (ω × r) − (1 − sin θ/θ) ω × r.
/// Rows that are to find their bodies together when a substep ends [SHAKE; Ryckaert, Ciccotti, Berendsen, 1977] count
/// it. Both shares are fractions that agree with the first two terms of their series and vanish where θ is large. An
/// arm that turns itself by much is not foreseen, as stops and other joints may end its turn: by φ² = 1/3 half of it is
/// left.
template <class V>
RAGTOP_INLINE V curving(const V& w, const V& r, float h) {
    using T = decltype(dot(w, r));
    const V speed = cross(w, r);
    const T square = T(h * h) * dot(w, w), turn2 = divideOrZero(T(h * h) * dot(speed, speed), dot(r, r));
    const T share = 1 / (12 + square * (1 + 0.125f * square) + 108 * (turn2 * turn2));
    return cross(((6 * h) * share) * w, speed) - (2 * square * share) * speed;
}
/// What turning adds to the mean speed over h: of the linear motion, and of two axes along x.
template <class T>
RAGTOP_INLINE VectorOf<T> curvingArms(const TurningOf<T>& w, const ArmsOf<T>& arms, float h) {
    return curving(w.b, arms.b, h) - curving(w.a, arms.a, h);
}
template <class T>
RAGTOP_INLINE VectorOf<T> curvingAxes(const TurningOf<T>& w, const VectorOf<T>& x, float h) {
    return cross(x, curving(w.b, x, h) - curving(w.a, x, h));
}

/// The most that a moment turns a body about an axis across the arm, or a little more: the trace of I⁻¹ without what
/// belongs to the arm's own axis. A rod under tension turns easily about that, which the tension does not mind.
template <class T>
RAGTOP_INLINE T easeAcross(const SymmetricOf<T>& inertia, const VectorOf<T>& arm) {
    const T largest = max(inertia.zz, max(inertia.xx, inertia.yy));
    const T square = dot(arm, arm), along = dot(arm, inertia * arm);
    return min(inertia.xx + inertia.yy + inertia.zz - divideOrZero(along, square), largest);
}

/// The two bodies while a joint works on them.
template <class T>
struct PairMotion {
    using Vector = VectorOf<T>;
    Vector vA, wA, vB, wB;
    Vector inverseMassA, inverseMassB;  ///< 1/kg per world axis
    SymmetricOf<T> inertiaA, inertiaB;  ///< inverse
    T shareA, shareB;                   ///< of the inverse inertia

    RAGTOP_INLINE PairVectorOf<T> velocity(const ArmsOf<T>& arms) const {
        return {(vB + cross(wB, arms.b)) - (vA + cross(wA, arms.a)), wB - wA};
    }
    /// The angular velocities of now, and of bodies that a joint lets turn against each other about x alone, or not at
    /// all: what they differ by otherwise is weighted so that the joint's own impulses, which its rows take back, do
    /// not count.
    RAGTOP_INLINE TurningOf<T> turns() const { return {wA, wB}; }
    RAGTOP_INLINE TurningOf<T> turnsTogether() const {
        const T easeA = shareA * (inertiaA.xx + inertiaA.yy + inertiaA.zz);
        const T easeB = shareB * (inertiaB.xx + inertiaB.yy + inertiaB.zz);
        const Vector w = wA + divideOrZero(easeA, easeA + easeB) * (wB - wA);
        return {w, w};
    }
    RAGTOP_INLINE TurningOf<T> turnsAbout(const Vector& x) const {
        const Vector w = turnsTogether().a;
        return {w + dot(x, wA - w) * x, w + dot(x, wB - w) * x};
    }
    /// By how much the mean speed over h at which the anchors, `gap` apart, recede from each other will exceed `speed`,
    /// that of now. With the mean velocity U of the gap g:  (|g + h U| − |g|)/h = (2 g · U + h U²)/(|g + h U| + |g|).
    /// As with `curving`, a line that turns by much is not foreseen: of half a radian half is left.
    RAGTOP_INLINE T receding(const ArmsOf<T>& arms, const Vector& gap, const T& speed, float h) const {
        const ArmsOf<T> anchors{arms.a - T(0.5f) * gap, arms.b + T(0.5f) * gap};
        const Vector u = velocity(anchors).linear + curvingArms(turns(), anchors, h), ahead = gap + T(h) * u;
        const T now = length(gap), later = length(ahead);
        const T mean = divideOrZero(2 * dot(gap, u) + h * dot(u, u), now + later);
        const T cosine = max(divideOrZero(dot(gap, ahead), now * later), T(0.0f));
        return (cosine * cosine) * (cosine * cosine) * (mean - speed);
    }
    RAGTOP_INLINE void apply(const ArmsOf<T>& arms, const PairVectorOf<T>& impulse) {
        vA = vA - scale(inverseMassA, impulse.linear);
        wA = wA - turnA(arms, impulse);
        vB = vB + scale(inverseMassB, impulse.linear);
        wB = wB + turnB(arms, impulse);
    }
    /// What an impulse adds to the angular velocities, of A with its sign turned.
    RAGTOP_INLINE Vector turnA(const ArmsOf<T>& arms, const PairVectorOf<T>& impulse) const {
        return shareA * (inertiaA * (cross(arms.a, impulse.linear) + impulse.angular));
    }
    RAGTOP_INLINE Vector turnB(const ArmsOf<T>& arms, const PairVectorOf<T>& impulse) const {
        return shareB * (inertiaB * (cross(arms.b, impulse.linear) + impulse.angular));
    }
    RAGTOP_INLINE PairMassOf<T> mass(const ArmsOf<T>& arms) const {
        const Vector m = inverseMassA + inverseMassB;
        const SymmetricOf<T> iA = shareA * inertiaA, iB = shareB * inertiaB;
        const MatrixOf<T> tA = spins(iA, arms.a), tB = spins(iB, arms.b);
        const SymmetricOf<T> kA = acrossArm(tA, arms.a), kB = acrossArm(tB, arms.b);
        return {{m.x + kA.xx + kB.xx, kA.xy + kB.xy, kA.xz + kB.xz, m.y + kA.yy + kB.yy, kA.yz + kB.yz,
                 m.z + kA.zz + kB.zz},
                iA + iB,
                {tA.cx + tB.cx, tA.cy + tB.cy, tA.cz + tB.cz}};
    }
    /// J M⁻¹ Jᵀ of one linear direction alone.
    RAGTOP_INLINE T mass(const ArmsOf<T>& arms, const Vector& direction) const {
        const Vector a = cross(arms.a, direction), b = cross(arms.b, direction);
        return dot(direction, scale(inverseMassA + inverseMassB, direction)) + shareA * dot(a, inertiaA * a) +
               shareB * dot(b, inertiaB * b);
    }

private:
    /// Columns I⁻¹ (r × eᵢ): the spin that a unit impulse gives on the arm r.
    static RAGTOP_INLINE MatrixOf<T> spins(const SymmetricOf<T>& i, const Vector& r) {
        return {{i.xy * r.z - i.xz * r.y, i.yy * r.z - i.yz * r.y, i.yz * r.z - i.zz * r.y},
                {i.xz * r.x - i.xx * r.z, i.yz * r.x - i.xy * r.z, i.zz * r.x - i.xz * r.z},
                {i.xx * r.y - i.xy * r.x, i.xy * r.y - i.yy * r.x, i.xz * r.y - i.yz * r.x}};
    }
    /// (r × eᵢ) · wⱼ
    static RAGTOP_INLINE SymmetricOf<T> acrossArm(const MatrixOf<T>& w, const Vector& r) {
        return {r.z * w.cx.y - r.y * w.cx.z, r.z * w.cy.y - r.y * w.cy.z, r.z * w.cz.y - r.y * w.cz.z,
                r.x * w.cy.z - r.z * w.cy.x, r.x * w.cz.z - r.z * w.cz.x, r.y * w.cz.x - r.x * w.cz.y};
    }
};

}  // namespace ragtop
