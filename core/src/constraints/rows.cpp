#include "constraints/rows.h"

#include "constraints/joint_constants.h"

namespace ragtop {
namespace {

constexpr BodyInertia kNoInertia{};

float inverseOr0(float pivot, float scale) { return pivot > kZeroPivot * scale ? 1 / pivot : 0.0f; }

Vec3 inverseMassOf(const BodyState& state) {
    const float m = state.invMass;
    return {state.locks & 1u ? 0.0f : m, state.locks & 2u ? 0.0f : m, state.locks & 4u ? 0.0f : m};
}

Sym3 times(float share, const BodyInertia& i) {
    return {share * i.xx, share * i.xy, share * i.xz, share * i.yy, share * i.yz, share * i.zz};
}

/// Columns I⁻¹ (r × eᵢ): the spin that a unit impulse gives on the arm r.
Mat3 turning(const Sym3& i, const Vec3& r) {
    return {{i.xy * r.z - i.xz * r.y, i.yy * r.z - i.yz * r.y, i.yz * r.z - i.zz * r.y},
            {i.xz * r.x - i.xx * r.z, i.yz * r.x - i.xy * r.z, i.zz * r.x - i.xz * r.z},
            {i.xx * r.y - i.xy * r.x, i.xy * r.y - i.yy * r.x, i.xz * r.y - i.yz * r.x}};
}

/// (r × eᵢ) · wⱼ
Sym3 outerCross(const Mat3& w, const Vec3& r) {
    return {r.z * w.cx.y - r.y * w.cx.z, r.z * w.cy.y - r.y * w.cy.z, r.z * w.cz.y - r.y * w.cz.z,
            r.x * w.cy.z - r.z * w.cy.x, r.x * w.cz.z - r.z * w.cz.x, r.y * w.cz.x - r.x * w.cz.y};
}

}  // namespace

Sym3 inBasis(const Sym3& m, const Mat3& basis) {
    const Vec3 mx = m * basis.cx, my = m * basis.cy, mz = m * basis.cz;
    return {dot(basis.cx, mx), dot(basis.cx, my), dot(basis.cx, mz),
            dot(basis.cy, my), dot(basis.cy, mz), dot(basis.cz, mz)};
}

Factor3 factorize(const Sym3& m, const Vec3& scale) {
    Factor3 f;
    f.inverse[0] = inverseOr0(m.xx, scale.x);
    f.l10 = m.xy * f.inverse[0];
    f.l20 = m.xz * f.inverse[0];
    f.inverse[1] = inverseOr0(m.yy - f.l10 * m.xy, scale.y);
    const float yz = m.yz - f.l20 * m.xy;
    f.l21 = yz * f.inverse[1];
    f.inverse[2] = inverseOr0(m.zz - f.l20 * m.xz - f.l21 * yz, scale.z);
    return f;
}

BodyPair::BodyPair(BodyState* states, const BodyInertia* inertia, std::uint32_t a, std::uint32_t b)
    : stateA_(states + a),
      stateB_(states + b),
      inertiaA_(stateA_->invMass > 0 ? inertia + a : &kNoInertia),
      inertiaB_(stateB_->invMass > 0 ? inertia + b : &kNoInertia),
      inverseMassA_(inverseMassOf(*stateA_)),
      inverseMassB_(inverseMassOf(*stateB_)),
      shareA_(TautBody::share(inertiaA_->taut)),
      shareB_(TautBody::share(inertiaB_->taut)),
      vA_(stateA_->v),
      wA_(stateA_->w),
      vB_(stateB_->v),
      wB_(stateB_->w) {}

namespace {

/// The most that a moment turns a body about an axis across the arm, or a little more: the trace of I⁻¹ without what
/// belongs to the arm's own axis. A rod under tension turns easily about that, which the tension does not mind.
float easeAcross(const BodyInertia& inertia, const Vec3& arm) {
    float largest = inertia.xx > inertia.yy ? inertia.xx : inertia.yy;
    if (inertia.zz > largest) largest = inertia.zz;
    const float square = dot(arm, arm), along = dot(arm, inertia * arm);
    const float across = inertia.xx + inertia.yy + inertia.zz - (square > 0 ? along / square : 0.0f);
    return across < largest ? across : largest;
}

/// `pull` is h F · r.
void addPull(BodyState& state, const BodyInertia& inertia, const Vec3& arm, float pull) {
    const float ratio = pull * easeAcross(inertia, arm);
    if (state.invMass > 0 && ratio > 0) state.pull += ratio;
}

}  // namespace

void BodyPair::recordPull(const Arms& arms, const Vec3& impulse, float h) const {
    addPull(*stateA_, *inertiaA_, arms.a, -h * dot(arms.a, impulse));
    addPull(*stateB_, *inertiaB_, arms.b, h * dot(arms.b, impulse));
}

/// q ← (½ θ, 1) q, normalised.
static Quat turned(const Quat& q, const Vec3& turn) {
    return normalized(Quat{0.5f * turn.x, 0.5f * turn.y, 0.5f * turn.z, 1.0f} * q);
}

void BodyPair::move(const Arms& arms, const PairVector& impulse) const {
    BodyState &a = *stateA_, &b = *stateB_;
    if (a.invMass > 0) {
        a.dp -= scale(inverseMassA_, impulse.linear);
        a.dq = turned(a.dq, -(shareA_ * (*inertiaA_ * (cross(arms.a, impulse.linear) + impulse.angular))));
    }
    if (b.invMass > 0) {
        b.dp += scale(inverseMassB_, impulse.linear);
        b.dq = turned(b.dq, shareB_ * (*inertiaB_ * (cross(arms.b, impulse.linear) + impulse.angular)));
    }
}

void BodyPair::store() const {
    if (stateA_->invMass > 0) {
        stateA_->v = vA_;
        stateA_->w = wA_;
    }
    if (stateB_->invMass > 0) {
        stateB_->v = vB_;
        stateB_->w = wB_;
    }
}

PairMass BodyPair::mass(const Arms& arms) const {
    const Vec3 m = inverseMassA_ + inverseMassB_;
    const Sym3 iA = times(shareA_, *inertiaA_), iB = times(shareB_, *inertiaB_);
    const Mat3 wA = turning(iA, arms.a), wB = turning(iB, arms.b);
    const Sym3 kA = outerCross(wA, arms.a), kB = outerCross(wB, arms.b);
    PairMass k;
    k.linear = {m.x + kA.xx + kB.xx, kA.xy + kB.xy, kA.xz + kB.xz,
                m.y + kA.yy + kB.yy, kA.yz + kB.yz, m.z + kA.zz + kB.zz};
    k.coupling = wA + wB;
    k.angular = {iA.xx + iB.xx, iA.xy + iB.xy, iA.xz + iB.xz, iA.yy + iB.yy, iA.yz + iB.yz, iA.zz + iB.zz};
    return k;
}

Vec3 momentumOf(const BodyInertia& inertia, const Vec3& w) {
    const Sym3 inverse = times(1, inertia);
    return solve(factorize(inverse, diagonal(inverse)), w);
}

float BodyPair::reducedMass() const {
    const float inverse = stateA_->invMass + stateB_->invMass;
    return inverse > 0 ? 1 / inverse : 0.0f;
}

float BodyPair::relativeEnergy() const {
    const auto turning = [](const BodyInertia& inertia, const Vec3& w) { return dot(w, momentumOf(inertia, w)); };
    return 0.5f *
           (reducedMass() * lengthSquared(relativeVelocity()) + turning(*inertiaA_, wA_) + turning(*inertiaB_, wB_));
}

float BodyPair::mass(const Arms& arms, const Vec3& direction) const {
    const Vec3 a = cross(arms.a, direction), b = cross(arms.b, direction);
    return dot(direction, scale(inverseMassA_ + inverseMassB_, direction)) + shareA_ * dot(a, *inertiaA_ * a) +
           shareB_ * dot(b, *inertiaB_ * b);
}

Elimination eliminate(const Sym3& k11, const Mat3& k12, const Sym3& k22) {
    Elimination e;
    e.first = factorize(k11, diagonal(k11));
    e.gain = {solve(e.first, k12.cx), solve(e.first, k12.cy), solve(e.first, k12.cz)};
    e.rest = {k22.xx - dot(k12.cx, e.gain.cx), k22.xy - dot(k12.cx, e.gain.cy), k22.xz - dot(k12.cx, e.gain.cz),
              k22.yy - dot(k12.cy, e.gain.cy), k22.yz - dot(k12.cy, e.gain.cz), k22.zz - dot(k12.cz, e.gain.cz)};
    return e;
}

void refreshMass(RigidBlock& block, const PairMass& mass, bool secondHasRows) {
    const Sym3& k11 = block.linearFirst ? mass.linear : mass.angular;
    const Sym3& k22 = block.linearFirst ? mass.angular : mass.linear;
    if (!secondHasRows) {
        block.mass.first = factorize(k11, diagonal(k11));
        return;
    }
    block.mass = eliminate(k11, block.linearFirst ? transpose(mass.coupling) : mass.coupling, k22);
    block.noise = kZeroPivot * (k22.xx + k22.yy + k22.zz);
    if (block.rigidRows != 2) {
        // All rows of the second half stay in world axes.
        block.second = factorize(block.mass.rest, diagonal(k22));
        return;
    }
    const Mat3& b = block.basis;
    block.second =
        factorize(inBasis(block.mass.rest, b), {dot(b.cx, k22 * b.cx), dot(b.cy, k22 * b.cy), dot(b.cz, k22 * b.cz)});
}

namespace {

PairVector ordered(const RigidBlock& block, const Vec3& first, const Vec3& second) {
    return block.linearFirst ? PairVector{first, second} : PairVector{second, first};
}

}  // namespace

PairVector blockImpulse(const RigidBlock& block) { return ordered(block, block.impulseFirst, block.impulseSecond); }

void beginBlock(RigidBlock& block, bool hadImpact) {
    if (hadImpact) {
        block.impulseFirst = block.startFirst;
        block.impulseSecond = block.startSecond;
    }
    block.startFirst = block.impulseFirst;
    block.startSecond = block.impulseSecond;
}

namespace {

struct Halves {
    Vec3 first, second;
};

/// With r = u + βC, block elimination of K p = −r:
///   p₂ = −(Bᵀ P B)⁻¹ Bᵀ (r₂ − Gᵀ r₁),   p₁ = −K₁₁⁻¹ r₁ − G p₂.
Halves answer(const RigidBlock& block, const PairVector& u, float biasRate) {
    const Vec3 first = (block.linearFirst ? u.linear : u.angular) + biasRate * block.errorFirst;
    Halves p{-solve(block.mass.first, first), {}};
    if (block.rigidRows == 0) return p;
    const Vec3 speed = (block.linearFirst ? u.angular : u.linear) - transposeTimes(block.mass.gain, first);
    if (block.rigidRows == 3) {
        p.second = -solve(block.second, speed + biasRate * block.errorSecond);
    } else {
        const Vec3 second = transposeTimes(block.basis, speed) + biasRate * block.errorSecond;
        const Vec3 solved = solveFirstTwo(block.second, second);
        p.second = -(solved.x * block.basis.cx + solved.y * block.basis.cy);
    }
    p.first -= block.mass.gain * p.second;
    return p;
}

}  // namespace

/// Δλ = massScale p − impulseScale λ
void solveBlock(RigidBlock& block, BodyPair& pair, const Arms& arms, const PairVector& u, const Softness& soft,
                const Reaction& held) {
    Halves p = answer(block, u, soft.biasRate);
    p.first = soft.massScale * p.first - soft.impulseScale * (block.impulseFirst - held.first);
    p.second = soft.massScale * p.second - soft.impulseScale * (block.impulseSecond - held.second);
    block.impulseFirst += p.first;
    block.impulseSecond += p.second;
    pair.apply(arms, ordered(block, p.first, p.second));
}

void closeBlock(const RigidBlock& block, const BodyPair& pair, const Arms& arms, float share) {
    const Halves p = answer(block, {}, 1);
    pair.move(arms, ordered(block, share * p.first, share * p.second));
}

/// With Bᵀ P B = L D Lᵀ, the second half's impulse B L⁻ᵀ e₃ moves the free direction alone, by D₃.
Reaction reactionTo(const RigidBlock& block, float amount) {
    const Factor3& f = block.second;
    const Vec3 rigid = -amount * ((f.l20 - f.l10 * f.l21) * block.basis.cx + f.l21 * block.basis.cy);
    return {-(block.mass.gain * (rigid + amount * block.basis.cz)), rigid};
}

PairVector freeImpulse(RigidBlock& block, float amount) {
    const Reaction held = reactionTo(block, amount);
    block.impulseFirst += held.first;
    block.impulseSecond += held.second;
    return ordered(block, held.first, held.second + amount * block.basis.cz);
}

}  // namespace ragtop
