#pragma once

#include <cstdint>

#include "constraints/axis_rows.h"
#include "ragtop/joint.h"
#include "ragtop/math.h"
#include "solve/body_state.h"

/// The parts of which joints are made. Two bodies exchange impulses at one shared world point, half way between their
/// anchors, so that momentum is conserved to rounding whatever the gap is. Their relative motion there is a pair of
/// vectors,
///   u = (vB + ωB × rB − vA − ωA × rA,  ωB − ωA)        linear and angular,
/// and K = J M⁻¹ Jᵀ, its velocity per impulse, has four blocks:
///   K_ll = (1/mA + 1/mB) E − [rA] IA⁻¹ [rA] − [rB] IB⁻¹ [rB],   K_aa = IA⁻¹ + IB⁻¹,   K_al = IA⁻¹ [rA] + IB⁻¹ [rB].
///
/// A joint makes one half rigid (three rows), then none, two or three rows of the other half, and solves both at once.
/// With 1 for the first half and 2 for the second, and w = u + β C,
///   G = K₁₁⁻¹ K₁₂,   P = K₂₂ − K₂₁ G,   p₂ = −P⁻¹ (w₂ − Gᵀ w₁),   p₁ = −K₁₁⁻¹ w₁ − G p₂,
///   Δλ = s_m p − s_i (λ − λ̂),
/// with the softness β, s_m, s_i of the soft pass, or 0, 1, 0 in the relaxing pass. What stays free is moved by scalar
/// rows (axis_rows.h) that act through the block: an impulse along the free direction comes with those that keep the
/// velocity of the rigid rows.
namespace ragtop {

/// The rate at which joints of free trees come back from beyond a limit, over that of errors of their rigid rows.
/// Limits that carry their whole load need no more; at the whole rate limbs that lie on something chatter (of 100
/// dropped humans 10 are awake after 5 s, 2 to 3 at any share from 0.06 to 0.35).
inline constexpr float kStopRate = 0.25f;

/// What all joints share in a substep.
struct JointContext {
    float h = 0, inverseH = 0;  ///< s, 1/s
    Softness softness;          ///< of the rows that are rigid in the definition
    bool ofFreeTree = false;    ///< the joint's limits carry their whole load, as its rigid rows do
};

/// A symmetric 3×3 matrix.
struct Sym3 {
    float xx = 0, xy = 0, xz = 0, yy = 0, yz = 0, zz = 0;
};
constexpr Vec3 operator*(const Sym3& m, const Vec3& a) {
    return {m.xx * a.x + m.xy * a.y + m.xz * a.z, m.xy * a.x + m.yy * a.y + m.yz * a.z,
            m.xz * a.x + m.yz * a.y + m.zz * a.z};
}
constexpr Vec3 diagonal(const Sym3& m) { return {m.xx, m.yy, m.zz}; }
/// Bᵀ M B
Sym3 inBasis(const Sym3& m, const Mat3& basis);

/// L D Lᵀ of a positive semidefinite matrix. A pivot that is rounding noise beside `scale`, the diagonal before other
/// rows were eliminated, counts as zero, and the row of a zero pivot does nothing.
struct Factor3 {
    float inverse[3] = {0, 0, 0};  ///< of the pivots
    float l10 = 0, l20 = 0, l21 = 0;
};
Factor3 factorize(const Sym3& m, const Vec3& scale);
inline Vec3 solve(const Factor3& f, const Vec3& right) {
    const float y = right.y - f.l10 * right.x;
    const float z = f.inverse[2] * (right.z - f.l20 * right.x - f.l21 * y);
    const float solvedY = f.inverse[1] * y - f.l21 * z;
    return {f.inverse[0] * right.x - f.l10 * solvedY - f.l20 * z, solvedY, z};
}
/// Of the leading 2×2 block; the third component is zero.
inline Vec3 solveFirstTwo(const Factor3& f, const Vec3& right) {
    const float y = f.inverse[1] * (right.y - f.l10 * right.x);
    return {f.inverse[0] * right.x - f.l10 * y, y, 0};
}

/// Linear and angular: a velocity of B relative to A at the shared point, or an impulse that B receives there.
struct PairVector {
    Vec3 linear, angular;
};

/// K = J M⁻¹ Jᵀ of the whole relative motion, in world axes.
struct PairMass {
    Sym3 linear, angular;
    Mat3 coupling;  ///< angular velocity per linear impulse
};

/// Where the bodies are held: from each centre of mass to the shared point, m.
struct Arms {
    Vec3 a, b;
};

/// An arm that turns with ω through θ = |ω| h leaves the line of its first speed; by what its mean speed over h
/// differs:
///   (r' − r)/h − ω × r = h (1 − cos θ)/θ² ω × (ω × r) − (1 − sin θ/θ) ω × r.
/// Rows that are to find their bodies together when a substep ends [SHAKE; Ryckaert, Ciccotti, Berendsen, 1977] count
/// it. Both shares are fractions that agree with the first two terms of their series and vanish where θ is large. An
/// arm that turns itself by much is not foreseen, as stops and other joints may end its turn: by φ² = 1/3 half of it is
/// left.
inline Vec3 curving(const Vec3& w, const Vec3& r, float h) {
    const Vec3 speed = cross(w, r);
    const float length2 = dot(r, r), square = (h * h) * dot(w, w);
    const float turn2 = length2 > 0 ? (h * h) * dot(speed, speed) / length2 : 0.0f;
    const float share = 1 / (12 + square * (1 + 0.125f * square) + 108 * (turn2 * turn2));
    return cross((6 * h * share) * w, speed) - (2 * square * share) * speed;
}

/// Angular velocities of both bodies, rad/s.
struct Turning {
    Vec3 a, b;
};

/// I ω, of the inverse inertia; what cannot turn has none.
Vec3 momentumOf(const BodyInertia& inertia, const Vec3& w);

/// The two bodies while a joint works on them: velocities are read once and written once. A body without mass is
/// never written, since threads share the static one.
class BodyPair {
public:
    BodyPair(BodyState* states, const BodyInertia* inertia, std::uint32_t a, std::uint32_t b);
    /// Adds the stiffness that the impulse carried over gives to that of the bodies, for the next substep.
    void recordPull(const Arms& arms, const Vec3& impulse, float h) const;
    PairVector velocity(const Arms& arms) const;
    /// The angular velocities of now, and of bodies that a joint lets turn against each other about x alone, or not at
    /// all: what they differ by otherwise is weighted so that the joint's own impulses, which its rows take back, do
    /// not count.
    Turning turns() const { return {wA_, wB_}; }
    Turning turnsTogether() const;
    Turning turnsAbout(const Vec3& x) const;
    /// By how much the mean speed over h at which the anchors, `gap` apart, recede from each other will exceed `speed`,
    /// that of now. As with `curving`, a line that turns by much is not foreseen: of half a radian half is left.
    float receding(const Arms& arms, const Vec3& gap, float speed, float h) const;
    void apply(const Arms& arms, const PairVector& impulse);
    void store() const;
    /// Changes places as `apply` changes velocities: of kg m and kg m², and at once.
    void move(const Arms& arms, const PairVector& impulse) const;
    PairMass mass(const Arms& arms) const;
    /// J M⁻¹ Jᵀ of one linear direction alone.
    float mass(const Arms& arms, const Vec3& direction) const;
    /// Of B relative to A: v, dp, and the energy of what the two do not have in common, turning included.
    Vec3 relativeVelocity() const { return vB_ - vA_; }
    Vec3 relativeWay() const { return stateB_->dp - stateA_->dp; }
    float reducedMass() const;
    float relativeEnergy() const;
    const BodyState& stateA() const { return *stateA_; }
    const BodyState& stateB() const { return *stateB_; }
    const BodyInertia& inertiaA() const { return *inertiaA_; }
    const BodyInertia& inertiaB() const { return *inertiaB_; }

private:
    BodyState *stateA_, *stateB_;
    const BodyInertia *inertiaA_, *inertiaB_;
    Vec3 inverseMassA_, inverseMassB_;  // 1/kg per world axis
    float shareA_, shareB_;             // of the inverse inertia
    Vec3 vA_, wA_, vB_, wB_;
};

inline PairVector BodyPair::velocity(const Arms& arms) const {
    return {(vB_ + cross(wB_, arms.b)) - (vA_ + cross(wA_, arms.a)), wB_ - wA_};
}
/// What turning adds to the mean speed over h: of the linear motion, and of two axes along x.
inline Vec3 curvingArms(const Turning& w, const Arms& arms, float h) {
    return curving(w.b, arms.b, h) - curving(w.a, arms.a, h);
}
inline Vec3 curvingAxes(const Turning& w, const Vec3& x, float h) {
    return cross(x, curving(w.b, x, h) - curving(w.a, x, h));
}
inline Turning BodyPair::turnsTogether() const {
    const float easeA = shareA_ * (inertiaA_->xx + inertiaA_->yy + inertiaA_->zz);
    const float easeB = shareB_ * (inertiaB_->xx + inertiaB_->yy + inertiaB_->zz), both = easeA + easeB;
    const Vec3 w = wA_ + (both > 0 ? easeA / both : 0.0f) * (wB_ - wA_);
    return {w, w};
}
inline Turning BodyPair::turnsAbout(const Vec3& x) const {
    const Vec3 w = turnsTogether().a;
    return {w + dot(x, wA_ - w) * x, w + dot(x, wB_ - w) * x};
}
/// With the mean velocity U of the gap g:  (|g + h U| − |g|)/h = (2 g · U + h U²)/(|g + h U| + |g|)
inline float BodyPair::receding(const Arms& arms, const Vec3& gap, float speed, float h) const {
    const Arms anchors{arms.a - 0.5f * gap, arms.b + 0.5f * gap};
    const Vec3 u = velocity(anchors).linear + curvingArms(turns(), anchors, h), ahead = gap + h * u;
    const float now = length(gap), later = length(ahead), both = now + later;
    const float mean = both > 0 ? (2 * dot(gap, u) + h * dot(u, u)) / both : 0.0f;
    const float cosine = now * later > 0 ? dot(gap, ahead) / (now * later) : 0.0f;
    const float share = cosine > 0 ? (cosine * cosine) * (cosine * cosine) : 0.0f;
    return share * (mean - speed);
}
inline void BodyPair::apply(const Arms& arms, const PairVector& impulse) {
    vA_ -= scale(inverseMassA_, impulse.linear);
    wA_ -= shareA_ * (*inertiaA_ * (cross(arms.a, impulse.linear) + impulse.angular));
    vB_ += scale(inverseMassB_, impulse.linear);
    wB_ += shareB_ * (*inertiaB_ * (cross(arms.b, impulse.linear) + impulse.angular));
}

/// K of two halves after the three rows of the first are eliminated:
///   G = K₁₁⁻¹ K₁₂,  P = K₂₂ − K₂₁ G.
/// P is the inverse mass that the second half has while the first keeps its velocity.
struct Elimination {
    Factor3 first;
    Mat3 gain;  ///< G
    Sym3 rest;  ///< P
};
Elimination eliminate(const Sym3& k11, const Mat3& k12, const Sym3& k22);

/// The rigid rows of a joint as one block.
struct RigidBlock {
    // Carried from substep to substep, in world axes.
    Vec3 impulseFirst, impulseSecond;  ///< N s and N m s, or the reverse when angular rows come first
    Vec3 startFirst, startSecond;      ///< what they were when the substep began

