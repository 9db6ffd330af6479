#pragma once

#include <cstdint>

#include "constraints/axis_rows.h"
#include "constraints/pair_motion.h"
#include "ragtop/joint.h"
#include "ragtop/math.h"
#include "solve/body_state.h"

/// The parts of which joints are made. Two bodies exchange impulses at one shared world point, half way between their
/// anchors, so that momentum is conserved to rounding whatever the gap is. Their relative motion there is u, and its
/// velocity per impulse K (pair_motion.h).
///
/// A joint makes one half rigid (three rows), then none, two or three rows of the other half, and solves both at once.
/// With 1 for the first half and 2 for the second, and w = u + β C,
///   G = K₁₁⁻¹ K₁₂,   P = K₂₂ − K₂₁ G,   p₂ = −P⁻¹ (w₂ − Gᵀ w₁),   p₁ = −K₁₁⁻¹ w₁ − G p₂,
///   Δλ = s_m p − s_i (λ − λ̂),
/// with the softness β, s_m, s_i of the soft pass, or 0, 1, 0 in the relaxing pass. What stays free is moved by scalar
/// rows (axis_rows.h) that act through the block: an impulse along the free direction comes with those that keep the
/// velocity of the rigid rows.
namespace ragtop {

/// I ω, of the inverse inertia; what cannot turn has none.
Vec3 momentumOf(const Sym3& inertia, const Vec3& w);

/// The two bodies while a joint works on them: velocities are read once and written once. A body without mass is
/// never written, since threads share the static one.
class BodyPair : public PairMotion<float> {
public:
    BodyPair(BodyState* states, const BodyInertia* inertia, std::uint32_t a, std::uint32_t b);
    /// Adds the stiffness that the impulse carried over gives to that of the bodies, for the next substep.
    void recordPull(const Arms& arms, const Vec3& impulse, float h) const;
    void store() const;
    /// Changes places as `apply` changes velocities: of kg m and kg m², and at once.
    void move(const Arms& arms, const PairVector& impulse) const;
    /// Of B relative to A: v, dp, and the energy of what the two do not have in common, turning included.
    Vec3 relativeVelocity() const { return vB - vA; }
    Vec3 relativeWay() const { return stateB_->dp - stateA_->dp; }
    float reducedMass() const;
    float relativeEnergy() const;
    const BodyState& stateA() const { return *stateA_; }
    const BodyState& stateB() const { return *stateB_; }

private:
    BodyState *stateA_, *stateB_;
};

/// K of two halves after the three rows of the first are eliminated:
///   G = K₁₁⁻¹ K₁₂,  P = K₂₂ − K₂₁ G.
/// P is the inverse mass that the second half has while the first keeps its velocity.
template <class T>
struct EliminationOf {
    FactorOf<T> first;
    MatrixOf<T> gain;     ///< G
    SymmetricOf<T> rest;  ///< P
};
using Elimination = EliminationOf<float>;
template <class T>
RAGTOP_INLINE EliminationOf<T> eliminate(const SymmetricOf<T>& k11, const MatrixOf<T>& k12, const SymmetricOf<T>& k22) {
    EliminationOf<T> e;
    e.first = factorize(k11, diagonal(k11));
    e.gain = {solve(e.first, k12.cx), solve(e.first, k12.cy), solve(e.first, k12.cz)};
    e.rest = {k22.xx - dot(k12.cx, e.gain.cx), k22.xy - dot(k12.cx, e.gain.cy), k22.xz - dot(k12.cx, e.gain.cz),
              k22.yy - dot(k12.cy, e.gain.cy), k22.yz - dot(k12.cy, e.gain.cz), k22.zz - dot(k12.cz, e.gain.cz)};
    return e;
}

/// The rigid rows of a joint as one block.
template <class T>
struct RigidBlockOf {
    // Carried from substep to substep, in world axes.
    VectorOf<T> impulseFirst, impulseSecond;  ///< N s and N m s, or the reverse when angular rows come first
    VectorOf<T> startFirst, startSecond;      ///< what they were when the substep began

    // Of the current substep.
    EliminationOf<T> mass;
    FactorOf<T> second;  ///< of Bᵀ P B
    MatrixOf<T> basis;   ///< B: two rigid directions of the second half, then the free one; else world axes
    VectorOf<T> errorFirst, errorSecond;  ///< C, in world axes and in the basis
    T noise;                              ///< what P cannot tell from zero

    std::uint32_t rigidRows = 0;    ///< of the second half: 0, 2 or 3
    std::uint32_t linearFirst = 1;  ///< 0: the angular half comes first; no bool, which would leave padding
};
using RigidBlock = RigidBlockOf<float>;

/// Which masses of a block its joint needs: of the first half, how the second moves, and its factor.
enum class BlockMass { first, moving, whole };
template <class T>
RAGTOP_INLINE void refreshMass(RigidBlockOf<T>& block, const PairMassOf<T>& mass, BlockMass needs) {
    const SymmetricOf<T>& k11 = block.linearFirst ? mass.linear : mass.angular;
    const SymmetricOf<T>& k22 = block.linearFirst ? mass.angular : mass.linear;
    if (needs == BlockMass::first) {
        block.mass.first = factorize(k11, diagonal(k11));
        return;
    }
    block.mass = eliminate<T>(k11, block.linearFirst ? transpose(mass.coupling) : mass.coupling, k22);
    block.noise = kZeroPivot * (k22.xx + k22.yy + k22.zz);
    if (needs == BlockMass::moving) return;
    const MatrixOf<T>& b = block.basis;
    // Three rows, or none, of the second half stay in world axes.
    block.second = block.rigidRows != 2
                       ? factorize(block.mass.rest, diagonal(k22))
                       : factorize<T>(inBasis<T>(block.mass.rest, b),
                                      {dot(b.cx, k22 * b.cx), dot(b.cy, k22 * b.cy), dot(b.cz, k22 * b.cz)});
}

template <class T>
RAGTOP_INLINE PairVectorOf<T> inOrder(const RigidBlockOf<T>& block, const VectorOf<T>& first,
                                      const VectorOf<T>& second) {
    return block.linearFirst ? PairVectorOf<T>{first, second} : PairVectorOf<T>{second, first};
}
inline PairVector blockImpulse(const RigidBlock& block) {
    return inOrder(block, block.impulseFirst, block.impulseSecond);
}

/// When a substep begins: notes the impulses, or takes back those noted before when the last substep had an impact.
template <class T>
RAGTOP_INLINE void beginBlock(RigidBlockOf<T>& block, const TestOf<T>& hadImpact) {
    block.impulseFirst = block.startFirst = select(hadImpact, block.startFirst, block.impulseFirst);
    block.impulseSecond = block.startSecond = select(hadImpact, block.startSecond, block.impulseSecond);
}

/// What keeps the velocity of rigid rows while an impulse acts along the free direction.
template <class T>
struct ReactionOf {
    VectorOf<T> first, second;
};
using Reaction = ReactionOf<float>;
/// With Bᵀ P B = L D Lᵀ, the second half's impulse B L⁻ᵀ e₃ moves the free direction alone, by D₃.
template <class T>
RAGTOP_INLINE ReactionOf<T> reactionTo(const RigidBlockOf<T>& block, const T& amount) {
    const FactorOf<T>& f = block.second;
    const VectorOf<T> rigid = -amount * ((f.l20 - f.l10 * f.l21) * block.basis.cx + f.l21 * block.basis.cy);
    return {-(block.mass.gain * (rigid + amount * block.basis.cz)), rigid};
}

template <class T>
struct HalvesOf {
    VectorOf<T> first, second;
};
/// With r = u + βC, block elimination of K p = −r:
///   p₂ = −(Bᵀ P B)⁻¹ Bᵀ (r₂ − Gᵀ r₁),   p₁ = −K₁₁⁻¹ r₁ − G p₂.
template <class T>
RAGTOP_INLINE HalvesOf<T> answer(const RigidBlockOf<T>& block, const PairVectorOf<T>& u, const T& biasRate) {
    const VectorOf<T> first = (block.linearFirst ? u.linear : u.angular) + biasRate * block.errorFirst;
    HalvesOf<T> p{-solve(block.mass.first, first), VectorOf<T>{}};
    if (block.rigidRows == 0) return p;
    const VectorOf<T> speed = (block.linearFirst ? u.angular : u.linear) - transposeTimes(block.mass.gain, first);
    if (block.rigidRows == 3) {
        p.second = -solve<T>(block.second, speed + biasRate * block.errorSecond);
    } else {
        const VectorOf<T> second = transposeTimes(block.basis, speed) + biasRate * block.errorSecond;
        const VectorOf<T> solved = solveFirstTwo(block.second, second);
        p.second = -(solved.x * block.basis.cx + solved.y * block.basis.cy);
    }
    p.first = p.first - block.mass.gain * p.second;
    return p;
}
/// Solves the block for the velocity `u`, which its rows are to undo, and applies the impulse to the pair. Of what it
/// carries, only what is not `held` gives way:  Δλ = massScale p − impulseScale (λ − λ̂).
template <class T, class Pair, class Soft>
RAGTOP_INLINE void solveBlock(RigidBlockOf<T>& block, Pair& pair, const ArmsOf<T>& arms, const PairVectorOf<T>& u,
                              const Soft& softness, const ReactionOf<T>& held) {
    HalvesOf<T> p = answer<T>(block, u, softness.biasRate);
    p.first = softness.massScale * p.first - softness.impulseScale * (block.impulseFirst - held.first);
    p.second = softness.massScale * p.second - softness.impulseScale * (block.impulseSecond - held.second);
    block.impulseFirst = block.impulseFirst + p.first;
    block.impulseSecond = block.impulseSecond + p.second;
    pair.apply(arms, inOrder(block, p.first, p.second));
}
/// The motion of the bodies that `share` of the errors asks for, to first order: kg m and kg m².
template <class T>
RAGTOP_INLINE PairVectorOf<T> closingMove(const RigidBlockOf<T>& block, const T& share) {
    const HalvesOf<T> p = answer<T>(block, {}, T(1.0f));
    return inOrder<T>(block, share * p.first, share * p.second);
}
/// The impulse of size `amount` along the free direction, together with what keeps the rigid rows' velocity.
template <class T>
RAGTOP_INLINE PairVectorOf<T> freeImpulse(RigidBlockOf<T>& block, const T& amount) {
    const ReactionOf<T> held = reactionTo(block, amount);
    block.impulseFirst = block.impulseFirst + held.first;
    block.impulseSecond = block.impulseSecond + held.second;
    return inOrder<T>(block, held.first, held.second + amount * block.basis.cz);
}

/// The share of its error  e² = |gap|² + ℓ² |turn|², ℓ = |rA| + |rB|,  that a joint of a free tree has beyond what
/// velocities bring back.
template <class T>
RAGTOP_INLINE T openShare(const ArmsOf<T>& arms, const TurningOf<T>& w, const T& gapSquared, const T& turnSquared,
                          float h) {
    using std::sqrt;
    const T armA = length(arms.a), armB = length(arms.b), both = armA + armB;
    const T error = sqrt(gapSquared + (both * both) * turnSquared);
    const T near = (kBending * h * h) * (armA * dot(w.a, w.a) + armB * dot(w.b, w.b));
    return select(error > near, 1 - near / error, T(0.0f));
}

}  // namespace ragtop