    // Of the current substep.
    Elimination mass;
    Factor3 second;                ///< of Bᵀ P B
    Mat3 basis;                    ///< B: two rigid directions of the second half, then the free one; else world axes
    Vec3 errorFirst, errorSecond;  ///< C, in world axes and in the basis
    float noise = 0;               ///< what P cannot tell from zero

    std::uint32_t rigidRows = 0;    ///< of the second half: 0, 2 or 3
    std::uint32_t linearFirst = 1;  ///< 0: the angular half comes first; no bool, which would leave padding
};
/// Fills in the masses: the elimination when the second half has rows, else the first factor alone.
void refreshMass(RigidBlock& block, const PairMass& mass, bool secondHasRows);
PairVector blockImpulse(const RigidBlock& block);
/// When a substep begins: notes the impulses, or takes back those noted before when the last substep had an impact.
void beginBlock(RigidBlock& block, bool hadImpact);
/// What keeps the velocity of rigid rows while an impulse acts along the free direction.
struct Reaction {
    Vec3 first, second;
};
Reaction reactionTo(const RigidBlock& block, float amount);
/// Solves the block for the velocity `u`, which its rows are to undo, and applies the impulse to the pair. Of what it
/// carries, only what is not `held` gives way.
void solveBlock(RigidBlock& block, BodyPair& pair, const Arms& arms, const PairVector& u, const Softness& softness,
                const Reaction& held = {});
/// Moves the bodies such that `share` of the errors is gone, to first order.
void closeBlock(const RigidBlock& block, const BodyPair& pair, const Arms& arms, float share);
/// The impulse of size `amount` along the free direction, together with what keeps the rigid rows' velocity.
PairVector freeImpulse(RigidBlock& block, float amount);

}  // namespace ragtop
